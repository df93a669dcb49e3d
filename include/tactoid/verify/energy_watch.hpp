#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <tactoid/simulation/energy_ledger.hpp>

namespace tactoid {

/// An observer that records how well a run keeps its books: the largest energy error after any step, and when.
///
///   EnergyWatch watch;
///   simulation.run(1_ms, watch);
///   watch.largest_error < 1e-3
///
/// A defect that is not a number counts as infinite. May be given to several runs of a simulation. A run that is continued knows
/// of the former one's errors if the watch was saved and restored (core/state.hpp) with the simulation.
struct EnergyWatch {
  double largest_error = 0.0;   ///< of EnergyLedger::error(): |defect| over the largest work done until then
  double largest_defect = 0.0;  ///< |total + dissipated − external work − initial|, J
  double time = 0.0;            ///< of the largest defect, s
  EnergyLedger last = {};       ///< the ledger after the last step

  /// Looks at the ledger of the first state.
  template <class S>
  void begin(S& simulation) {
    after_step(simulation);
  }
  /// Looks at the ledger of the state that was restored: of a watch that was restored, too, nothing changes.
  template <class S>
  void resume(S& simulation) {
    after_step(simulation);
  }
  /// Looks at the ledger.
  template <class S>
  void after_step(S& simulation) {
    last = simulation.ledger();
    const double defect = std::isnan(last.defect()) ? std::numeric_limits<double>::infinity() : std::abs(last.defect());
    if (defect > largest_defect) {
      largest_defect = defect;
      time = simulation.time();
    }
    largest_error = std::max(largest_error, std::isfinite(defect) ? last.error() : defect);
  }
  template <class S>
  void end(S&) {}  ///< nothing is left to do
  template <class S>
  void last_good_state(S&) {}  ///< what was recorded stays
  /// s: no instant is asked for.
  template <class S>
  [[nodiscard]] double next_time(const S&) const {
    return std::numeric_limits<double>::infinity();
  }

  /// For checkpoints: all of it.
  template <class Archive>
  void state(Archive& archive) {
    archive("largest_error", largest_error);
    archive("largest_defect", largest_defect);
    archive("time", time);
    archive.part("last", last);
  }

  /// |defect| over the largest work of the whole run: 0 at the start, where the error of the ledger is 0/0.
  [[nodiscard]] double error() const { return last.largest_work > 0.0 ? largest_defect / last.largest_work : 0.0; }
};

}  // namespace tactoid
