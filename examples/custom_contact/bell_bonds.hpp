#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <tactoid/contact/all.hpp>
#include <tactoid/core/errors.hpp>

namespace tactoid {

/// Bonds that break under force: a Contact between the surface particles of A and the surface of B in three dimensions. Each is a
/// spring along the gap, of stiffness κ and rest length ℓ; their density n per reference area follows
///
///   dn/dt = k_on (n₀ − n) [gap <= capture] − k_off(f) n,    f = κ (gap − ℓ),
///   k_off = k₀ e^{|f|/F_b}                                  slip (G. I. Bell, Science 1978, 200, 618),
///   k_off = k₀ (e^{|f|/F_b} + c e^{−|f|/F_c})               catch and slip, c > 0: the lifetime first grows with the force
///
/// exactly for the force of a step. What is stored in bonds that break is dissipated, what bonds hold that form is external work.
struct BellBonds {
  double density = 1e15;       ///< n₀, 1/m²
  double stiffness = 1e-3;     ///< κ of a bond, N/m
  double length = 20e-9;       ///< ℓ, m
  double capture = 30e-9;      ///< gap below which bonds form, m
  double on_rate = 0.0;        ///< k_on, 1/s
  double off_rate = 1e5;       ///< k₀, 1/s
  double slip_force = 20e-12;  ///< F_b, N
  double catch_weight = 0.0;   ///< c; 0: slip alone
  double catch_force = 5e-12;  ///< F_c, N

  SurfaceGaps<3> gaps{};           ///< set by initialize(), as the rest
  std::vector<double> area{};      ///< reference area of the bonds of each particle of A, m²
  std::vector<double> bonds{};     ///< n, per particle of A, 1/m²
  double last_time = 0.0;          ///< of the last call of apply, s
  double total_force = 0.0;        ///< that holds A back, N

  void validate() const {
    require_non_negative("BellBonds.density", density, "1/m^2");
    require_non_negative("BellBonds.stiffness", stiffness, "N/m");
    require_non_negative("BellBonds.length", length, "m");
    require_positive("BellBonds.capture", capture, "m");
    require_non_negative("BellBonds.on_rate", on_rate, "1/s");
    require_non_negative("BellBonds.off_rate", off_rate, "1/s");
    require_positive("BellBonds.slip_force", slip_force, "N");
    require_non_negative("BellBonds.catch_weight", catch_weight);
    require_positive("BellBonds.catch_force", catch_force, "N");
  }

  [[nodiscard]] double detachment_rate(double force) const {
    const double f = std::abs(force);
    return off_rate * (std::exp(f / slip_force) + catch_weight * std::exp(-f / catch_force));
  }

  // --- what makes it a Contact ---------------------------------------------------------------------------------
  template <int D>
    requires(D == 3)
  void initialize(const PointCloud<D>& cloud_a, const ParticleFields& a, const PointCloud<D>& cloud_b, const ParticleFields& b) {
    validate();
    gaps.initialize(cloud_a, a, cloud_b, b);
    const FacetSurface<3>& surface = gaps.surface();
    bonds.assign(cloud_a.size(), 0.0);
    area.assign(cloud_a.size(), 0.0);
    for (const Index i : surface.nodes)
      if (gaps.gaps()[i] <= capture) bonds[i] = density;
    // Facets that stand across the gap hold no bonds.
    const FacetQuadrature<3> quadrature(surface, a.reference, 2);
    for (std::size_t q = 0; q < quadrature.size(); ++q) {
      const auto& facet = surface.facets[quadrature.facet_of(q)];
      const Vector3 normal = surface.normal(quadrature.facet_of(q), quadrature.point(q).local, a.reference);
      for (std::size_t c = 0; c < facet.size(); ++c)
        if (normal.dot(gaps.normals()[facet[c]].head<3>()) < -0.5) area[facet[c]] += quadrature.point(q).shape[c] * quadrature.area[q];
    }
  }

  TermEnergy apply(const ParticleFields& a, const ParticleFields& b, double time) {
    gaps.measure(a, b);
    const double step = std::max(0.0, time - last_time);  // after a step that broke down, time has gone back
    last_time = time;
    total_force = 0.0;
    TermEnergy energy;
    const auto& nodes = gaps.surface().nodes;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const Index i = nodes[k];
      const auto& closest = gaps.closest()[k];
      const double extension = closest.gap - length, force = stiffness * extension, bonded = area[i];
      const double on = closest.gap <= capture ? on_rate : 0.0, off = detachment_rate(force), before = bonds[i];
      const double rest = on + off > 0.0 ? density * on / (on + off) : before;
      bonds[i] = rest + (before - rest) * std::exp(-(on + off) * step);
      const double pull = bonded * bonds[i] * force, stored = 0.5 * stiffness * extension * extension * bonded;
      energy.potential += bonds[i] * stored;
      energy.external_power += on * (density - bonds[i]) * stored;
      energy.dissipated_power += off * bonds[i] * stored;
      total_force += pull;
      // On the particle, and the opposite where it is bound.
      const Vector4 on_a = pad(Vector3(-pull * closest.normal));
      a.force[i] += on_a;
      const auto shape = FacetSurface<3>::shape(closest.local);
      for (std::size_t c = 0; c < shape.size(); ++c) b.force[gaps.master().facets[closest.facet][c]] -= shape[c] * on_a;
    }
    return energy;
  }

  /// Row sums of the springs over the masses: a bound of ω².
  [[nodiscard]] double stiffness_rate(const ParticleFields& a, const ParticleFields& b) const {
    std::vector<double> on_b(b.mass.size(), 0.0);
    double rate = 0.0;
    const auto& nodes = gaps.surface().nodes;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const double row = 2.0 * area[nodes[k]] * bonds[nodes[k]] * stiffness;
      rate = std::max(rate, row / a.mass[nodes[k]]);
      const auto& closest = gaps.closest()[k];
      const auto shape = FacetSurface<3>::shape(closest.local);
      for (std::size_t c = 0; c < shape.size(); ++c) on_b[gaps.master().facets[closest.facet][c]] += shape[c] * row;
    }
    for (std::size_t i = 0; i < on_b.size(); ++i) rate = std::max(rate, on_b[i] / b.mass[i]);
    return rate;
  }

  /// What a checkpoint keeps.
  template <class Archive>
  void state(Archive& archive) {
    archive.part("gaps", gaps);
    archive("bonds", bonds);
    archive("last_time", last_time);
    archive("total_force", total_force);
  }
};

static_assert(Contact<BellBonds, 3>);

}  // namespace tactoid
