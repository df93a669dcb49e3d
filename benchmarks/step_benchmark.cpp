// One complete step: of the cell on its substrate at the paper's size, everything on; and of an elastic block in free
// flight after a bending velocity, with and without stabilisation. The argument is the number of threads.
#include "report.hpp"
#include <common/spreading_case.hpp>

namespace {

using namespace tactoid;

/// One step per iteration: half the stable step, so that a step is never cut in two.
template <class Simulation>
void steps(benchmark::State& state, Simulation& simulation) {
  const double dt = 0.5 * simulation.integrator().safety * simulation.largest_stable_time_step();
  const std::size_t before = simulation.steps();
  std::size_t particles = 0;
  simulation.for_each_body([&](const auto& body, std::size_t) { particles += body.size(); });
  measure(state, [&] { simulation.run(simulation.time() + dt); },
          {{"ns_per_pair", simulation.pairs()}, {"ns_per_particle", particles}});
  if (simulation.steps() - before != static_cast<std::size_t>(state.iterations()))
    state.SkipWithError("an iteration was not one step");
}

void cell_on_substrate(benchmark::State& state) {
  set_thread_count(static_cast<int>(state.range(0)));
  const SpreadingParameters p;
  auto simulation = SpreadingCase{p, p.substrate_law(10.0)}.simulation();
  steps(state, simulation);
  const auto& cell = simulation.body<0>();
  const auto& substrate = simulation.body<1>();
  state.counters["bytes_per_particle"] = static_cast<double>(cell.memory() + substrate.memory()) /
                                         static_cast<double>(cell.size() + substrate.size());
}

/// 27³ particles with about 50 neighbours each.
void elastic_block(benchmark::State& state, double stabilization) {
  set_thread_count(static_cast<int>(state.range(0)));
  const double edge = 1e-2;
  Body block{"block", box({.size = {edge, edge, edge}, .cells = {26, 26, 26}}), Rkpm<3>{.support = 2.35},
             NodalCentroids{.solid_ratio = stabilization},
             Materials{Region{"body", NeoHookean::from_young(1e6, 0.3)}}};
  for (std::size_t i = 0; i < block.size(); ++i) {
    const double z = block.cloud().positions[i][2] / edge;
    block.velocity[i][0] = 0.1 * z * z;
  }
  Simulation simulation{Bodies{std::move(block)}, Contacts{}, Boundaries{}, CentralDifference{}};
  steps(state, simulation);
  describe(state, simulation.body<0>());
}

BENCHMARK(cell_on_substrate)->Arg(1)->Arg(2)->ArgName("threads")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(elastic_block, stabilized, 0.1)
    ->Arg(1)->Arg(2)->ArgName("threads")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(elastic_block, plain, 0.0)
    ->Arg(1)->Arg(2)->ArgName("threads")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
