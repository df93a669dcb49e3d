// Set-up of a body, first half: who is near whom, shape functions and value-based gradients at every particle of the
// paper's cell (4341 particles).
#include <vector>

#include "report.hpp"
#include <common/spreading_parameters.hpp>

namespace {

using namespace tactoid;

/// The cell, and for every particle its neighbours as a kernel takes them.
struct Rows {
  PointCloud<3> cloud = SpreadingParameters{}.cell_cloud<3>();
  std::vector<double> supports, volumes = nodal_volumes(cloud);
  NeighborTable table;
  std::vector<KernelNeighbor<3>> near;

  explicit Rows(double support) : supports(support_radii(Rkpm<3>{.support = support}, cloud)) {
    table = neighbor_table(cloud, cloud.positions, supports);
    for (std::size_t q = 0; q < table.rows(); ++q)
      for (const Index i : table.row(q))
        near.push_back({cloud.difference(cloud.positions[q], cloud.positions[i]), supports[i], volumes[i]});
  }
  [[nodiscard]] std::span<const KernelNeighbor<3>> row(std::size_t q) const {
    return std::span(near).subspan(table.offsets[q], table.offsets[q + 1] - table.offsets[q]);
  }
};

void neighbor_search(benchmark::State& state) {
  set_thread_count(1);
  const Rows rows(1.75);
  measure(state, [&] { benchmark::DoNotOptimize(neighbor_table(rows.cloud, rows.cloud.positions, rows.supports)); },
          {{"ns_per_point", rows.table.rows()}, {"ns_per_pair", rows.near.size()}});
}

template <class Kernel>
void shape_functions(benchmark::State& state) {
  set_thread_count(1);
  const Kernel kernel;
  const Rows rows(kernel.support);
  ShapeFunctions<3> shape;
  measure(state,
          [&] {
            for (std::size_t q = 0; q < rows.table.rows(); ++q) {
              kernel.shape_functions(rows.row(q), shape);
              benchmark::DoNotOptimize(shape.gradient.data());
            }
          },
          {{"ns_per_point", rows.table.rows()}, {"ns_per_pair", rows.near.size()}});
}

template <class Kernel>
void direct_gradient(benchmark::State& state) {
  set_thread_count(1);
  const Kernel kernel;
  const Rows rows(kernel.support);
  std::vector<Point<3>> gradient;
  measure(state,
          [&] {
            for (std::size_t q = 0; q < rows.table.rows(); ++q) {
              benchmark::DoNotOptimize(kernel.direct_gradient(rows.row(q), gradient));
              benchmark::DoNotOptimize(gradient.data());
            }
          },
          {{"ns_per_point", rows.table.rows()}, {"ns_per_pair", rows.near.size()}});
}

BENCHMARK(neighbor_search)->Unit(benchmark::kMillisecond);
BENCHMARK(shape_functions<Rkpm<3>>)->Unit(benchmark::kMillisecond);
BENCHMARK(shape_functions<Mls<3>>)->Unit(benchmark::kMillisecond);
BENCHMARK(shape_functions<Rkpm<3, 2>>)->Unit(benchmark::kMillisecond);
BENCHMARK(direct_gradient<Rkpm<3>>)->Unit(benchmark::kMillisecond);
BENCHMARK(direct_gradient<Mls<3>>)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
