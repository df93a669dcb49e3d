#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/output/checkpoint.hpp>

#include <common/options.hpp>
#include <common/stop_signal.hpp>

namespace tactoid {

/// The options --restart and --checkpoint-every of a program, and the state from which a run goes on.
struct Restart {
  double checkpoint_every = 600.0;      ///< s of wall time; 0: no checkpoint at all
  std::optional<Checkpoint> from = {};  ///< where the run goes on

  /// Declares the options; `options` reads them into this object, which must outlive it.
  void add_to(Options& options) {
    options.add_source(
        "restart", "FILE.h5",
        [this, &options](const std::string& file) {
          from = read_checkpoint(file);
          if (from->program != options.program())
            throw FileError(fmt::format("{} is a checkpoint of {}, not of {}.", in_quotes(file), from->program, options.program()));
          return from->parameters;
        },
        "Go on where this checkpoint is, with its options");
    options.add_quantity("checkpoint-every", &checkpoint_every, Quantity::time, Range::non_negative(),
                         "Wall time between two checkpoints, out/checkpoint.h5; 0: none");
  }

  /// Gives a part of the state back where the run is continued. Throws ParameterError for the state of something else.
  template <class T>
  void restore(std::string_view part, T& x) const {
    if (from) StateReader(from->state).part(part, x);
  }
  /// Lets a simulation, composed as the one that was saved, go on from there: its time, s; nothing for a new run.
  template <class S>
  std::optional<double> resume(S& simulation) const {
    if (!from) return {};
    restore("simulation", simulation);
    return simulation.time();
  }
  /// Says on the standard output where the run goes on, once all is restored.
  template <class S>
  void announce(const S& simulation) const {
    if (from && is_first_rank()) fmt::print("going on from t = {:.6g} s, step {}\n", simulation.time(), simulation.steps());
  }
  /// Throws ParameterError where the run would end before the state at `resumed_at` from which it goes on, s.
  static void require_end_after(std::optional<double> resumed_at, double end_time) {
    if (resumed_at && end_time < *resumed_at)
      throw ParameterError(fmt::format("--end-time = {:g} s is not allowed: the checkpoint is at {:g} s.", end_time, *resumed_at));
  }
};

/// Keeps a run so that it can be continued: while it lives, SIGINT and SIGTERM are noted, and out/checkpoint.h5 is written
/// when its time has come.
class RunKeeper {
 public:
  /// `parts(writer)` writes all that Restart::restore gives back; `options` and all that it needs must outlive the keeper.
  RunKeeper(const Restart& restart, const Options& options, std::filesystem::path folder, std::function<void(StateWriter&)> parts)
      : every_(restart.checkpoint_every), options_(options), folder_(std::move(folder)), parts_(std::move(parts)) {}

  /// After every step, when all observers have seen it. Throws Interrupted once a signal has come: then save() keeps the state.
  /// Of several processes all do so in the same step, whichever the signal or the time has come to.
  void check() {
    const bool due = std::chrono::duration<double>(Clock::now() - saved_).count() > every_;
    long wish = 2 * stop_.received() + (due ? 1 : 0);
    if (Ranks::current != nullptr) wish = Ranks::current->largest(wish);
    if (wish > 1) throw Interrupted{static_cast<int>(wish / 2)};
    if (wish == 1) save();
  }
  /// Calls work(), which calls check() after every step, keeps the state at its end, and says finish(completed). Where a signal
  /// ended the work the state is kept, too; where a step broke down it is not: the checkpoint there is stays. Both go on.
  template <class Work, class Finish>
  void run(const Work& work, const Finish& finish) {
    try {
      work();
    } catch (const Interrupted&) {
      save();
      finish(false);
      throw;
    } catch (const ComputationError&) {
      finish(false);
      throw;
    }
    save();
    finish(true);
  }
  /// Writes the checkpoint, unless none is wanted. Throws FileError.
  void save() {
    if (every_ == 0.0) return;
    Checkpoint checkpoint{options_.program(), options_.toml(), {}};
    StateWriter writer(checkpoint.state);
    parts_(writer);
    write_checkpoint(folder_ / "checkpoint.h5", checkpoint);
    saved_ = Clock::now();
  }

 private:
  using Clock = std::chrono::steady_clock;
  double every_;
  const Options& options_;
  std::filesystem::path folder_;
  std::function<void(StateWriter&)> parts_;
  StopSignal stop_;
  Clock::time_point saved_ = Clock::now();
};

}  // namespace tactoid
