#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/boundary/surface_tension.hpp>

namespace tactoid {

template <int D>
void SurfaceIntegral<D>::initialize(const PointCloud<D>& cloud, const ParticleFields& body) {
  surface = FacetSurface<D>(cloud);
  quadrature = FacetQuadrature<D>(surface, body.reference, 2);
  force.resize(surface.facets.size());
  value.resize(surface.facets.size());
  smallest.clear();
}

template <int D>
double SurfaceIntegral<D>::gather(const ParticleFields& body) const {
  double sum = 0.0;
  for (std::size_t f = 0; f < force.size(); ++f) {
    sum += value[f];
    for (std::size_t a = 0; a < force[f].size(); ++a)
      body.force[surface.facets[f][a]].template head<3>() += force[f][a];
  }
  return sum;
}

}  // namespace tactoid

namespace tactoid::detail {

template <int D>
double facet_area(const SurfaceIntegral<D>& s, Index f, std::span<const Vector4> x,
                  std::array<Vector3, FacetSurface<D>::corners>& gradient) {
  double area = 0.0;
  gradient.fill(Vector3::Zero());
  for (std::size_t p = 0; p < s.quadrature.points.size(); ++p) {
    const auto& point = s.quadrature.points[p];
    const FacetTangents a = s.surface.tangents(f, point.local, x);
    const Vector3 c = a.area_vector();
    const double length = s.size(f, p, c);
    area += point.weight * length;
    const auto slopes = area_slopes(s.surface, point.local, a, c / length);
    for (std::size_t k = 0; k < gradient.size(); ++k) gradient[k] += point.weight * slopes[k];
  }
  return area;
}

}  // namespace tactoid::detail

namespace tactoid {

template <int D>
double area_stiffness_rate(const SurfaceIntegral<D>& s, const ParticleFields& body, double tension) {
  std::vector<double> sum(body.mass.size(), 0.0);
  for (Index f = 0; f < s.surface.facets.size(); ++f)
    for (std::size_t p = 0; p < s.quadrature.points.size(); ++p) {
      const auto& point = s.quadrature.points[p];
      const FacetTangents a = s.surface.tangents(f, point.local, body.position);
      const auto ns = FacetSurface<D>::shape_s(point.local), nt = FacetSurface<D>::shape_t(point.local);
      const double length = s.size(f, p, a.area_vector());
      auto turn = s.surface.circumference_slopes(point.local);  // how the second tangent follows the nodes
      double all = 0.0, all_s = 0.0, all_t = 0.0;
      std::array<double, FacetSurface<D>::corners> g;
      for (std::size_t k = 0; k < g.size(); ++k) {
        g[k] = (ns[k] * a.t - nt[k] * a.s).norm();
        all += g[k];
        all_s += std::abs(ns[k]);
        turn[k] += std::abs(nt[k]);
        all_t += turn[k];
      }
      for (std::size_t k = 0; k < g.size(); ++k)
        sum[s.surface.facets[f][k]] +=
            tension * point.weight * (g[k] * all / length + std::abs(ns[k]) * all_t + turn[k] * all_s);
    }
  double rate = 0.0;
  for (const Index i : s.surface.nodes) rate = std::max(rate, sum[i] / body.mass[i]);
  return rate;
}

TACTOID_INLINE void SurfaceTension::redistribute(const SurfaceTransfer&, const ParticleFields& body) {
  integral.visit([&](auto& s) {
    s.smallest.clear();
    if (smoothing > 0.0) s.smooth(smoothing, body.position);
  });
}

TACTOID_INLINE TermEnergy SurfaceTension::apply(const ParticleFields& body, double) {
  return integral.visit([&]<int D>(SurfaceIntegral<D>& s) {
    parallel_for(s.force.size(), [&](std::size_t f) {
      s.value[f] = tension * detail::facet_area(s, static_cast<Index>(f), body.position, s.force[f]);
      for (Vector3& g : s.force[f]) g *= -tension;
    });
    return TermEnergy{.potential = s.gather(body)};
  });
}

TACTOID_INLINE double SurfaceTension::area() const {
  return integral.visit([&](const auto& s) {
    double sum = 0.0;
    for (const double v : s.value) sum += v;
    return sum / tension;
  });
}

TACTOID_INLINE double SurfaceTension::stiffness_rate(const ParticleFields& body) const {
  return integral.visit([&](const auto& s) { return area_stiffness_rate(s, body, tension); });
}

template <int D>
  requires(D >= 2)
void SurfaceTension::initialize(const PointCloud<D>& cloud, const ParticleFields& body) {
  validate();
  auto& s = integral.emplace<D>();
  s.initialize(cloud, body);
  if (smoothing > 0.0) s.smooth(smoothing, body.reference);
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template class SurfaceIntegral<2>;
template class SurfaceIntegral<3>;
template double area_stiffness_rate<2>(const SurfaceIntegral<2>& s, const ParticleFields& body, double tension);
template double area_stiffness_rate<3>(const SurfaceIntegral<3>& s, const ParticleFields& body, double tension);
template void SurfaceTension::initialize<2>(const PointCloud<2>& cloud, const ParticleFields& body);
template void SurfaceTension::initialize<3>(const PointCloud<3>& cloud, const ParticleFields& body);
}  // namespace tactoid
namespace tactoid::detail {
template double facet_area<2>(const SurfaceIntegral<2>& s, Index f, std::span<const Vector4> x,
                              std::array<Vector3, FacetSurface<2>::corners>& gradient);
template double facet_area<3>(const SurfaceIntegral<3>& s, Index f, std::span<const Vector4> x,
                              std::array<Vector3, FacetSurface<3>::corners>& gradient);
}  // namespace tactoid::detail
#endif
