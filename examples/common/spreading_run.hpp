#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>

#include <fmt/format.h>

#include <tactoid/output/checkpoint.hpp>
#include <tactoid/tactoid.hpp>

#include <common/options.hpp>
#include <common/spreading_case.hpp>
#include <common/spreading_recorder.hpp>
#include <common/stop_signal.hpp>

namespace tactoid {

/// A cell that spreads on a substrate, from its composition to its results: what the spreading examples share.
struct SpreadingRun {
  std::string out;             ///< folder of the results
  int threads = thread_count();
  int frames = 20;             ///< for ParaView
  int samples = 200;           ///< lines of the history
  double energy_limit = 0.1;   ///< relative error of the energy balance that stops the run
  double checkpoint_every = 600.0;          ///< s of wall time; 0: no checkpoint at all
  std::optional<Checkpoint> restart = {};   ///< where the run goes on

  void add_to(Options& options) {
    options.add_source(
        "restart", "FILE.h5",
        [this, &options](const std::string& file) {
          restart = read_checkpoint(file);
          if (restart->program != options.program())
            throw FileError(fmt::format("{} is a checkpoint of {}, not of {}.", in_quotes(file), restart->program, options.program()));
          return restart->parameters;
        },
        "Go on where this checkpoint is, with its options");
    options.add_quantity("checkpoint-every", &checkpoint_every, Quantity::time, Range::non_negative(),
                         "Wall time between two checkpoints, out/checkpoint.h5; 0: none");
    options.add("out", &out, "Folder of the results");
    options.add("threads", &threads, Range::between(1, 1024), "Threads");
    options.add("frames", &frames, Range::between(1, 100000), "Frames for ParaView");
    options.add("samples", &samples, Range::between(1, 1000000), "Lines of the history");
    options.add("max-energy-error", &energy_limit, Range::positive(), "Relative energy error that stops the run");
  }

  /// Composes a case, such as SpreadingCase, and runs it to its end_time. Writes the effective `options`, history, frames
  /// and summary in `out`; after a breakdown, which is thrown again, too.
  template <class Case>
  void operator()(const Case& spreading, const Options& options) const {
    const SpreadingParameters& p = spreading.p;
    set_thread_count(threads);
    const auto start = std::chrono::steady_clock::now();
    auto simulation = spreading.simulation();

    std::optional<double> resumed_at;
    if (restart) {
      StateReader(restart->state).part("simulation", simulation);
      resumed_at = simulation.time();
      if (p.end_time < *resumed_at)
        throw ParameterError(fmt::format("--end-time = {:g} s is not allowed: the checkpoint is at {:g} s.", p.end_time, *resumed_at));
    }
    prepare_folder(out);
    SpreadingRecorder<std::decay_t<decltype(simulation)>::dimension> recorder(out, p.bond_range, resumed_at);
    if (restart) {
      recorder.measure(simulation);
      StateReader(restart->state).part("recorder", recorder);
      fmt::print("going on from t = {:.6g} s, step {}\n", simulation.time(), simulation.steps());
    }
    options.write_toml(std::filesystem::path(out) / "parameters.toml");
    const std::size_t first_step = simulation.steps();
    const StopSignal stop;
    auto saved = start;
    const auto save = [&](auto& s) {
      if (checkpoint_every == 0.0) return;
      Checkpoint checkpoint{options.program(), options.toml(), {}};
      StateWriter writer(checkpoint.state);
      writer.part("simulation", s);
      writer.part("recorder", recorder);
      write_checkpoint(std::filesystem::path(out) / "checkpoint.h5", checkpoint);
      saved = std::chrono::steady_clock::now();
    };
    Progress progress(p.end_time, simulation.time());
    fmt::print("cell {} particles, substrate {} particles, {} pairs, first stable step {:.3g} ns, {} threads\n",
               simulation.template body<0>().size(), simulation.template body<1>().size(), simulation.pairs(),
               1e9 * simulation.largest_stable_time_step(), thread_count());
    const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
    const double setup = seconds();
    const auto watch_energy = [&](auto& s) {
      const double error = s.ledger().error();
      if (s.steps() < 100 || error <= energy_limit) return;  // at first there is little work to compare with
      recorder.record(s);
      recorder.write_frame(s);
      throw ComputationError(fmt::format(
          "The energy balance is off by {:.3g} % at t = {:.6g} s, and --max-energy-error allows {:.3g} %; likely causes are "
          "too weak a stabilisation or too large a time step.",
          100.0 * error, s.time(), 100.0 * energy_limit));
    };
    const auto finish = [&](bool completed) {
      progress.finish();
      recorder.write_summary(simulation, simulation.steps() - first_step, seconds() - setup, completed);
    };
    try {
      simulation.run(p.end_time, every(p.end_time / samples, [&](auto& s) { recorder.record(s); }),
                     every(p.end_time / frames, [&](auto& s) { recorder.write_frame(s); }),
                     every_steps(10, [&](auto& s) {
                       progress.update(s.time(), s.steps() - first_step);
                       watch_energy(s);
                     }),
                     every_steps(1, [&](auto& s) {  // the last one: the others have seen the step
                       stop.check();
                       if (std::chrono::duration<double>(std::chrono::steady_clock::now() - saved).count() > checkpoint_every) save(s);
                     }));
    } catch (const Interrupted&) {
      save(simulation);
      finish(false);
      throw;
    } catch (const ComputationError&) {
      finish(false);
      throw;
    }
    save(simulation);
    finish(true);
    fmt::print("{} steps in {:.1f} s (set-up {:.1f} s), energy error {:.2g} %; results in {}\n", simulation.steps() - first_step,
               seconds() - setup, setup, 100.0 * simulation.ledger().error(), out);
  }
};

}  // namespace tactoid
