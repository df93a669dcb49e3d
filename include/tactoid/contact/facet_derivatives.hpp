#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Geometry>

#include <tactoid/contact/closest_point.hpp>
#include <tactoid/contact/surface.hpp>
#include <tactoid/core/tensor.hpp>

namespace tactoid {

/// ∂|c|/∂x_k of the area vector c of a facet at a point, for its nodes; `tangents` there, and m = c/|c|. In a meridian section ∂x/∂t is 2πr along e_z.
template <int D>
[[nodiscard]] inline std::array<Vector3, FacetSurface<D>::corners> area_slopes(const FacetSurface<D>& surface, const typename FacetSurface<D>::Local& local,
                                                                               const FacetTangents& tangents, const Vector3& m) {
  const Vector3 by_s = tangents.t.cross(m), by_t = m.cross(tangents.s);
  const auto ns = FacetSurface<D>::shape_s(local), nt = FacetSurface<D>::shape_t(local);
  const auto ring = surface.circumference_slopes(local);
  std::array<Vector3, FacetSurface<D>::corners> slopes;
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    slopes[k] = ns[k] * by_s + nt[k] * by_t;
    slopes[k][0] += ring[k] * by_t[2];
  }
  return slopes;
}

/// ∂²|c|/∂x_k∂x_l of the area vector c at a point of a facet; m = c/size, where `size` is |c| or what counts as such. dc is linear in dx:
/// d²|c| = dc·(1 − m mᵀ) dc/size + m·d²c.
template <int D>
[[nodiscard]] std::array<std::array<Tensor3, FacetSurface<D>::corners>, FacetSurface<D>::corners> area_curvatures(
    const FacetSurface<D>& surface, const typename FacetSurface<D>::Local& local, const FacetTangents& tangents, double size);

/// Derivatives of the signed gap between a point and its closest point on a facet. Index 0: the position of the point; 1 and more: the nodes of the facet.
template <int D>
struct GapDerivatives {
  static constexpr std::size_t places = FacetSurface<D>::corners + 1;  ///< the point and the nodes
  std::array<double, places> share;                                 ///< 1, and minus the shape functions at the closest point: ∂g/∂x_k = share_k n
  std::array<std::array<Tensor3, places>, places> second;           ///< ∂²g/∂x_k∂x_l, 1/m
};

/// Of the gap at `closest`, with the surface's nodes at x (m). The closest point follows along the directions in which it is
/// free: inside the facet, along an edge, or none in a corner, where the distance is that of two points.
template <int D>
[[nodiscard]] GapDerivatives<D> gap_derivatives(const FacetSurface<D>& surface, const ClosestPoint<D>& closest, std::span<const Vector4> x);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/facet_derivatives.ipp>
#endif
