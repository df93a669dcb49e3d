#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/boundary/pressure.hpp>

namespace tactoid {

TACTOID_INLINE TermEnergy AmbientPressure::apply(const ParticleFields& body, double) {
  return integral.visit([&]<int D>(SurfaceIntegral<D>& s) {
    parallel_for(s.force.size(), [&](std::size_t f) {
      s.force[f].fill(Vector3::Zero());
      s.value[f] = 0.0;
      for (const auto& point : s.quadrature.points) {
        const Vector3 load = -pressure * point.weight *
                             s.surface.tangents(static_cast<Index>(f), point.local, body.position).area_vector();
        for (std::size_t k = 0; k < point.shape.size(); ++k) {
          const Vector3 force = point.shape[k] * load;
          const Index node = s.surface.facets[f][k];
          s.force[f][k] += force;
          // Σ f·x = −D p V (3 for a body of revolution); on an open surface the power is wanted instead.
          if (s.surface.closed)
            s.value[f] -= force.dot(body.position[node].template head<3>()) / (s.surface.axisymmetric ? 3 : D);
          else
            s.value[f] += force.dot(body.velocity[node].template head<3>());
        }
      }
    });
    const double sum = s.gather(body);
    return s.surface.closed ? TermEnergy{.potential = sum} : TermEnergy{.external_power = sum};
  });
}

TACTOID_INLINE double AmbientPressure::stiffness_rate(const ParticleFields& body) const {
  return integral.visit([&]<int D>(const SurfaceIntegral<D>& s) {
    std::vector<double> sum(body.mass.size(), 0.0);
    for (Index f = 0; f < s.surface.facets.size(); ++f)
      for (const auto& point : s.quadrature.points) {
        const FacetTangents a = s.surface.tangents(f, point.local, body.position);
        const auto ns = FacetSurface<D>::shape_s(point.local), nt = FacetSurface<D>::shape_t(point.local);
        const auto ring = s.surface.circumference_slopes(point.local);
        double row = 0.0;
        for (std::size_t k = 0; k < ns.size(); ++k)
          row += std::abs(ns[k]) * a.t.norm() + (std::abs(nt[k]) + ring[k]) * a.s.norm();
        for (std::size_t k = 0; k < ns.size(); ++k)
          sum[s.surface.facets[f][k]] += std::abs(pressure) * point.weight * point.shape[k] * row;
      }
    double rate = 0.0;
    for (const Index i : s.surface.nodes) rate = std::max(rate, sum[i] / body.mass[i]);
    return rate;
  });
}

}  // namespace tactoid
