#pragma once

#include <span>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/tensor.hpp>

namespace tactoid {

/// Remembers which particles have touched a surface: those whose gap has been at or below a capture distance once.
struct FirstTouch {
  double capture_distance = 100e-9;  ///< gap at which a particle counts as touching, m
  std::vector<char> touched{};       ///< per particle: 1 once it has touched

  /// Throws ParameterError unless capture_distance > 0.
  void validate() const { require_positive("FirstTouch.capture_distance", capture_distance, "m"); }

  /// Particles that touch for the first time at these gaps (m, one per particle; infinity = not on the surface),
  /// ascending.
  std::vector<Index> update(std::span<const double> gaps);

  /// For checkpoints: who has touched.
  template <class Archive>
  void state(Archive& archive) { archive("touched", touched); }
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/first_touch.ipp>
#endif
