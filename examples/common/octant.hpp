#pragma once

#include <cmath>

#include <tactoid/geometry/part.hpp>

namespace tactoid {

/// The part x, y, z >= 0 of a cloud whose cells do not cross the planes x = 0, y = 0, z = 0: an eighth of a body with
/// these planes of symmetry, whose cut planes must be held, and are no surface (OnFacets). `size`: of the body, m.
[[nodiscard]] inline PointCloud<3> octant(PointCloud<3> cloud, double size) {
  for (Point<3>& X : cloud.positions)
    for (int k = 0; k < 3; ++k)
      if (std::abs(X[k]) < 1e-9 * size) X[k] = 0.0;
  return part_where(cloud, [](const Point<3>& X) { return X.minCoeff() >= 0.0; });
}

}  // namespace tactoid
