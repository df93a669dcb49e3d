#pragma once

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

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template PointTable empty_table<1>(const PointCloud<1>& cloud);
template PointTable empty_table<2>(const PointCloud<2>& cloud);
template PointTable empty_table<3>(const PointCloud<3>& cloud);
}  // namespace tactoid
#endif
