#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/geometry/meridian.hpp>

namespace tactoid {

TACTOID_INLINE PointCloud<2> meridian(const Ball& parameters) {
  parameters.validate();
  if (parameters.center[0] != 0.0 || parameters.center[1] != 0.0)
    throw ParameterError("meridian: Ball.center must be on the axis, x = y = 0.");
  if (parameters.core_cells % 2 != 0) reject("meridian: Ball.core_cells", parameters.core_cells, "", "even");
  PointCloud<2> cloud = detail::ball_cells<2>(parameters, {0.0, parameters.center[2]});
  cloud.axisymmetric = true;
  return morton_ordered(part_where(cloud, [](const Point<2>& X) { return X[0] >= 0.0; }));
}

TACTOID_INLINE PointCloud<2> meridian(const Disc& parameters) {
  parameters.validate();
  if (parameters.origin[0] != 0.0 || parameters.origin[1] != 0.0)
    throw ParameterError("meridian: Disc.origin must be on the axis, x = y = 0.");
  const int in_core = (parameters.core_cells + 1) / 2, radial = in_core + parameters.rings, axial = parameters.layers - 1;
  PointCloud<2> cloud = rectangle({.size = {static_cast<double>(radial), parameters.height},
                                   .cells = {radial, axial},
                                   .origin = {0.0, parameters.origin[2] - parameters.height},
                                   .region = parameters.region});
  const double core = detail::core_half_width(parameters.circle());
  std::vector<double> radius(static_cast<std::size_t>(radial) + 1);
  for (int k = 0; k <= radial; ++k)
    radius[static_cast<std::size_t>(k)] =
        k <= in_core ? core * k / in_core
                     : core + (parameters.radius - core) * detail::outward_share(parameters.circle(), k - in_core);
  for (Point<2>& X : cloud.positions) X[0] = radius[static_cast<std::size_t>(std::lround(X[0]))];
  cloud.axisymmetric = true;
  return cloud;
}

}  // namespace tactoid
