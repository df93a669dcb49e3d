#pragma once

#include <array>
#include <functional>
#include <utility>
#include <vector>

#include <tactoid/core/tensor.hpp>

namespace tactoid {

/// An essential condition: the displacement *at* the given particles (interpolated, where the unknowns are
/// coefficients) follows a function of the reference position and of time, in the chosen components.
struct PrescribedMotion {
  std::vector<Index> particles;                                        ///< numbers of the particles
  std::function<Vector3(const Vector3& X, double time)> displacement;  ///< m; empty: zero
  std::array<bool, 3> components = {true, true, true};                 ///< which components are prescribed

  /// ū at the reference position X (m) and time (s); all components, m.
  [[nodiscard]] Vector3 value(const Vector3& X, double time) const {
    return displacement ? displacement(X, time) : Vector3::Zero();
  }
};

/// Holds the given particles where they are, in the chosen components.
[[nodiscard]] inline PrescribedMotion fixed(std::vector<Index> particles, std::array<bool, 3> components = {true, true, true}) {
  return {std::move(particles), {}, components};
}

}  // namespace tactoid
