#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/boundary/curvature_surface_tension.hpp>

namespace tactoid {

template <int D>
  requires(D >= 2)
void CurvatureSurfaceTension::initialize(const PointCloud<D>& cloud, const ParticleFields& body) {
  validate();
  integral.emplace<D>().initialize(cloud, body);
  normals.assign(cloud.size(), Vector4::Zero());
  areas.assign(cloud.size(), 0.0);
  curvatures.assign(cloud.size(), 0.0);
}

TACTOID_INLINE TermEnergy CurvatureSurfaceTension::apply(const ParticleFields& body, double) {
  return integral.visit([&]<int D>(SurfaceIntegral<D>& s) { return apply_to(s, body); });
}

TACTOID_INLINE double CurvatureSurfaceTension::stiffness_rate(const ParticleFields& body) const {
  return integral.visit([&](const auto& s) { return area_stiffness_rate(s, body, tension); });
}

template <int D>
TermEnergy CurvatureSurfaceTension::apply_to(SurfaceIntegral<D>& s, const ParticleFields& body) {
  const FacetSurface<D>& surface = s.surface;
  for (const Index i : surface.nodes) {
    normals[i].setZero();
    areas[i] = curvatures[i] = 0.0;
  }
  TermEnergy total;
  // The force array of the facets holds the gradient of the area here: it gives the rate of σ₀ A.
  parallel_for(surface.facets.size(), [&](std::size_t f) {
    s.value[f] = detail::facet_area(s, static_cast<Index>(f), body.position, s.force[f]);
  });
  for (Index f = 0; f < surface.facets.size(); ++f) {
    const auto& nodes = surface.facets[f];
    total.potential += tension * s.value[f];
    for (std::size_t k = 0; k < nodes.size(); ++k)
      total.external_power += tension * s.force[f][k].dot(body.velocity[nodes[k]].template head<3>());
    for (const auto& point : s.quadrature.points) {
      const FacetTangents x = surface.tangents(f, point.local, body.position);
      const Vector3 c = x.area_vector();
      // Of the section alone in a meridian: the rings widen with the distance from the axis, and would tilt the normals.
      const Vector3 facing = D == 2 ? Vector3(c / x.t.norm()) : c;
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        normals[nodes[k]].template head<3>() += point.weight * point.shape[k] * facing;
        areas[nodes[k]] += point.weight * point.shape[k] * c.norm();
      }
    }
  }
  for (const Index i : surface.nodes) {
    if (surface.axisymmetric && body.reference[i][0] == 0.0) normals[i][0] = 0.0;  // what the other half would do
    normals[i].normalize();
  }
  for (Index f = 0; f < surface.facets.size(); ++f) {
    const auto& nodes = surface.facets[f];
    for (const auto& point : s.quadrature.points) {
      const FacetTangents a = surface.tangents(f, point.local, body.position);
      const Vector3 c = a.area_vector();
      // ∇·n = (a_t × ĉ)·∂n/∂s + (ĉ × a_s)·∂n/∂t over |c|: the reciprocal tangents.
      const Vector3 unit = c.normalized(), by_s = a.t.cross(unit), by_t = unit.cross(a.s);
      const auto ns = FacetSurface<D>::shape_s(point.local), nt = FacetSurface<D>::shape_t(point.local);
      const auto ring = surface.circumference_slopes(point.local);  // e_r turns around the axis: ∂n/∂t has n_r
      double divergence_times_area = 0.0;
      for (std::size_t k = 0; k < nodes.size(); ++k)
        divergence_times_area += normals[nodes[k]].template head<3>().dot(ns[k] * by_s + nt[k] * by_t) +
                                 ring[k] * by_t[2] * normals[nodes[k]][0];
      for (std::size_t k = 0; k < nodes.size(); ++k)
        curvatures[nodes[k]] += point.weight * point.shape[k] * divergence_times_area / areas[nodes[k]];
    }
  }
  for (const Index i : surface.nodes) {
    const Vector4 force = -tension * curvatures[i] * areas[i] * normals[i];
    body.force[i] += force;
    total.external_power += force.dot(body.velocity[i]);
  }
  return total;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template void CurvatureSurfaceTension::initialize<2>(const PointCloud<2>& cloud, const ParticleFields& body);
template void CurvatureSurfaceTension::initialize<3>(const PointCloud<3>& cloud, const ParticleFields& body);
}  // namespace tactoid
#endif
