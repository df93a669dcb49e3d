#pragma once

#include <numbers>

#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid {

/// How particles of a ball are crowded around its lowest point, for contact there: facets below the polar angle are `factor` times as small,
/// those above the larger for it, gradually. Their number stays.
struct PoleRefinement {
  double factor = 2.0;                         ///< >= 1, and factor × angle below 0.8 π
  double angle = 55.0 / 180.0 * std::numbers::pi;  ///< from the lowest point, rad; > 0

  /// Throws ParameterError for a value out of its range.
  void validate() const;
  /// New polar angle of a particle on the surface, of its old one; both from 0 (lowest point) to π.
  [[nodiscard]] double polar_angle(double before) const;
};

/// A ball() or its meridian() section with the polar angle (about `center`, from the last axis downwards) of particles on the surface changed like this, and
/// that of particles inside by √(their share of `radius`, m) of the change: cells are sheared by half of it at most. A factor of 1 gives the ball as it is. Throws ParameterError, GeometryError if a cell inverts.
template <int D>
  requires(D >= 2)
[[nodiscard]] PointCloud<D> refine_pole(const PointCloud<D>& ball, const Point<D>& center, double radius, const PoleRefinement& refinement);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/pole_refinement.ipp>
#endif
