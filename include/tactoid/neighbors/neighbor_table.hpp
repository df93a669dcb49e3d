#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/neighbors/neighbor_search.hpp>

namespace tactoid {

/// For every query point the particles whose support covers it, in one flat array.
struct NeighborTable {
  std::vector<std::size_t> offsets = {0};  ///< row q is indices[offsets[q]] … indices[offsets[q + 1] − 1]
  std::vector<Index> indices;              ///< particles, sorted in each row

  [[nodiscard]] std::size_t rows() const { return offsets.size() - 1; }  ///< number of query points
  /// The particles whose support covers query point q, ascending.
  [[nodiscard]] std::span<const Index> row(std::size_t q) const {
    return {indices.data() + offsets[q], offsets[q + 1] - offsets[q]};
  }
};

/// All pairs (query point X, particle I) with |X_I − X| < a_I; in periodic directions by the shortest way around.
/// `supports` holds the radius a_I of each particle, m, > 0. Throws ParameterError for a wrong number of supports, and
/// for a support that is not positive or exceeds half a period.
template <int D>
[[nodiscard]] NeighborTable neighbor_table(const PointCloud<D>& cloud, const std::vector<Point<D>>& queries,
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
