#pragma once

#include <functional>
#include <string>

#include <tactoid/tactoid.hpp>

#include <common/options.hpp>
#include <common/run_keeper.hpp>
#include <common/spreading_case.hpp>

namespace tactoid {

/// A cell that spreads on a substrate, from its composition to its results: what the spreading examples share.
struct SpreadingRun {
  std::string out;             ///< folder of the results
  int threads = thread_count();
  int frames = 20;             ///< for ParaView
  int samples = 200;           ///< lines of the history
  double energy_limit = 0.1;   ///< relative error of the energy balance that stops the run
  Restart restart = {};        ///< whether it goes on with a former run, and how often it is kept

  void add_to(Options& options) {
    restart.add_to(options);
    options.add("out", &out, "Folder of the results");
    options.add("threads", &threads, Range::between(1, 1024), "Threads");
    options.add("frames", &frames, Range::between(1, 100000), "Frames for ParaView");
    options.add("samples", &samples, Range::between(1, 1000000), "Lines of the history");
    options.add("max-energy-error", &energy_limit, Range::positive(), "Relative energy error that stops the run");
  }

  /// Composes a case, one of those below, and runs it to its end_time. Writes the effective `options`, history, frames
  /// and summary in `out`; after a breakdown, which is thrown again, too.
  template <class Case>
  void operator()(const Case& spreading, const Options& options) const;
};

/// The substrate of the paper, of a stiffness that depends on the place.
using GradedSubstrate = Graded<std::function<YangVisco<>(const Vector3&)>>;
// Their runs are compiled once, in spreading_run.cpp.
extern template void SpreadingRun::operator()(const SpreadingCase<YangVisco<>>&, const Options&) const;
extern template void SpreadingRun::operator()(const SpreadingCase<GradedSubstrate>&, const Options&) const;
extern template void SpreadingRun::operator()(const SpreadingCase<YangVisco<>, 2>&, const Options&) const;

}  // namespace tactoid
