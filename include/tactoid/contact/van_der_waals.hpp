#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include <tactoid/contact/facet_derivatives.hpp>
#include <tactoid/contact/per_dimension.hpp>
#include <tactoid/contact/surface.hpp>
#include <tactoid/contact/tracking.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/geometry/particle_fields.hpp>

namespace tactoid {

/// All particles of one body against the facets of another: closest points, and gaps per particle.
template <int D>
struct ParticlesOnSurface {
  FacetSurface<D> master;        ///< the surface of the other body
  ClosestPointTracker<D> tracker;  ///< follows the closest points on it
  std::vector<double> gaps;      ///< signed, per particle of the first body, m
  Field forces;                  ///< scratch: on the particles, N
  std::vector<double> energies;  ///< scratch: energy (J) or power (W) of each particle
  double rate = 0.0;             ///< scratch: largest ω² of the particles of all processes, where each computes its own, 1/s²
  /// Brings closest points and gaps to the present positions, m; `ranks`: as ClosestPointTracker takes them, and `own` particles alone, unless it is null.
  void update(std::span<const Vector4> particles, std::span<const Vector4> surface, Ranks* ranks = nullptr, const std::vector<Index>* own = nullptr);
  /// Makes what is known of `own` particles known to all processes. Collective.
  void tell_own(Ranks& ranks, const std::vector<Index>& own);
  /// For checkpoints: gaps, and the closest points that are followed.
  template <class Archive>
  void state(Archive& archive) {
    archive.part("tracker", tracker);
    archive("gaps", gaps);
  }
};

/// Non-specific adhesion: a body force on every particle of A toward the nearest point of B's deformed surface,
/// Zeng and Li, Soft Matter 2012, 8, 5765, eqns (11), (12),
///
///   f_I = −m_I G e^{−g/d₀} n,       g = max(gap, 0),
///
/// with n the signed normal (out of B): the force is continuous in the gap and does not flip where a particle has
/// penetrated; there it stays at m G. As the paper prints it, only A feels it: then its power Σ f·v is
/// external power. With `reaction` B's surface carries the opposite, and the energy −m G d₀ e^{−g/d₀} (going on as
/// −m G (d₀ − gap) for gap < 0) is stored. A Contact in 2 and 3 dimensions.
struct VanDerWaals {
  static constexpr bool follows_redistribution = true;  ///< keeps nothing of A
  static constexpr Reads reads_a = Reads::all;     ///< every particle of A
  static constexpr Reads reads_b = Reads::facets;  ///< the surface of B
  double strength = 1e6;                         ///< G, force per mass at contact, N/kg
  double range = 10e-6;                          ///< d₀, decay length, m
  bool reaction = false;                         ///< the opposite force on B's surface
  PerDimension<ParticlesOnSurface> particles{};  ///< set by initialize()

  /// Throws ParameterError unless strength >= 0 and range > 0.
  void validate() const {
    require_non_negative("VanDerWaals.strength", strength, "N/kg");
    require_positive("VanDerWaals.range", range, "m");
  }

  /// Throws ParameterError as validate(), GeometryError for a second cloud without facets or with periodic
  /// directions.
  template <int D>
    requires(D >= 2)
  void initialize(const PointCloud<D>&, const ParticleFields& a, const PointCloud<D>& cloud_b,
                  const ParticleFields& b);

  /// Adds −m_I G e^{−g/d₀} n; returns the energy with `reaction`, else the power.
  TermEnergy apply(const ParticleFields& a, const ParticleFields& b, double);

  /// G/d₀ e^{−g/d₀} at the least gap, 1/s²; with `reaction` for the surface of B too.
  [[nodiscard]] double stiffness_rate(const ParticleFields& a, const ParticleFields& b) const;

  /// Whether a process that shares A can do with its own particles (ParticleFields::own): the reaction on B is a sum over all of them.
  [[nodiscard]] bool reads_own_alone() const { return !reaction; }
  /// Tells all processes the gaps and closest points of the particles of each of them. Collective.
  void tell_own(Ranks& ranks, const std::vector<Index>& own);

