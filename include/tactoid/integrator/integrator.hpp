#pragma once

#include <concepts>

#include <tactoid/core/unsatisfied.hpp>

namespace tactoid {

/// Advances a system in time.
///
/// The system (a Simulation) offers
///   double time();                        s
///   double last_time_step();              of the step that led to the present state; 0 at the start
///   double largest_stable_time_step();    s, at the present state, without any safety factor
///   void kick(double dt);                 v ← v + dt M⁻¹ f
///   void drift(double dt);                u ← u + dt v, then the essential conditions at time + dt; time ← time + dt
///   void evaluate();                      forces, energies and directors at the present state
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
