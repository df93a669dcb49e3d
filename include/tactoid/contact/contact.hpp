#pragma once

#include <concepts>

#include <tactoid/core/unsatisfied.hpp>
#include <tactoid/geometry/particle_fields.hpp>
#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid {

/// An interaction of two bodies A and B.
///
/// `initialize` is called once, when the simulation is composed, with the two reference clouds and fields; it
/// checks parameters and builds search structures. `apply` is called once in every step: it adds forces to both
/// bodies and returns its energy. `apply` must give the same bits for any number of threads; it may keep state: what
/// only saves work (tracked closest points), and what the contact remembers (bonds), which a `state(archive)` hands to checkpoints.
/// `stiffness_rate(a, b)` bounds ω² = k/m (1/s²) of the interaction at the present gaps, for the stable step: called after
/// every `apply`.
template <class C, int D>
concept Contact =
    (requires(C& c, const PointCloud<D>& cloud, const ParticleFields& fields) {
      c.initialize(cloud, fields, cloud, fields);
    } || unsatisfied<"A Contact has `void initialize(const PointCloud<D>&, const ParticleFields&, const PointCloud<D>&, const ParticleFields&)`.">) &&
    (requires(C& c, const ParticleFields& a, const ParticleFields& b, double time) {
      { c.apply(a, b, time) } -> std::convertible_to<TermEnergy>;
    } || unsatisfied<"A Contact has `TermEnergy apply(const ParticleFields& a, const ParticleFields& b, double time)`.">) &&
    (requires(const C& c, const ParticleFields& a, const ParticleFields& b) {
      { c.stiffness_rate(a, b) } -> std::convertible_to<double>;
    } || unsatisfied<"A Contact has `double stiffness_rate(const ParticleFields& a, const ParticleFields& b) const` (1/s^2).">);

}  // namespace tactoid
