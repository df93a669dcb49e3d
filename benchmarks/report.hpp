#pragma once

#include <chrono>
#include <ctime>

#include <benchmark/benchmark.h>

#include <tactoid/core/parallel.hpp>

namespace tactoid {

/// Runs `work()` in the benchmark's loop and reports it per unit as well: `ns_per_<unit>` for each of the counts
/// given, as in `measure(state, work, {{"ns_per_pair", pairs}})`. With one thread the time of the processor counts,
/// which other programs disturb least; with more the time on the clock.
template <class Work>
void measure(benchmark::State& state, const Work& work,
             std::initializer_list<std::pair<const char*, std::size_t>> counts) {
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor_start = std::clock();
  for (auto _ : state) work();
  const double processor = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  const double clock = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double seconds = (thread_count() == 1 ? processor : clock) / static_cast<double>(state.iterations());
  for (const auto& [name, count] : counts) state.counters[name] = 1e9 * seconds / static_cast<double>(count);
}

/// Adds `bytes_per_particle` and `pairs_per_point` of a body.
template <class Body>
void describe(benchmark::State& state, const Body& body) {
  state.counters["bytes_per_particle"] = static_cast<double>(body.memory()) / static_cast<double>(body.size());
  state.counters["pairs_per_point"] =
      static_cast<double>(body.table().pairs()) / static_cast<double>(body.table().points());
}

}  // namespace tactoid
