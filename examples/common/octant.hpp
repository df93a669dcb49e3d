#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <tactoid/geometry/facets.hpp>

namespace tactoid {

/// The part x, y, z >= 0 of a cloud whose cells do not cross the planes x = 0, y = 0, z = 0: an eighth of a body with
/// these planes of symmetry, whose cut planes must be held, and are no surface (OnFacets). `size`: of the body, m.
[[nodiscard]] inline PointCloud<3> octant(const PointCloud<3>& cloud, double size) {
  const double tolerance = 1e-9 * size;
  PointCloud<3> part;
  part.regions = cloud.regions;
  std::vector<Index> number(cloud.size());
  std::vector<bool> inside(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    Point<3> X = cloud.positions[i];
    inside[i] = X.minCoeff() > -tolerance;
    if (!inside[i]) continue;
    for (int k = 0; k < 3; ++k)
      if (std::abs(X[k]) < tolerance) X[k] = 0.0;
    number[i] = static_cast<Index>(part.size());
    part.positions.push_back(X);
  }
  for (std::size_t c = 0; c < cloud.cells.size(); ++c) {
    const auto& cell = cloud.cells[c];
    if (!std::all_of(cell.begin(), cell.end(), [&](Index i) { return inside[i]; })) continue;
    PointCloud<3>::Cell renumbered;
    std::transform(cell.begin(), cell.end(), renumbered.begin(), [&](Index i) { return number[i]; });
    part.cells.push_back(renumbered);
    part.cell_regions.push_back(cloud.cell_regions[c]);
  }
  part.facets = extract_facets(part);
  return part;
}

}  // namespace tactoid
