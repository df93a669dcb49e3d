#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include <Eigen/Geometry>

#include <tactoid/contact/surface.hpp>
#include <tactoid/core/tensor.hpp>

namespace tactoid {

/// The point of a surface that is closest to a query point x.
template <int D>
struct ClosestPoint {
  Index facet = 0;                          ///< on which x_c lies
  typename FacetSurface<D>::Local local{};  ///< (s) or (s, t) on the facet
  Vector3 point = Vector3::Zero();          ///< x_c, m
  Vector3 normal = Vector3::Zero();         ///< ∂gap/∂x, a unit vector out of the surface
  double gap = 0.0;                         ///< signed distance, positive outside, m
  bool on_rim = false;                      ///< x_c lies on an edge or a corner of its facet
};

/// The point of one facet that is closest to x.
template <int D>
struct FacetProjection {
  typename FacetSurface<D>::Local local{};  ///< (s) or (s, t) on the facet
  Vector3 point = Vector3::Zero();  ///< closest point, m
  double squared_distance = std::numeric_limits<double>::max();  ///< to the query point, m²
  int side = -1;    ///< edge of the facet on which the point lies (D = 3), −1 otherwise
  int corner = -1;  ///< corner of the facet that the point is, −1 otherwise
  [[nodiscard]] bool interior() const { return side < 0 && corner < 0; }  ///< neither on an edge nor in a corner
};

namespace detail {

struct SegmentProjection {
  Vector3 point;
  double squared_distance;
  double parameter;  // from the first to the second end; exactly 0 or 1 at the ends
};

/// Closest point of the segment a–b. Bits do not depend on which facet asks: the end with the lower index leads.
SegmentProjection project_on_segment(Index ia, Index ib, std::span<const Vector4> x, const Vector3& q);

/// Coefficients of a bilinear facet, x = c + s b1 + t b2 + s t b12.
struct Bilinear {
  Vector3 c, b1, b2, b12;
  [[nodiscard]] Vector3 at(double s, double t) const { return c + s * b1 + t * (b2 + s * b12); }
};

/// Descends |q − x(s,t)|² inside the unit square from (s, t) by damped steps; for the rare facet on which the
/// distance is not convex, because it is strongly curved toward the query point.
void descend(const Bilinear& facet, const Vector3& q, double& s, double& t, double& distance2);

}  // namespace detail

/// The closest point of facet `f` to `q`, exactly constrained to the facet. Segments in closed form; bilinear
/// facets by Newton from the middle of the facet, edges in closed form. The result is a function of the positions
/// alone, to the bit: it does not depend on a start value, and on shared edges and corners not on the facet.
template <int D>
[[nodiscard]] FacetProjection<D> project_on_facet(const FacetSurface<D>& surface, Index f, std::span<const Vector4> x,
                                                  const Vector3& q);

/// The normal that decides on which side of the surface a point is whose closest point is an edge or a corner: the
/// sum of the unit normals of the facets that meet there, weighted by their angles (1 for the two facets of an
/// edge). J. A. Baerentzen and H. Aanaes, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243.
template <int D>
[[nodiscard]] Vector3 pseudo_normal(const FacetSurface<D>& surface, Index f, const FacetProjection<D>& p,
                                    std::span<const Vector4> x);

/// Completes a projection: signed gap and its derivative. On the inside of a facet the derivative is the facet's
/// normal; where edges or corners are closest it is ±(x − x_c)/|x − x_c|, with the pseudo-normal's sign (and the
/// pseudo-normal itself when x lies on the surface).
template <int D>
[[nodiscard]] ClosestPoint<D> complete(const FacetSurface<D>& surface, Index f, const FacetProjection<D>& p,
                                       std::span<const Vector4> x, const Vector3& q);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/closest_point.ipp>
#endif
