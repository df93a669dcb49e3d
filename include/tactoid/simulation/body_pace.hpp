#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include <tactoid/boundary/essential_conditions.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/simulation/body.hpp>

namespace tactoid {

/// When a body takes its internal forces under an integrator that sub-cycles: at the ends of steps of its own, each a whole number of
/// those in which everything moves. In between it feels contacts and boundary terms only.
///
/// The forces act as impulses at the instants at which they are evaluated (impulse multiple time stepping: Tuckerman, Berne and Martyna,
/// J. Chem. Phys. 1992, 97, 1990; the synchronous case of asynchronous variational integrators, Lew, Marsden, Ortiz and West, Arch. Ration.
/// Mech. Anal. 2003, 167, 85): `Body::force` holds them with a weight, so that kicks and present velocities are those of steps
/// that are all alike. Laws, histories and the director see the mean velocity of the body's step, and advance by all of it.
class BodyPace {
 public:
  Field internal;  ///< internal forces at the last instant at which they were due, N; 0 where a component is prescribed
  Field held;      ///< those on prescribed components, N; 0 elsewhere

  /// Of a body of n particles that may take steps of its own; without this, it takes every step.
  void prepare(std::size_t n) {
    internal.assign(n, Vector4::Zero());
    held.assign(n, Vector4::Zero());
  }

  /// Whether the body has come to the end of a step of its own.
  [[nodiscard]] bool due() const { return due_; }
  /// Length of the body's own step, s, where everything takes steps of `time_step`.
  [[nodiscard]] double step(double time_step) const { return length_ > 0.0 && time_step > 0.0 ? length_ : time_step; }

  /// Before a kick by `interval`, half of `last_step` and half the next one: a body that is due begins a step of `length`; s. The impulse of
  /// its internal forces is half that of the step before and half that of this one.
  template <class Body>
  void begin_step(Body& body, double length, double interval, double last_step) {
    if (!due_) return;
    if (length > 0.0 || length_ > 0.0)
      weigh(body, (step(last_step) + (length > 0.0 ? length : 2.0 * interval - last_step)) / (2.0 * interval));
    length_ = length;
    age_ = 0.0;
    if (length > 0.0) start_ = body.displacement;
  }

  /// After a drift by `time_step`, s: velocities seem to be half a step behind, as all are, but this body's are those of the middle of
  /// its own step; the weight makes up for it.
  template <class Body>
  void drift(Body& body, double time_step) {
    if (length_ == 0.0) return;
    age_ += time_step;
    weigh(body, (2.0 * age_ - length_) / time_step);
  }

  /// Adds the internal forces to those of contacts and terms where the body is due, and returns its energies; powers are such that they count
  /// for `time_step`, s. Where it is not due, energies are the last ones and nothing has power. With 0 s it is due, and begins no step.
  template <class Body>
  BodyTotals add_internal_forces(Body& body, const EssentialConditions& essential, double time_step) {
    due_ = length_ == 0.0 || time_step == 0.0 || age_ > length_ - 0.5 * time_step;
    if (!due_) {
      weight_ = 0.0;
      for_each_condition(essential, [&](std::size_t i, int c) { body.force[i][c] += held[i][c]; });
      return totals_;
    }
    body.for_each_particle([&](std::size_t i) { internal[i] = body.force[i]; });
    exchange_velocities(body);
    totals_ = body.add_internal_forces(step(time_step), true);
    if (length_ > 0.0) std::swap(body.velocity, mean_);
    body.for_each_particle([&](std::size_t i) { internal[i] = body.force[i] - internal[i]; });
    // Prescribed components move as they must: there impulses would only make the reactions jump.
    for_each_condition(essential, [&](std::size_t i, int c) { held[i][c] = std::exchange(internal[i][c], 0.0); });
    const double share = time_step > 0.0 ? step(time_step) / time_step : weight_;
    weight_ = 1.0;
    weigh(body, share);
    BodyTotals booked = totals_;
    booked.dissipated_power *= share;
    booked.active_power *= share;
    totals_.dissipated_power = totals_.active_power = 0.0;
    return booked;
  }

  /// After a step that broke down: nothing is known of forces, and the next step begins anew.
  void forget() {
    std::fill(internal.begin(), internal.end(), Vector4::Zero());
    due_ = true;
  }

  /// For checkpoints, at an instant at which the body is due; of the particles in `rows`.
  template <class Archive>
  void state(Archive& archive, const StateRows* rows) {
    archive("internal", internal, rows);
    archive("length", length_);
    archive("weight", weight_);
    archive("held", held, rows);
    archive("strain_energy", totals_.strain_energy);
    archive("stabilization_energy", totals_.stabilization_energy);
    if constexpr (Archive::restoring) due_ = true;
  }

 private:
  /// Forces with another weight of the internal ones.
  template <class Body>
  void weigh(Body& body, double weight) {
    const double more = weight - weight_;
    weight_ = weight;
    if (more != 0.0) body.for_each_particle([&](std::size_t i) { body.force[i] += more * internal[i]; });
  }

  /// Gives the body the mean velocity of its step, until it is swapped back: it belongs to the way that the particles have gone.
  template <class Body>
  void exchange_velocities(Body& body) {
    if (length_ == 0.0) return;
    mean_.resize(body.size(), Vector4::Zero());
    body.for_each_particle([&](std::size_t i) { mean_[i] = (body.displacement[i] - start_[i]) / length_; });
    std::swap(body.velocity, mean_);
  }

  template <class F>
  static void for_each_condition(const EssentialConditions& essential, const F& f) {
    for (int c = 0; c < 3; ++c)
      for (const EssentialConditions::Condition& condition : essential.conditions(c)) f(condition.particle, c);
  }

  double length_ = 0.0;        // of the body's present step, s; 0: every step
  double age_ = 0.0;           // time since it began, s
  double weight_ = 1.0;        // of `internal` in the forces of the body
  bool due_ = true;
  Field start_, mean_;         // displacement at the beginning of the step, m; mean velocity in it, m/s
  BodyTotals totals_;          // energies where the body was due the last time
};

}  // namespace tactoid
