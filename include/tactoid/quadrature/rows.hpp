#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/neighbors/neighbor_table.hpp>
#include <tactoid/quadrature/point_table.hpp>

namespace tactoid {

/// Throws GeometryError when a moment matrix cannot be trusted; the order is never lowered silently.
void check_condition(std::size_t point, const Vector3& position, std::size_t neighbors, double condition,
                     double limit);

/// A table that knows its particles and has no points yet.
template <int D>
[[nodiscard]] PointTable empty_table(const PointCloud<D>& cloud);

/// Entries of a row with so many particles: the hot loop takes two pairs at a time.
[[nodiscard]] inline std::size_t padded_row(std::size_t particles) { return (particles + 1) / 2 * 2; }

/// Entries for the given neighbours, each row padded to an even length by its first particle with zero gradient.
void lay_out_rows(PointTable& table, const NeighborTable& neighbors);

/// The same where row k of the neighbours belongs to point points[k], ascending, of `count` ones: the rows of the others are empty.
void lay_out_rows(PointTable& table, const NeighborTable& neighbors, std::span<const Index> points, std::size_t count);

/// The padding at the end of a row repeats its first particle.
[[nodiscard]] inline bool is_padding(const PointTable& table, std::size_t q, std::size_t e) {
  const std::size_t first = table.offsets[q];
  return e > first && e + 1 == table.offsets[q + 1] && table.entries[e].particle == table.entries[first].particle;
}

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/quadrature/rows.ipp>
#endif
