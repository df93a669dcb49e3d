#pragma once

#include <cmath>

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/facet_derivatives.hpp>

namespace tactoid {

template <int D>
std::array<std::array<Tensor3, FacetSurface<D>::corners>, FacetSurface<D>::corners> area_curvatures(
    const FacetSurface<D>& surface, const typename FacetSurface<D>::Local& local, const FacetTangents& tangents, double size) {
  constexpr std::size_t corners = FacetSurface<D>::corners;
  const auto cross = [](const Vector3& v) {  // [v]ₓ w = v × w
    Tensor3 A;
    A << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
    return A;
  };
  const Vector3 m = tangents.area_vector() / size;
  const Tensor3 across = (Tensor3::Identity() - m * m.transpose()) / size, turn = cross(m);
  const auto ns = FacetSurface<D>::shape_s(local), nt = FacetSurface<D>::shape_t(local);
  const auto ring = surface.circumference_slopes(local);
  const Vector3 out = Vector3::UnitZ().cross(m);
  std::array<Tensor3, corners> dc;
  for (std::size_t k = 0; k < corners; ++k) {
    dc[k] = nt[k] * cross(tangents.s) - ns[k] * cross(tangents.t);
    dc[k].col(0) += ring[k] * tangents.s.cross(Vector3::UnitZ());
  }
  std::array<std::array<Tensor3, corners>, corners> second;
  for (std::size_t k = 0; k < corners; ++k)
    for (std::size_t l = 0; l < corners; ++l) {
      second[k][l] = dc[k].transpose() * across * dc[l] - (ns[k] * nt[l] - nt[k] * ns[l]) * turn;
      second[k][l].col(0) += ns[k] * ring[l] * out;
      second[k][l].row(0) += ns[l] * ring[k] * out.transpose();
    }
  return second;
}

// g is ±|q − y(ξ)|, stationary in the free coordinates ξ of the closest point y. With Y = ∂y/∂ξ, A = YᵀY, κ = n·∂²y/∂ξ², H = A − g κ,
// a = Yᵀ δ(q − y) and c = n·δY (positions vary, ξ does not) the condition of stationarity gives
//   δ²g = [δ(q − y)·(1 − n nᵀ) δ(q − y) − (a + g c)ᵀ H⁻¹ (a + g c)]/g,
// in which what Y spans of 1 − n nᵀ is taken apart, so that nothing of it is divided by g:
//   δ²g = −[aᵀ H⁻¹κA⁻¹ a + cᵀ H⁻¹ a + aᵀ H⁻¹ c + g cᵀ H⁻¹ c] + δ(q − y)·(1 − n nᵀ − Y A⁻¹ Yᵀ) δ(q − y)/g.
template <int D>
GapDerivatives<D> gap_derivatives(const FacetSurface<D>& surface, const ClosestPoint<D>& closest, std::span<const Vector4> x) {
  constexpr std::size_t places = GapDerivatives<D>::places;
  const auto& nodes = surface.facets[closest.facet];
  const auto shape = FacetSurface<D>::shape(closest.local);
  const std::array slopes = {FacetSurface<D>::shape_s(closest.local), FacetSurface<D>::shape_t(closest.local)};
  const Vector3& n = closest.normal;

  GapDerivatives<D> g;
  g.share[0] = 1.0;
  for (std::size_t k = 1; k < places; ++k) g.share[k] = -shape[k - 1];

  // Coordinates that are not free, and that there is only in three dimensions, are left out: unit rows in A, zero elsewhere.
  std::array<bool, 2> free{};
  Eigen::Matrix<double, 3, 2> Y = Eigen::Matrix<double, 3, 2>::Zero();
  const FacetTangents tangents = surface.tangents(closest.facet, closest.local, x);
  for (std::size_t c = 0; c < closest.local.size(); ++c) {
    free[c] = !closest.on_rim || (closest.local[c] > 0.0 && closest.local[c] < 1.0);
    if (free[c]) Y.col(static_cast<Eigen::Index>(c)) = c == 0 ? tangents.s : tangents.t;
  }
  Eigen::Matrix2d A = Y.transpose() * Y, kappa = Eigen::Matrix2d::Zero();
  for (int c = 0; c < 2; ++c)
    if (!free[static_cast<std::size_t>(c)]) A(c, c) = 1.0;
  if constexpr (D == 3)
    if (free[0] && free[1]) kappa(0, 1) = kappa(1, 0) = n.dot((x[nodes[0]] - x[nodes[1]] - x[nodes[2]] + x[nodes[3]]).template head<3>());
  const Eigen::Matrix2d A_inverse = A.inverse();
  Eigen::Matrix2d H_inverse = (A - closest.gap * kappa).inverse();
  for (int c = 0; c < 2; ++c)
    if (!free[static_cast<std::size_t>(c)]) H_inverse(c, c) = 0.0;

  // Y = Σ slope_k x_k; a and c as they depend on each place.
  std::array<Eigen::Matrix<double, 2, 3>, places> a, c;
  for (std::size_t k = 0; k < places; ++k) {
    a[k] = g.share[k] * Y.transpose();
    c[k].setZero();
    if (k > 0)
      for (std::size_t e = 0; e < 2; ++e)
        if (free[e]) c[k].row(static_cast<Eigen::Index>(e)) = slopes[e][k - 1] * n.transpose();
  }
  Tensor3 across = Tensor3::Zero();
  const bool held = !free[0] || (D == 3 && !free[1]);
  const double length = (x[nodes[0]] - x[nodes[1]]).norm();
  if (held && std::abs(closest.gap) > 1e-10 * length) {  // nearer, the normal is not that of the distance (complete())
    across = Tensor3::Identity() - n * n.transpose();
    for (Eigen::Index e = 0; e < 2; ++e)
      if (free[static_cast<std::size_t>(e)]) across -= Y.col(e) * Y.col(e).transpose() / Y.col(e).squaredNorm();
    if constexpr (D == 2) across(2, 2) -= 1.0;  // there is no third direction
    across /= closest.gap;
  }
  const Eigen::Matrix2d bend = H_inverse * kappa * A_inverse;
  for (std::size_t k = 0; k < places; ++k)
    for (std::size_t l = 0; l < places; ++l)
      g.second[k][l] = g.share[k] * g.share[l] * across - a[k].transpose() * bend * a[l] - c[k].transpose() * H_inverse * a[l] -
                       a[k].transpose() * H_inverse * c[l] - closest.gap * c[k].transpose() * H_inverse * c[l];
  return g;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template std::array<std::array<Tensor3, 2>, 2> area_curvatures<2>(const FacetSurface<2>&, const FacetSurface<2>::Local&, const FacetTangents&, double);
template std::array<std::array<Tensor3, 4>, 4> area_curvatures<3>(const FacetSurface<3>&, const FacetSurface<3>::Local&, const FacetTangents&, double);
template GapDerivatives<2> gap_derivatives<2>(const FacetSurface<2>&, const ClosestPoint<2>&, std::span<const Vector4>);
template GapDerivatives<3> gap_derivatives<3>(const FacetSurface<3>&, const ClosestPoint<3>&, std::span<const Vector4>);
}  // namespace tactoid
#endif
