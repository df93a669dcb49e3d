// One complete step: of the cell on its substrate at the paper's size, everything on; and of an elastic block in free
// flight after a bending velocity, with and without stabilisation. Beside them the yardstick: the bare sweep over the table
// of the same block. Arguments: particles along an edge of the block, threads.
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

template <class Real>
void cell_on_substrate(benchmark::State& state) {
  set_thread_count(static_cast<int>(state.range(0)));
  const SpreadingParameters p;
  auto simulation = SpreadingCase<decltype(p.substrate_law(10.0)), 3, NothingAdded, Real>{p, p.substrate_law(10.0)}.simulation();
  steps(state, simulation);
  const auto& cell = simulation.template body<0>();
  const auto& substrate = simulation.template body<1>();
  state.counters["bytes_per_particle"] = static_cast<double>(cell.memory() + substrate.memory()) /
                                         static_cast<double>(cell.size() + substrate.size());
}

/// A cube of `edge`³ particles with about 50 neighbours each, with gradients stored as Real. Without the consistency correction, which
/// changes the numbers of the table and takes minutes for millions of particles.
template <class Real>
auto block(std::int64_t edge, double stabilization) {
  const int cells = static_cast<int>(edge) - 1;
  const double size = 1e-2;
  Body body{"block", box({.size = {size, size, size}, .cells = {cells, cells, cells}}), Rkpm<3>{.support = 2.35},
            stored_as<Real>(NodalCentroids{.solid_ratio = stabilization, .consistency_tolerance = 0.0}), Materials{Region{"body", NeoHookean::from_young(1e6, 0.3)}}};
  for (std::size_t i = 0; i < body.size(); ++i) {
    const double z = body.cloud().positions[i][2] / size;
    body.velocity[i][0] = 0.1 * z * z;
  }
  return body;
}

enum Stabilized { plain, stabilized };
template <class Real, Stabilized Choice>
void elastic_block(benchmark::State& state) {
  set_thread_count(static_cast<int>(state.range(1)));
  Simulation simulation{Bodies{block<Real>(state.range(0), Choice == stabilized ? 0.1 : 0.0)}, Contacts{}, Boundaries{}, CentralDifference{}};
  steps(state, simulation);
  describe(state, simulation.template body<0>());
}

/// What no step can do without: per point one sweep over its row to gather F, something linear in the place of a stress, one
/// sweep to scatter it. In the order of the points, by each thread into forces of its own, which are then added up; no law, no
/// stabilisation, no energies, no time step. Steps are given as ratios to it.
template <class Real>
void bare_sweep(benchmark::State& state) {
  set_thread_count(static_cast<int>(state.range(1)));
  const Body body = block<Real>(state.range(0), 0.0);
  using Entry = typename std::decay_t<decltype(body)>::Entry;
  const PointTable& table = body.table();
  const std::size_t n = table.particles, threads = static_cast<std::size_t>(state.range(1));
  const Field displacement(n, Vector4(1e-6, 2e-6, 3e-6, 0.0));
  Field force(n, Vector4::Zero());
  std::vector<Field> own(threads, force);
  const auto sweep = [&](std::size_t thread) {
    Field& f = own[thread];
    std::fill(f.begin(), f.end(), Vector4::Zero());
    for (std::size_t q = table.points() * thread / threads; q < table.points() * (thread + 1) / threads; ++q) {
      const auto row = table.stored_row<Entry>(q);
      if constexpr (std::is_same_v<Entry, TableEntry>) {  // in words of its own: what becomes slower in the library must not become slower here
        Quad even[3] = {}, odd[3] = {};
        for (std::size_t k = 0; k < row.size(); k += 2)
          for (int K = 0; K < 3; ++K) {
            even[K] += row[k].gradient[K] * quad(displacement[row[k].particle].data());
            odd[K] += row[k + 1].gradient[K] * quad(displacement[row[k + 1].particle].data());
          }
        const Quad x = 1e3 * (even[0] + odd[0]), y = 1e3 * (even[1] + odd[1]), z = 1e3 * (even[2] + odd[2]);
        for (const TableEntry& entry : row)
          quad(f[entry.particle].data()) -= entry.gradient[0] * x + entry.gradient[1] * y + entry.gradient[2] * z;
      } else {
        rows::Gradient du;
        rows::gather(row, displacement.data(), du);
        for (Quad& column : du.column) column *= 1e3;
        rows::scatter(row, du, {}, f.data());
      }
    }
  };
  measure(state,
          [&] {
            parallel_for(threads, sweep);
            parallel_for(n, [&](std::size_t i) {
              force[i] = own[0][i];
              for (std::size_t t = 1; t < threads; ++t) force[i] += own[t][i];
            });
            benchmark::DoNotOptimize(force.data());
          },
          {{"ns_per_pair", table.pairs()}, {"ns_per_particle", n}});
}

BENCHMARK(cell_on_substrate<double>)->Name("cell_on_substrate")->Arg(1)->Arg(2)->ArgName("threads")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(cell_on_substrate<float>)->Name("cell_on_substrate/single")->Arg(1)->Arg(2)->ArgName("threads")->Unit(benchmark::kMillisecond)->UseRealTime();
void sizes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"edge", "threads"})->ArgsProduct({{14, 20, 27, 38, 54, 76, 100, 160}, {1, 2}})->Unit(benchmark::kMillisecond)->UseRealTime();
}
BENCHMARK(bare_sweep<double>)->Name("bare_sweep")->Apply(sizes);
BENCHMARK(bare_sweep<float>)->Name("bare_sweep/single")->Apply(sizes);
BENCHMARK(elastic_block<double, plain>)->Name("elastic_block/plain")->Apply(sizes);
BENCHMARK(elastic_block<double, stabilized>)->Name("elastic_block/stabilized")->Apply(sizes);
BENCHMARK(elastic_block<float, plain>)->Name("elastic_block/plain/single")->Apply(sizes);
BENCHMARK(elastic_block<float, stabilized>)->Name("elastic_block/stabilized/single")->Apply(sizes);

}  // namespace

BENCHMARK_MAIN();
