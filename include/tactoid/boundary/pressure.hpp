#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <tactoid/boundary/surface_tension.hpp>

namespace tactoid {

/// A uniform pressure on the whole current surface of a body: traction −p n, eqn (17) of Zeng and Li, Soft Matter 2012,
/// 8, 5765. The force at a particle, −p ∫ N_I n da (exact over the bilinear facets), is −p ∂V/∂x of the enclosed volume
/// if the surface is closed: net force and torque are then zero to round-off, and the energy is p V. On an open surface
/// it is a following load without an energy, and its power is external power.
///
/// Pressures are gauge pressures. An ambient pressure p₀ acts on all sides, also where the body is in contact (a thin
/// liquid film separates the surfaces), and is balanced by the same p₀ inside: measured from p₀, it drops out of every
/// force. Entering the 100 kPa of an atmosphere as `pressure` only compresses the body, and drowns the few kPa that
/// move a cell in discretisation error. A BoundaryTerm in 2 (per thickness, or of the rings of a meridian) and
/// 3 dimensions.
struct AmbientPressure {
  static constexpr bool follows_redistribution = true;  ///< keeps nothing of the body
  static constexpr Reads reads = Reads::facets;  ///< the surface
  double pressure = 0.0;                     ///< p, gauge, Pa; positive compresses
  PerDimension<SurfaceIntegral> integral{};  ///< set by initialize()

  /// Throws ParameterError unless finite.
  void validate() const { require_finite("AmbientPressure.pressure", pressure, "Pa"); }

  /// Throws ParameterError for a pressure that is not finite, GeometryError for a cloud without facets or with
  /// periodic directions.
  template <int D>
    requires(D >= 2)
  void initialize(const PointCloud<D>& cloud, const ParticleFields& body) {
    validate();
    integral.emplace<D>().initialize(cloud, body);
  }

  /// Adds −p ∫ N_I n da; returns p V on a closed surface, else the power.
  TermEnergy apply(const ParticleFields& body, double) {
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

  /// Gershgorin's bound of the load's stiffness over the masses.
  [[nodiscard]] double stiffness_rate(const ParticleFields& body) const {
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
};

}  // namespace tactoid
