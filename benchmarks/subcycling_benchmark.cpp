// What steps of the bodies' own save: the cell on its substrate at the paper's size, and a small stiff block that sticks to a large soft
// one. Arguments: largest ratio of the steps (1: central differences); for the blocks how much stiffer the small one is, and bonds per µm²: bonds limit
// the steps of what they hold. An iteration takes a given simulated time, so that the times of two ratios compare; evaluations of internal forces are
// counted per body.
#include <string>

#include "report.hpp"
#include <common/spreading_case.hpp>

namespace {

using namespace tactoid;

/// Simulated time of an iteration, in first stable steps.
constexpr double steps_per_iteration = 64.0;

template <class Simulation>
void simulated_time(benchmark::State& state, Simulation& simulation) {
  const double duration = steps_per_iteration * simulation.integrator().safety * simulation.largest_stable_time_step();
  const std::size_t before = simulation.steps();
  std::size_t small = 0;
  measure(state, [&] { simulation.run(simulation.time() + duration); }, {});
  const auto& report = simulation.integrator().report;
  const auto per_iteration = [&](std::size_t n) { return static_cast<double>(n) / static_cast<double>(state.iterations()); };
  small = simulation.integrator().max_ratio > 1 ? report.steps : simulation.steps() - before;
  state.counters["small_steps"] = per_iteration(small);
  for (std::size_t b = 0; b < 2; ++b)
    state.counters["steps_" + std::to_string(b)] = per_iteration(simulation.integrator().max_ratio > 1 ? report.body_steps[b] : small);
  state.counters["energy_error"] = simulation.ledger().error();
}

void cell_on_substrate(benchmark::State& state) {
  set_thread_count(1);
  SpreadingParameters p;
  p.gap = 20e-9;  // soon in contact
  p.subcycling = static_cast<int>(state.range(0));
  auto simulation = SpreadingCase{p, p.substrate_law(10.0)}.simulation();
  const auto pairs = [](const auto& body) { return static_cast<double>(body.table().pairs()); };
  state.counters["share_of_pairs"] = pairs(simulation.body<1>()) / (pairs(simulation.body<0>()) + pairs(simulation.body<1>()));
  simulated_time(state, simulation);
}

/// 20 µm of soft gel and a stiff block of 3 µm on it, both of the same resolution; neither is held.
void small_stiff_block(benchmark::State& state) {
  set_thread_count(1);
  constexpr double edge = 0.75e-6, young = 1.5e3;
  const auto elastic = [=](const char* name, int width, int height, double bottom, double modulus) {
    const double half = 0.5 * width * edge;
    return Body{name, box({.size = {2.0 * half, 2.0 * half, height * edge}, .cells = {width, width, height}, .origin = {-half, -half, bottom}}), Rkpm<3>{},
                NodalCentroids{}, Materials{Region{"body", NeoHookean::from_young(modulus, 0.4)}}};
  };
  Body stiff = elastic("stiff", 4, 4, 0.1e-6, young * static_cast<double>(state.range(1)));
  Body soft = elastic("soft", 26, 13, -13 * edge, young);
  for (auto& v : stiff.velocity) v[2] = -0.05;
  Simulation simulation{Bodies{std::move(soft), std::move(stiff)}, Contacts{between<1, 0>(LigandReceptor{.bond_density = 1e12 * static_cast<double>(state.range(2))})}, Boundaries{},
                        SubcycledCentralDifference{CentralDifference{}, static_cast<int>(state.range(0))}};
  simulated_time(state, simulation);
}

BENCHMARK(cell_on_substrate)->ArgName("ratio")->Arg(1)->Arg(2)->Arg(4)->Arg(8)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(small_stiff_block)->ArgNames({"ratio", "stiffer", "bonds"})->ArgsProduct({{1, 4, 16}, {64, 256}, {50, 500}})->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
