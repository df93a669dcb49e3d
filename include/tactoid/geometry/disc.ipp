#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/geometry/disc.hpp>

namespace tactoid {

TACTOID_INLINE void Circle::validate_as(const std::string& type) const {
  require_positive(type + ".radius", radius, "m");
  if (core_cells < 1) reject(type + ".core_cells", core_cells, "", "at least 1");
  if (rings < 1) reject(type + ".rings", rings, "", "at least 1");
  if (!(growth >= 0.5 && growth <= 2.0)) reject(type + ".growth", growth, "", "in [0.5, 2]");
  if (!(core_roundness >= 0.0 && core_roundness <= 0.9))
    reject(type + ".core_roundness", core_roundness, "", "in [0, 0.9]");
  for (int k = 0; k < 2; ++k) require_finite(type + ".center", center[k], "m");
}

TACTOID_INLINE void Disc::validate() const {
  circle().validate_as("Disc");
  require_positive("Disc.height", height, "m");
  if (layers < 2) reject("Disc.layers", layers, "", "at least 2");
  require_finite("Disc.origin", origin[2], "m");
}

}  // namespace tactoid

namespace tactoid::detail {

TACTOID_INLINE double outward_share(const Circle& circle, int k) {
  if (k == circle.rings) return 1.0;
  const double all = ring_widths(circle, circle.rings);
  double outward = 0.0;
  for (int j = 0; j < k; ++j) outward += std::pow(circle.growth, j) / all;
  return outward;
}

TACTOID_INLINE PointCloud<2> circle_cells(const Circle& circle) {
  const double half_width = core_half_width(circle);
  const auto core = [&](const CubePoint<2>& point) -> Point<2> {
    const double rounded = circle.core_roundness * point.s * point.s;
    return circle.center + half_width * point.s *
                               ((1.0 - rounded) * point.d + rounded * equiangular_direction<2>(point.d));
  };
  const auto shell = [&](int k, const Point<2>& d) -> Point<2> {
    const double outward = outward_share(circle, k);
    return circle.center + (1.0 - outward) * (core({1.0, d}) - circle.center) +
           outward * circle.radius * equiangular_direction<2>(d);
  };
  PointCloud<2> cloud = o_grid<2>(circle.core_cells, circle.rings, core, shell);
  cloud.cell_regions.assign(cloud.cells.size(), 0);
  cloud.regions = {circle.region};
  return cloud;
}

}  // namespace tactoid::detail

namespace tactoid {

TACTOID_INLINE PointCloud<2> circle(const Circle& parameters) {
  parameters.validate();
  PointCloud<2> cloud = detail::circle_cells(parameters);
  cloud.facets = extract_facets(cloud);
  return morton_ordered(cloud);
}

TACTOID_INLINE PointCloud<3> disc(const Disc& parameters) {
  parameters.validate();
  const PointCloud<2> flat = detail::circle_cells(parameters.circle());
  PointCloud<3> cloud;
  cloud.regions = flat.regions;
  const int gaps = parameters.layers - 1;
  for (int k = 0; k <= gaps; ++k) {
    const double z = parameters.origin[2] - parameters.height * (gaps - k) / gaps;
    for (const Point<2>& p : flat.positions) cloud.positions.push_back({p[0], p[1], z});
  }
  for (int k = 0; k < gaps; ++k) {
    for (const auto& quad : flat.cells) {
      PointCloud<3>::Cell cell;
      for (std::size_t a = 0; a < cell.size(); ++a)
        cell[a] = static_cast<Index>(quad[a % 4] + flat.size() * (static_cast<std::size_t>(k) + a / 4));
      cloud.cells.push_back(cell);
    }
  }
  cloud.cell_regions.assign(cloud.cells.size(), 0);
  cloud.facets = extract_facets(cloud);
  return morton_ordered(cloud);
}

}  // namespace tactoid
