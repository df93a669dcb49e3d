#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <utility>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/unsatisfied.hpp>

namespace tactoid {

/// What Simulation::run calls. An observer may read everything and changes nothing.
///   begin(simulation)        before the first step
///   next_time(simulation)    s: the run stops exactly there, and calls after_step; infinity if it does not matter
///   after_step(simulation)   after every step
///   end(simulation)          at the end of the run
///   last_good_state(simulation)   instead of end, when a step broke down: the state before it has been restored
///   resume(simulation)       optional, instead of begin, where the state of a former run was restored: the observer goes on
///                            as that run's would have, which began at simulation.run_start() and run_start_steps()
template <class O, class System>
concept Observer =
    (requires(O& o, System& s) {
      o.begin(s);
      o.after_step(s);
      o.end(s);
      o.last_good_state(s);
    } || unsatisfied<"An Observer has begin, after_step, end and last_good_state, each called with the Simulation; "
                     "wrap a function as `every(interval, function)`.">) &&
    (requires(O& o, System& s) {
      { o.next_time(s) } -> std::convertible_to<double>;
    } || unsatisfied<"An Observer has `double next_time(const Simulation&)`: when it must be called next, s.">);

/// Calls `function(simulation)` at the start, every `interval` seconds of simulated time and at the end.
template <class F>
class Every {
 public:
  /// `interval` in s of simulated time, > 0: throws ParameterError.
  Every(double interval, F function) : interval_(interval), function_(std::move(function)) {
    require_positive("every: interval", interval, "s");
  }
  /// First call; the interval counts from here.
  template <class S>
  void begin(S& simulation) {
    start_ = simulation.time();
    count_ = 0;
    call(simulation);
  }
  /// Goes on in the intervals of the run that was saved.
  template <class S>
  void resume(const S& simulation) {
    // An event that differs from the present by round-off has been.
    start_ = simulation.run_start();
    const double now = simulation.time(), close = 1e-9 * interval_;
    count_ = 0;
    while (next_time(simulation) <= now + close) ++count_;
    const double last = start_ + interval_ * static_cast<double>(count_);
    called_ = std::abs(now - last) <= close ? now : last;
  }
  /// Of the next call, s.
  template <class S>
  [[nodiscard]] double next_time(const S&) const { return start_ + interval_ * static_cast<double>(count_ + 1); }
  /// Calls the function if its time has come.
  template <class S>
  void after_step(S& simulation) {
    if (simulation.time() < next_time(simulation)) return;
    ++count_;
    call(simulation);
  }
  /// A last call, unless there was one at this time.
  template <class S>
  void end(S& simulation) {  // unless it was called at this time already
    if (simulation.time() > called_) call(simulation);
  }
  /// A last call with the state before the failure.
  template <class S>
  void last_good_state(S& simulation) { end(simulation); }

 private:
  template <class S>
  void call(S& simulation) {
    called_ = simulation.time();
    function_(simulation);
  }
  double interval_;
  F function_;
  double start_ = 0.0, called_ = -1.0;
  long count_ = 0;
};

/// An observer from a function of the simulation: `every(0.1_us, [](auto& s) { … })`. Throws ParameterError unless
/// `interval` > 0, s.
template <class F>
[[nodiscard]] Every<F> every(double interval, F function) {
  return {interval, std::move(function)};
}

/// Calls `function(simulation)` at the start, after every `steps` steps and at the end; the times of the steps are not
/// touched.
template <class F>
class EverySteps {
 public:
  /// `steps` >= 1: throws ParameterError.
  EverySteps(long steps, F function) : steps_(steps), function_(std::move(function)) {
    if (steps < 1) reject("every_steps: steps", static_cast<double>(steps), "", "at least 1");
  }
  /// First call; steps count from here.
  template <class S>
  void begin(S& simulation) { function_(simulation); }
  /// Goes on counting where the run that was saved had come to.
  template <class S>
  void resume(const S& simulation) { count_ = static_cast<long>(simulation.steps() - simulation.run_start_steps()); }
  /// S: no instant is asked for.
  template <class S>
  [[nodiscard]] double next_time(const S&) const { return std::numeric_limits<double>::infinity(); }
  /// Calls the function if this is one of its steps.
  template <class S>
  void after_step(S& simulation) {
    if (++count_ % steps_ == 0) function_(simulation);
  }
  /// A last call, unless the last step had one.
  template <class S>
  void end(S& simulation) {
    if (count_ % steps_ != 0) function_(simulation);
  }
  /// A last call with the state before the failure.
  template <class S>
  void last_good_state(S& simulation) { function_(simulation); }

 private:
  long steps_, count_ = 0;
  F function_;
};

/// An observer from a function of the simulation: `every_steps(10, [](auto& s) { … })`. Throws ParameterError unless
/// `steps` >= 1.
template <class F>
[[nodiscard]] EverySteps<F> every_steps(long steps, F function) {
  return {steps, std::move(function)};
}

}  // namespace tactoid
