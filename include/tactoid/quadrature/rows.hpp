#pragma once

#include <algorithm>
#include <cmath>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/neighbors/neighbor_table.hpp>
#include <tactoid/quadrature/point_table.hpp>

namespace tactoid {

/// Throws GeometryError when a moment matrix cannot be trusted; the order is never lowered silently.
inline void check_condition(std::size_t point, const Vector3& position, std::size_t neighbors, double condition,
                            double limit) {
  if (condition <= limit) return;
  throw GeometryError(
      fmt::format("Quadrature point {} at ({:.6g}, {:.6g}, {:.6g}) m has {} particles in reach and a moment matrix of condition "
                  "number {:.3g} (allowed: {:.3g}): enlarge the support of the kernel, or mend the cloud there.",
                  point, position[0], position[1], position[2], neighbors, condition, limit));
}

/// A table that knows its particles and has no points yet.
template <int D>
[[nodiscard]] PointTable empty_table(const PointCloud<D>& cloud) {
  PointTable table;
  table.particles = cloud.size();
  table.dimension = D;
  table.axisymmetric = cloud.axisymmetric;
  table.period.setZero();
  table.period.head(D) = cloud.period;
  table.particle_position.reserve(cloud.size());
  for (const Point<D>& X : cloud.positions) table.particle_position.push_back(pad(X));
  return table;
}

/// Entries for the given neighbours, each row padded to an even length by its first particle with zero gradient:
/// the hot loop takes two pairs at a time.
inline void lay_out_rows(PointTable& table, const NeighborTable& neighbors) {
  const std::size_t points = neighbors.offsets.size() - 1;
  table.offsets.assign(1, 0);
  table.offsets.reserve(points + 1);
  for (std::size_t q = 0; q < points; ++q)
    table.offsets.push_back(table.offsets.back() + (neighbors.row(q).size() + 1) / 2 * 2);
  table.entries.assign(table.offsets.back(), TableEntry{});
  for (std::size_t q = 0; q < points; ++q) {
    const auto row = neighbors.row(q);
    for (std::size_t e = table.offsets[q]; e < table.offsets[q + 1]; ++e) {
      const std::size_t k = e - table.offsets[q];
      if (!row.empty()) table.entries[e].particle = row[k < row.size() ? k : 0];
    }
  }
}

/// The padding at the end of a row repeats its first particle.
[[nodiscard]] inline bool is_padding(const PointTable& table, std::size_t q, std::size_t e) {
  const std::size_t first = table.offsets[q];
  return e > first && e + 1 == table.offsets[q + 1] && table.entries[e].particle == table.entries[first].particle;
}

}  // namespace tactoid
