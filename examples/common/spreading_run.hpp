#pragma once

#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>

#include <fmt/format.h>

#include <tactoid/tactoid.hpp>

#include <common/options.hpp>
#include <common/run_keeper.hpp>
#include <common/spreading_case.hpp>
#include <common/spreading_recorder.hpp>

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

  /// Composes a case, such as SpreadingCase, and runs it to its end_time. Writes the effective `options`, history, frames
  /// and summary in `out`; after a breakdown, which is thrown again, too.
  template <class Case>
  void operator()(const Case& spreading, const Options& options) const;
};

template <class Case>
void SpreadingRun::operator()(const Case& spreading, const Options& options) const {
  const SpreadingParameters& p = spreading.p;
  set_thread_count(threads);
  if (Ranks::current != nullptr) Ranks::current->require_same("set of options", options.toml());
  const auto start = std::chrono::steady_clock::now();
  auto simulation = spreading.simulation();

  const std::optional<double> resumed_at = restart.resume(simulation);
  Restart::require_end_after(resumed_at, p.end_time);
  prepare_folder(out);
  SpreadingRecorder<std::decay_t<decltype(simulation)>::dimension> recorder(out, p.bond_range, resumed_at, spreading.added.columns());
  if (resumed_at) recorder.measure(simulation);
  restart.restore("recorder", recorder);
  restart.announce(simulation);
  options.write_toml(std::filesystem::path(out) / "parameters.toml");
  const std::size_t first_step = simulation.steps();
  RunKeeper keeper(restart, options, out, [&](StateWriter& writer) {
    writer.part("simulation", simulation);
    writer.part("recorder", recorder);
  });
  Progress progress(p.end_time, simulation.time());
  const std::string ranks = Ranks::current != nullptr && Ranks::current->size() > 1 ? fmt::format("{} ranks of ", Ranks::current->size()) : "";
  const auto tell = [](const std::string& line) {
    if (is_first_rank()) fmt::print("{}", line);
  };
  tell(fmt::format("cell {} particles, substrate {} particles, {} pairs, first stable step {:.3g} ns, {}{} threads\n",
                   simulation.template body<0>().size(), simulation.template body<1>().size(), simulation.pairs(),
                   1e9 * simulation.largest_stable_time_step(), ranks, thread_count()));
  if (p.substrate_mass_scaling > 1.0)
    tell(fmt::format("mass scaling: the substrate is {:g} times as heavy as it is, its waves are {:.3g} times as slow\n", p.substrate_mass_scaling,
                     std::sqrt(p.substrate_mass_scaling)));
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const double setup = seconds();
  const auto record = [&](auto& s) { recorder.record(s, spreading.added.values(s)); };
  const auto watch_energy = [&](auto& s) {
    const double error = s.ledger().error();
    if (s.steps() < 100 || error <= energy_limit) return;  // at first there is little work to compare with
    record(s);
    recorder.write_frame(s);
    throw ComputationError(fmt::format(
        "The energy balance is off by {:.3g} % at t = {:.6g} s, and --max-energy-error allows {:.3g} %; likely causes are "
        "too weak a stabilisation or too large a time step.",
        100.0 * error, s.time(), 100.0 * energy_limit));
  };
  const auto finish = [&](bool completed) {
    progress.finish();
    recorder.write_summary(simulation, p.substrate_mass_scaling, simulation.steps() - first_step, seconds() - setup, completed);
  };
  keeper.run([&] {
    simulation.run(p.end_time, every(p.end_time / samples, record),
                   every(p.end_time / frames, [&](auto& s) { recorder.write_frame(s); }),
                   every_steps(10, [&](auto& s) {
                     progress.update(s.time(), s.steps() - first_step);
                     watch_energy(s);
                   }),
                   every_steps(1, [&](auto&) { keeper.check(); }));  // the last one: the others have seen the step
  }, finish);
  tell(fmt::format("{} steps in {:.1f} s (set-up {:.1f} s), energy error {:.2g} %; results in {}\n", simulation.steps() - first_step,
                   seconds() - setup, setup, 100.0 * simulation.ledger().error(), out));
}

// The runs of these are compiled once, in spreading_run.cpp; those of other cases where they are used.
extern template void SpreadingRun::operator()(const SpreadingCase<YangVisco<>>&, const Options&) const;
extern template void SpreadingRun::operator()(const SpreadingCase<GradedSubstrate>&, const Options&) const;
extern template void SpreadingRun::operator()(const SpreadingCase<YangVisco<>, 2>&, const Options&) const;

}  // namespace tactoid
