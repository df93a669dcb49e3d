#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/geometry/point_cloud.hpp>

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
                                           const std::vector<double>& supports);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/neighbors/neighbor_table.ipp>
#endif
