// Implicit steps of the viscous cell on its substrate in three dimensions, everything on: from the start, 200 nm above, over a time, in steps that are chosen
// by their error. Arguments: resolution in per cent of the paper's (40 takes minutes); preconditioner (0: LU factors, 1: incomplete ones); threads.
#include "report.hpp"
#include <common/spreading_case.hpp>

namespace {

using namespace tactoid;

void cell_on_substrate(benchmark::State& state) {
  set_thread_count(static_cast<int>(state.range(2)));
  SpreadingParameters p{.viscosity = 10.0, .activity = 0.0, .director = "radial", .preset = "elastic", .van_der_waals = 100.0, .bonds_on = "substrate", .surface_smoothing = 0.05, .fluid_hourglass_viscosity = 1.0};
  p.resolution = 0.01 * static_cast<double>(state.range(0));
  const ImplicitDynamics steps{.tolerance = 3e-4, .first_time_step = 1e-6, .newton_tolerance = 3e-6,
                               .preconditioner = state.range(1) == 0 ? Preconditioner::factorization : Preconditioner::incomplete};
  auto simulation = SpreadingCase{p, p.substrate_law(10e3 / (6.0 * (p.substrate_c1 + p.substrate_c2)))}.simulation(steps);
  measure(state, [&] { simulation.run(0.01); }, {});
  const ImplicitReport& report = simulation.integrator().report();
  state.counters["particles"] = static_cast<double>(simulation.body<0>().size() + simulation.body<1>().size());
  state.counters["unknowns"] = static_cast<double>(simulation.integrator().past.z.size());
  state.counters["steps"] = static_cast<double>(report.steps);
  state.counters["newton"] = static_cast<double>(report.newton_iterations);
  state.counters["gmres"] = static_cast<double>(report.linear_iterations);
  state.counters["tangents"] = static_cast<double>(report.factorizations);
}

BENCHMARK(cell_on_substrate)->ArgNames({"resolution", "incomplete", "threads"})->Args({20, 0, 1})->Args({20, 1, 1})->Args({30, 0, 1})->Args({30, 1, 1})->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
