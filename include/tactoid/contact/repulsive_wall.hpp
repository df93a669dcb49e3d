#pragma once

#include <limits>

#include <tactoid/core/errors.hpp>

namespace tactoid {

/// A wall that pushes back what penetrates it, and does nothing else: traction −k g for g < 0. A GapLaw.
struct RepulsiveWall {
  double penalty = 1e12;  ///< k, Pa/m: traction per depth

  /// Throws ParameterError unless penalty > 0.
  void validate() const { require_positive("RepulsiveWall.penalty", penalty, "Pa/m"); }
  [[nodiscard]] double reach() const { return 0.0; }  ///< 0: nothing acts at a distance
  /// ½ k g² for g < 0, J/m².
  [[nodiscard]] double potential(double gap) const { return gap < 0.0 ? 0.5 * penalty * gap * gap : 0.0; }
  [[nodiscard]] double traction(double gap) const { return gap < 0.0 ? -penalty * gap : 0.0; }  ///< −k g for g < 0, Pa
  [[nodiscard]] double stiffness(double gap) const { return gap < 0.0 ? penalty : 0.0; }        ///< k for g < 0, Pa/m
};

}  // namespace tactoid
