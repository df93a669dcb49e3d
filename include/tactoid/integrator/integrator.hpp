#pragma once

#include <concepts>

#include <tactoid/core/unsatisfied.hpp>

namespace tactoid {

/// Whether the integrator I says `static constexpr bool synchronous = true`: velocities belong to the end of the step, as in
/// implicit schemes, and the director is one of its unknowns. Others keep velocities at the middle of the steps.
template <class I>
inline constexpr bool synchronous = [] {
  if constexpr (requires { I::synchronous; }) return bool(I::synchronous);
  else return false;
}();

/// Whether the integrator I says `static constexpr bool subcycled = true`: its `max_ratio` is the largest number of its steps that a
/// body may take as one. Velocities are at the middle of the steps.
template <class I>
inline constexpr bool subcycled = [] {
  if constexpr (requires { I::subcycled; }) return bool(I::subcycled);
  else return false;
}();

/// Advances a system in time.
///
/// The system (a Simulation) offers
///   double time();                        s
///   double last_time_step();              of the step that led to the present state; 0 at the start
///   double largest_stable_time_step();    s, at the present state, without any safety factor
///   void kick(double dt);                 v ← v + dt M⁻¹ f
///   void drift(double dt);                u ← u + dt v, then the essential conditions at time + dt; time ← time + dt
///   void evaluate();                      forces, energies and directors at the present state
/// One that is subcycled also uses
///   auto stable_time_steps();             s, of each body alone: an array of System::body_count
///   void set_body_steps(steps);           s, from the next kick at which a body is due; 0: it takes every step
/// One that is synchronous uses what ImplicitDynamics does (implicit_dynamics.hpp).
/// `initialize` is called once, after the first evaluate(); `step` takes one step, not beyond the time `until`.
template <class I, class System>
concept Integrator =
    (requires(I& i, System& s) {
      i.initialize(s);
    } || unsatisfied<"An Integrator has `void initialize(System&)`.">) &&
    (requires(I& i, System& s, double until) {
      i.step(s, until);
    } || unsatisfied<"An Integrator has `void step(System&, double until)`: one step, not beyond `until`.">);

}  // namespace tactoid
