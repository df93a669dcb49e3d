#pragma once

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
  std::vector<std::vector<Index>> covered(cloud.size());
  parallel_for(cloud.size(), [&](std::size_t i) {
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
