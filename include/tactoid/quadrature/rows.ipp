#pragma once

#include <numeric>

#include <tactoid/core/compiled.hpp>
#include <tactoid/quadrature/rows.hpp>

namespace tactoid {

TACTOID_INLINE void check_condition(std::size_t point, const Vector3& position, std::size_t neighbors,
                                    double condition, double limit) {
  if (condition <= limit) return;
  throw GeometryError(
      fmt::format("Quadrature point {} at ({:.6g}, {:.6g}, {:.6g}) m has {} particles in reach and a moment matrix of condition "
                  "number {:.3g} (allowed: {:.3g}): enlarge the support of the kernel, or mend the cloud there.",
                  point, position[0], position[1], position[2], neighbors, condition, limit));
}

template <int D>
PointTable empty_table(const PointCloud<D>& cloud) {
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

TACTOID_INLINE void lay_out_rows(PointTable& table, const NeighborTable& neighbors) {
  std::vector<Index> points(neighbors.rows());
  std::iota(points.begin(), points.end(), Index{0});
  lay_out_rows(table, neighbors, points, points.size());
}

TACTOID_INLINE void lay_out_rows(PointTable& table, const NeighborTable& neighbors, std::span<const Index> points, std::size_t count) {
  table.offsets.assign(count + 1, 0);
  for (std::size_t k = 0; k < points.size(); ++k) table.offsets[points[k] + 1] = padded_row(neighbors.row(k).size());
  std::partial_sum(table.offsets.begin(), table.offsets.end(), table.offsets.begin());
  table.entries.assign(table.offsets.back(), TableEntry{});
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto row = neighbors.row(k);
    for (std::size_t e = table.offsets[points[k]], i = 0; e < table.offsets[points[k] + 1]; ++e, ++i)
      if (!row.empty()) table.entries[e].particle = row[i < row.size() ? i : 0];
  }
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template PointTable empty_table<1>(const PointCloud<1>& cloud);
template PointTable empty_table<2>(const PointCloud<2>& cloud);
template PointTable empty_table<3>(const PointCloud<3>& cloud);
}  // namespace tactoid
#endif
