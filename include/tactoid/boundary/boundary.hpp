#pragma once

#include <concepts>

#include <tactoid/core/tensor.hpp>
#include <tactoid/core/unsatisfied.hpp>
#include <tactoid/geometry/particle_fields.hpp>
#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid {

/// A force on one body: gravity, surface tension, pressure, a rigid plate.
///
/// `initialize` is called once, when the simulation is composed. `apply` is called once in every step (more often in implicit ones): it adds
/// forces at the particles and returns its energy; same bits for any number of threads.
/// `stiffness_rate(body)` bounds ω² = k/m (1/s²) of the term, for the stable step; 0 if it limits nothing.
template <class B, int D>
concept BoundaryTerm =
    (requires(B& b, const PointCloud<D>& cloud, const ParticleFields& fields) {
      b.initialize(cloud, fields);
    } || unsatisfied<"A BoundaryTerm has `void initialize(const PointCloud<D>&, const ParticleFields&)`.">) &&
    (requires(B& b, const ParticleFields& body, double time) {
      { b.apply(body, time) } -> std::convertible_to<TermEnergy>;
    } || unsatisfied<"A BoundaryTerm has `TermEnergy apply(const ParticleFields& body, double time)`.">) &&
    (requires(const B& b, const ParticleFields& body) {
      { b.stiffness_rate(body) } -> std::convertible_to<double>;
    } || unsatisfied<"A BoundaryTerm has `double stiffness_rate(const ParticleFields& body) const` (1/s^2).">);

/// What a BoundaryTerm reads: its `reads`, or everything.
template <class B>
inline constexpr Reads reads_of = [] {
  if constexpr (requires { B::reads; }) return B::reads;
  else return Reads::all;
}();

/// A BoundaryTerm that knows its stiffness, with which static solutions converge fast: `add_stiffness(body, emit)` calls
/// emit(i, j, K) with K = −∂f_i/∂x_j (3 × 3, N/m) for pairs of particles, at the state of the last call of `apply`; the
/// contributions to a pair add up.
template <class B>
concept TermWithStiffness = requires(const B& b, const ParticleFields& body,
                                     void (*emit)(Index i, Index j, const Tensor3& stiffness)) { b.add_stiffness(body, emit); };

}  // namespace tactoid
