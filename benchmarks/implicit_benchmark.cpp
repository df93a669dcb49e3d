// Implicit steps of the viscous cell on its substrate in three dimensions, everything on: what the first step takes, with the tangent and its factors, and
// what the following ones do. Arguments: resolution in per cent of the paper's; preconditioner (0: factors, 1: incomplete factors); threads.
#include "report.hpp"
#include <common/spreading_case.hpp>

namespace {

using namespace tactoid;

void cell_on_substrate(benchmark::State& state) {
  set_thread_count(static_cast<int>(state.range(2)));
  SpreadingParameters p{.viscosity = 10.0, .activity = 0.0, .director = "radial", .preset = "elastic", .van_der_waals = 100.0, .surface_smoothing = 0.05, .fluid_hourglass_viscosity = 1.0};
  p.resolution = 0.01 * static_cast<double>(state.range(0));
  p.bonds_on = "substrate";
  const ImplicitDynamics steps{.time_step = 1e-3, .newton_tolerance = 1e-6, .preconditioner = state.range(1) == 0 ? Preconditioner::factorization : Preconditioner::incomplete};
  auto simulation = SpreadingCase{p, p.substrate_law(10e3 / (6.0 * (p.substrate_c1 + p.substrate_c2)))}.simulation(steps);
  const auto step = [&] { simulation.run(simulation.time() + steps.time_step); };
  const auto start = std::chrono::steady_clock::now();
  step();
  state.counters["first_step_s"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const ImplicitReport before = simulation.integrator().report();
  measure(state, step, {});
  const ImplicitReport after = simulation.integrator().report();
  const auto per_step = [&](std::size_t last, std::size_t first) { return static_cast<double>(last - first) / static_cast<double>(state.iterations()); };
  state.counters["particles"] = static_cast<double>(simulation.body<0>().size() + simulation.body<1>().size());
  state.counters["unknowns"] = static_cast<double>(simulation.integrator().past.z.size());
  state.counters["newton"] = per_step(after.newton_iterations, before.newton_iterations);
  state.counters["gmres"] = per_step(after.linear_iterations, before.linear_iterations);
  state.counters["tangents"] = per_step(after.factorizations, before.factorizations);
}

BENCHMARK(cell_on_substrate)->ArgNames({"resolution", "incomplete", "threads"})->ArgsProduct({{30, 40, 60, 80}, {0, 1}, {1}})->Iterations(10)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
