// Set-up of a body, second half: the table of gradients of a quadrature rule, at the paper's size.
#include "report.hpp"
#include <common/spreading_parameters.hpp>

namespace {

using namespace tactoid;

template <class Quadrature>
void build(benchmark::State& state, const PointCloud<3>& cloud, const Quadrature& quadrature) {
  set_thread_count(1);
  PointTable table = quadrature.build(cloud, Rkpm<3>{});
  const std::size_t points = table.points(), pairs = table.pairs();
  measure(state, [&] { table = quadrature.build(cloud, Rkpm<3>{}); },
          {{"ns_per_point", points}, {"ns_per_pair", pairs}});
  state.counters["pairs_per_point"] = static_cast<double>(pairs) / static_cast<double>(points);
}

void cell_nodal_centroids(benchmark::State& state) {
  build(state, SpreadingParameters{}.cell_cloud<3>(), NodalCentroids{});
}
void cell_without_correction(benchmark::State& state) {
  build(state, SpreadingParameters{}.cell_cloud<3>(), NodalCentroids{.consistency_tolerance = 0.0});
}
void cell_gauss_cells(benchmark::State& state) { build(state, SpreadingParameters{}.cell_cloud<3>(), GaussCells<2>{}); }
void substrate_nodal_centroids(benchmark::State& state) {
  build(state, SpreadingParameters{}.substrate_cloud<3>(), NodalCentroids{});
}
void substrate_without_correction(benchmark::State& state) {
  build(state, SpreadingParameters{}.substrate_cloud<3>(), NodalCentroids{.consistency_tolerance = 0.0});
}

BENCHMARK(cell_nodal_centroids)->Unit(benchmark::kMillisecond);
BENCHMARK(cell_without_correction)->Unit(benchmark::kMillisecond);
BENCHMARK(cell_gauss_cells)->Unit(benchmark::kMillisecond);
BENCHMARK(substrate_nodal_centroids)->Unit(benchmark::kMillisecond);
BENCHMARK(substrate_without_correction)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
