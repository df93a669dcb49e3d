#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <tactoid/core/errors.hpp>

namespace tactoid {

/// Central differences (velocity Verlet, leapfrog form): velocities live at the middle of the steps,
///   v_{n+½} = v_{n−½} + ½(Δt_{n−1} + Δt_n) a_n,   u_{n+1} = u_n + Δt_n v_{n+½}.
/// Second order, symplectic for conservative forces, and conserves linear momentum to round-off. Forces that depend on
/// the velocity see v_{n−½}. The step is `safety` times the largest stable one, which the system re-evaluates in
/// every step; the last steps before an event are made equal, so that it is hit exactly.
struct CentralDifference {
  double safety = 0.8;                                                ///< of the largest stable step, in (0, 1]
  double time_step = 0.0;                                             ///< fixed step, s; 0: chosen by the library
  double max_time_step = std::numeric_limits<double>::infinity();     ///< cap, s
  double min_time_step = 1e-15;                                       ///< floor, s: below it the run stops

  /// Throws ParameterError unless safety is in (0, 1], time_step and min_time_step >= 0, max_time_step > 0.
  void validate() const {
    if (!(safety > 0.0 && safety <= 1.0)) reject("CentralDifference.safety", safety, "", "in (0, 1]");
    require_non_negative("CentralDifference.time_step", time_step, "s");
    require_non_negative("CentralDifference.min_time_step", min_time_step, "s");
    if (!(max_time_step > 0.0)) reject("CentralDifference.max_time_step", max_time_step, "s", "positive");
  }

  /// Checks the parameters; throws ParameterError for a fixed step above the stable one of the first state.
  template <class System>
  void initialize(System& system) const {
    validate();
    const double stable = system.largest_stable_time_step();
    if (time_step > stable)
      throw ParameterError(fmt::format("CentralDifference.time_step = {:g} s is not allowed: it must not exceed the stable step, {:.4g} s.",
                                       time_step, stable));
  }

  /// One step: kick by the mean of the last step and this one, drift, evaluate; not beyond `until` (s). A step
  /// that is not fixed is at most twice the one before. Throws ComputationError when the step falls below
  /// min_time_step, or the stable step below the fixed one.
  template <class System>
  void step(System& system, double until) const {
    double dt = longest_step(system);
    const double remaining = until - system.time();
    if (remaining <= 0.0) return;
    if (time_step > 0.0) dt = std::min(dt, remaining);
    else dt = remaining / std::ceil(remaining / dt * (1.0 - 1e-12));
    advance(system, dt);
  }

 protected:
  /// The step that the present state allows, s, wherever the next event is. Throws as step().
  template <class System>
  [[nodiscard]] double longest_step(System& system) const {
    const double stable = system.largest_stable_time_step();
    double dt = time_step > 0.0 ? time_step : std::min(safety * stable, max_time_step);
    // Contacts look two steps ahead for what limits the next one: it may not be longer than that.
    if (time_step == 0.0 && system.last_time_step() > 0.0) dt = std::min(dt, 2.0 * system.last_time_step());
    if (!(dt >= min_time_step) || dt > stable)
      throw ComputationError(fmt::format(
          "The stable time step at t = {:.6g} s is {:.3g} s, {}: a region is compressed or sheared too far, or a contact is too stiff.",
          system.time(), stable, dt > stable ? "below the fixed step" : "below CentralDifference.min_time_step"));
    return dt;
  }

  /// Kick, drift and evaluate: a step of dt, s.
  template <class System>
  static void advance(System& system, double dt) {
    system.kick(0.5 * (system.last_time_step() + dt));
    system.drift(dt);
    system.evaluate();
  }
};

}  // namespace tactoid