  /// Of each particle of A on itself, at the gaps of the last call of apply. That the surface of B moves, and the reaction on it, are left out: matrices stay
  /// as sparse as without them, and the surface moves little in the range of the force.
  template <class Emit>
  void add_stiffness(const ParticleFields& a, const ParticleFields& b, const Emit& emit) const {
    particles.visit([&](const auto& p) {
      const auto closest = p.tracker.closest();
      for (std::size_t i = 0; i < closest.size(); ++i) {
        const double gap = closest[i].gap, pull = a.mass[i] * strength * std::exp(-std::max(gap, 0.0) / range);
        const auto g = gap_derivatives(p.master, closest[i], b.position);
        const Tensor3 fade = (gap > 0.0 ? 1.0 / range : 0.0) * closest[i].normal * closest[i].normal.transpose();
        emit(false, static_cast<Index>(i), false, static_cast<Index>(i), Tensor3(pull * (g.second[0][0] - fade)));
      }
    });
  }

  /// Signed gap of every particle of A (inside and on the surface) at the last call of apply, m; where each process computes its own, of all particles after tell_own().
  [[nodiscard]] std::span<const double> gaps() const;
  /// For checkpoints: gaps, and the closest points that are followed.
  template <class Archive>
  void state(Archive& archive) { archive.part("particles", particles); }

 private:
  template <int D>
  TermEnergy apply_to(ParticlesOnSurface<D>& p, const ParticleFields& a, const ParticleFields& b) const {
    const std::vector<Index>* const own = own_particles(a);
    p.update(a.position, b.position, b.ranks, own);
    const auto closest = p.tracker.closest();
    p.forces.resize(closest.size());
    p.energies.resize(closest.size());
    const std::size_t count = own != nullptr ? own->size() : closest.size();
    parallel_for(count, [&](std::size_t k) {
      const std::size_t i = own != nullptr ? (*own)[k] : k;
      const double decay = std::exp(-std::max(closest[i].gap, 0.0) / range), weight = a.mass[i] * strength;
      p.forces[i] = pad(Vector3(-weight * decay * closest[i].normal));
      a.force[i] += p.forces[i];
      p.energies[k] =
          reaction ? -weight * (range * decay - std::min(closest[i].gap, 0.0)) : p.forces[i].dot(a.velocity[i]);
    });
    TermEnergy total;
    double& energy = reaction ? total.potential : total.external_power;
    for (std::size_t k = 0; k < count; ++k) energy += p.energies[k];
    if (own != nullptr) {
      const std::array together{energy, rate_of_own(p, *own)};
      const std::vector<double> all = a.ranks->gather_from_each(together);
      energy = p.rate = 0.0;
      for (std::size_t k = 0; k < all.size(); k += together.size()) energy += all[k], p.rate = std::max(p.rate, all[k + 1]);
    }
    if (!reaction) return total;
    for (std::size_t i = 0; i < closest.size(); ++i) {
      const auto& onto = p.master.facets[closest[i].facet];
      const auto n = FacetSurface<D>::shape(closest[i].local);
      for (std::size_t k = 0; k < onto.size(); ++k) b.force[onto[k]] -= n[k] * p.forces[i];
    }
    return total;
  }

  [[nodiscard]] const std::vector<Index>* own_particles(const ParticleFields& a) const { return reads_own_alone() ? a.own : nullptr; }

  template <int D>
  double rate_of_own(const ParticlesOnSurface<D>& p, const std::vector<Index>& own) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Index i : own) least = std::min(least, std::max(p.tracker.closest()[i].gap, 0.0));
    return strength / range * std::exp(-least / range);
  }

  template <int D>
  double rate_of(const ParticlesOnSurface<D>& p, const ParticleFields& a, const ParticleFields& b) const {
    if (own_particles(a) != nullptr) return p.rate;
    std::vector<double> sum(reaction ? b.mass.size() : 0, 0.0);
    double rate = 0.0;
    const auto closest = p.tracker.closest();
    for (std::size_t i = 0; i < closest.size(); ++i) {
      const double k = strength / range * std::exp(-std::max(closest[i].gap, 0.0) / range);
      rate = std::max(rate, reaction ? 2.0 * k : k);
      if (!reaction) continue;
      const auto n = FacetSurface<D>::shape(closest[i].local);
      for (std::size_t c = 0; c < n.size(); ++c)
        sum[p.master.facets[closest[i].facet][c]] += 2.0 * k * a.mass[i] * n[c];
    }
    for (std::size_t j = 0; j < sum.size(); ++j) rate = std::max(rate, sum[j] / b.mass[j]);
    return rate;
  }
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/van_der_waals.ipp>
#endif
