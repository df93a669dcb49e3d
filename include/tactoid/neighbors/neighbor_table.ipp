#pragma once

#include <limits>

#include <tactoid/core/compiled.hpp>
#include <tactoid/neighbors/neighbor_table.hpp>
#include <tactoid/neighbors/neighbor_search.hpp>

namespace tactoid {

template <int D>
NeighborTable neighbor_table(const PointCloud<D>& cloud, const std::vector<Point<D>>& queries,
                             const std::vector<double>& supports) {
  if (supports.size() != cloud.size())
    throw ParameterError(
        fmt::format("neighbor_table: there are {} supports for {} particles.", supports.size(), cloud.size()));
  for (std::size_t i = 0; i < supports.size(); ++i)
    require_positive("neighbor_table.supports", supports[i], "m");
  // Supports belong to the particles, so each particle looks for query points; then the relation is transposed. With
  // the particles in ascending order every row comes out sorted.
  const NeighborSearch<D> search(queries, cloud.period);
  // Where the queries lie: most particles are far from those of a part of a body.
  Point<D> low = Point<D>::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Point<D>& X : queries) low = low.cwiseMin(X), high = high.cwiseMax(X);
  const auto is_far = [&](std::size_t i) {
    const double reach = supports[i] * (1.0 + 1e-9);
    for (int k = 0; k < D; ++k)
      if (!(cloud.period[k] > 0.0) && (cloud.positions[i][k] < low[k] - reach || cloud.positions[i][k] > high[k] + reach)) return true;
    return false;
  };
  std::vector<std::vector<Index>> covered(cloud.size());
  parallel_for(cloud.size(), [&](std::size_t i) {
    if (is_far(i)) return;
    std::vector<Index> found;
    search.within(cloud.positions[i], supports[i], found);
    covered[i].assign(found.begin(), found.end());
  });
  NeighborTable table;
  table.offsets.assign(queries.size() + 1, 0);
  for (const auto& points : covered)
    for (const Index q : points) ++table.offsets[q + 1];
  for (std::size_t q = 0; q < queries.size(); ++q) table.offsets[q + 1] += table.offsets[q];
  table.indices.resize(table.offsets.back());
  std::vector<std::size_t> next(table.offsets.begin(), table.offsets.end() - 1);
  for (std::size_t i = 0; i < covered.size(); ++i)
    for (const Index q : covered[i]) table.indices[next[q]++] = static_cast<Index>(i);
  return table;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template NeighborTable neighbor_table<1>(const PointCloud<1>& cloud, const std::vector<Point<1>>& queries,
                                         const std::vector<double>& supports);
template NeighborTable neighbor_table<2>(const PointCloud<2>& cloud, const std::vector<Point<2>>& queries,
                                         const std::vector<double>& supports);
template NeighborTable neighbor_table<3>(const PointCloud<3>& cloud, const std::vector<Point<3>>& queries,
                                         const std::vector<double>& supports);
}  // namespace tactoid
#endif
