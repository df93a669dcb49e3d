#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include <tactoid/contact/surface.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/core/tensor.hpp>

namespace tactoid {

/// Area of contact and its front, from the gaps at the surface particles.
struct ContactFront {
  double area = 0.0;                   ///< of the surface with gap < cutoff, projected on the substrate, m²
  Vector3 centroid = Vector3::Zero();  ///< of that area, m; zero without contact
  Vector3 center = Vector3::Zero();    ///< of the area that the front encloses, pockets included, m
  double radius = 0.0;                 ///< mean of the front's radius r(θ) around the center, m
  std::vector<double> modes;           ///< amplitudes a_m in r(θ)/radius = Σ a_m cos(m θ − φ_m), m = 0 … (a_0 = 1)
  std::vector<double> phases;          ///< φ_m, rad, with θ from x (from y where `up` is along x)
  double modulation = 0.0;             ///< root mean square of r(θ)/radius − 1 in the modes m >= 2
  std::vector<Vector3> outline;        ///< points of the front at equal angles around the center, m; empty without contact
};

/// The outer front r(θ_k), θ_k = 2π k/n, around a point: the outermost crossing of each of n rays with the segments of
/// the contour, so that pockets under the cell do not count. Rays without a crossing are interpolated from their
/// neighbours; empty where no ray crosses the contour.
[[nodiscard]] std::vector<double> outer_front(const std::vector<std::array<Point<2>, 2>>& contour,
                                              const Point<2>& center, std::size_t rays);

/// Centroid of the polygon with the corners center + r_k (cos θ_k, sin θ_k).
[[nodiscard]] Point<2> front_centroid(const std::vector<double>& r, const Point<2>& center);

namespace detail {
/// A unit vector normal to `up`: x, unless that is nearly along `up`.
[[nodiscard]] inline Vector3 in_plane_axis(const Vector3& up) {
  const Vector3 x = std::abs(up[0]) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
  return (x - x.dot(up) * up).normalized();
}
}  // namespace detail

/// Cuts the facets of a surface along the contour gap = cutoff, so that the area is continuous in time. Each
/// bilinear facet is four triangles around its centre. `gaps`: signed gap per particle; `up`: unit normal of the
/// substrate, on which areas are projected: facets that face the substrate count.
[[nodiscard]] ContactFront contact_front(const FacetSurface<3>& surface, std::span<const Vector4> position,
                                         std::span<const double> gaps, double cutoff,
                                         const Vector3& up = Vector3::UnitZ(), int modes = 16);

/// The same of a meridian section on a substrate across its axis: the area is that of the rings with gap < cutoff, cut
/// linearly within a facet, and the front is the circle where the contour is outermost; it has no waves. Throws
/// ParameterError for a surface that is no meridian.
[[nodiscard]] ContactFront contact_front(const FacetSurface<2>& surface, std::span<const Vector4> position,
                                         std::span<const double> gaps, double cutoff);

/// How far the front has come from the point `origin` in a direction: the mean distance of the points of its outline in the
/// sector of ±`half_angle` around `direction` (both in the plane of the substrate), m; zero where there are none.
[[nodiscard]] double front_radius(const ContactFront& front, const Vector3& origin, const Vector3& direction,
                                  double half_angle = std::numbers::pi / 4.0,
                                  const Vector3& up = Vector3::UnitZ());

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/observe/contact_front.ipp>
#endif
