#pragma once

#include <concepts>
#include <vector>

#include <tactoid/core/tensor.hpp>
#include <tactoid/core/unsatisfied.hpp>
#include <tactoid/geometry/particle_fields.hpp>
#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid {

/// An interaction of two bodies A and B.
///
/// `initialize` is called once, when the simulation is composed, with the two reference clouds and fields; it
/// checks parameters and builds search structures. `apply` is called once in every step (more often in implicit ones): it adds forces to both
/// bodies and returns its energy. `apply` must give the same bits for any number of threads; it may keep state: what
/// only saves work (tracked closest points), and what the contact remembers (bonds), which a `state(archive)` hands to checkpoints.
/// What is remembered changes only when `time` moves on: implicit steps try several positions at the time of their start.
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

/// What a Contact reads of body A: its `reads_a`, or everything.
template <class C>
inline constexpr Reads reads_a_of = [] {
  if constexpr (requires { C::reads_a; }) return C::reads_a;
  else return Reads::all;
}();
/// What a Contact reads of body B: its `reads_b`, or everything.
template <class C>
inline constexpr Reads reads_b_of = [] {
  if constexpr (requires { C::reads_b; }) return C::reads_b;
  else return Reads::all;
}();

/// Whether a Contact needs of body A no particles but those on facets and those of its own process, where processes sum in their own order
/// (ParticleFields::own): `reads_own_alone()` of one that may read everything. It must then add up energies and rates over the processes by itself.
template <class C>
[[nodiscard]] bool reads_own_alone(const C& contact) {
  if constexpr (requires { { contact.reads_own_alone() } -> std::convertible_to<bool>; }) return contact.reads_own_alone();
  else return reads_a_of<C> == Reads::facets;
}
/// A Contact whose processes each know something of their own particles of A: `tell_own(ranks, own)` tells it all of them, for observers and checkpoints. Collective.
template <class C>
concept TellsOwn = requires(C& contact, Ranks& ranks, const std::vector<Index>& own) { contact.tell_own(ranks, own); };

/// A Contact that knows its stiffness, with which implicit steps converge fast: `add_stiffness(a, b, emit)` calls
/// emit(of_b, i, by_b, j, K) with K = −∂f_i/∂x_j (3 × 3, N/m) for pairs of particles, at the state of the last call of `apply`;
/// of_b and by_b say whether i and j are particles of B. The contributions to a pair add up.
template <class C>
concept ContactWithStiffness = requires(const C& c, const ParticleFields& a, const ParticleFields& b,
                                        void (*emit)(bool of_b, Index i, bool by_b, Index j, const Tensor3& stiffness)) {
  c.add_stiffness(a, b, emit);
};

namespace detail {

/// The same emit for who takes the bodies in the other order.
template <class Emit>
[[nodiscard]] auto exchanged(const Emit& emit) {
  return [&emit](bool of_b, Index i, bool by_b, Index j, const Tensor3& stiffness) { emit(!of_b, i, !by_b, j, stiffness); };
}

/// Emits the stiffness k of a spring between a place on a facet of A and one on a facet of B, from their shape functions.
template <class FacetA, class ShapeA, class FacetB, class ShapeB, class Emit>
void emit_spring(const FacetA& on_a, const ShapeA& na, const FacetB& on_b, const ShapeB& nb, const Tensor3& k, const Emit& emit) {
  for (std::size_t r = 0; r < on_a.size(); ++r) {
    for (std::size_t c = 0; c < on_a.size(); ++c) emit(false, on_a[r], false, on_a[c], Tensor3(na[r] * na[c] * k));
    for (std::size_t c = 0; c < on_b.size(); ++c) {
      emit(false, on_a[r], true, on_b[c], Tensor3(-na[r] * nb[c] * k));
      emit(true, on_b[c], false, on_a[r], Tensor3(-na[r] * nb[c] * k));
    }
  }
  for (std::size_t r = 0; r < on_b.size(); ++r)
    for (std::size_t c = 0; c < on_b.size(); ++c) emit(true, on_b[r], true, on_b[c], Tensor3(nb[r] * nb[c] * k));
}

}  // namespace detail

}  // namespace tactoid
