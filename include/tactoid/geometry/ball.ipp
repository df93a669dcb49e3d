#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/geometry/ball.hpp>

namespace tactoid {

TACTOID_INLINE void Ball::validate() const {
  require_positive("Ball.radius", radius, "m");
  if (core_cells < 2) reject("Ball.core_cells", core_cells, "", "at least 2");
  if (shells < 0) reject("Ball.shells", shells, "", "zero or positive");
  if (shells > 0 && !(core_radius > 0.0 && core_radius < radius))
    reject("Ball.core_radius", core_radius, "m",
           fmt::format("positive and below Ball.radius = {:g} m (the nucleus must fit into the cell)", radius));
  if (!(shell_grading >= 0.0 && shell_grading < 1.0)) reject("Ball.shell_grading", shell_grading, "", "in [0, 1)");
  for (int k = 0; k < 3; ++k) require_finite("Ball.center", center[k], "m");
}

}  // namespace tactoid

namespace tactoid::detail {

template <int D>
PointCloud<D> ball_cells(const Ball& parameters, const Point<D>& center) {
  const double core_radius = parameters.shells > 0 ? parameters.core_radius : parameters.radius;
  const auto core = [&](const CubePoint<D>& point) -> Point<D> {
    // A cube of half-edge `cube` R at the centre turns into the sphere at the surface. The two constants are a
    // compromise of the smallest corner Jacobian and the shortest edge, both relative to the largest.
    constexpr double cube = 0.85;
    const double rounded = std::pow(point.s, 1.5);
    return center + core_radius * point.s * ((1.0 - rounded) * cube * point.d + rounded * equiangular_direction<D>(point.d));
  };
  const auto shell = [&](int k, const Point<D>& d) -> Point<D> {
    const double fraction = static_cast<double>(k) / parameters.shells;
    const double graded = fraction * (1.0 + parameters.shell_grading * (1.0 - fraction));
    const double r = k == parameters.shells ? parameters.radius : core_radius + graded * (parameters.radius - core_radius);
    return center + r * equiangular_direction<D>(d);
  };
  PointCloud<D> cloud = o_grid<D>(parameters.core_cells, parameters.shells, core, shell);
  if (parameters.shells == 0 || parameters.core_region == parameters.shell_region) {
    cloud.cell_regions.assign(cloud.cells.size(), 0);
    cloud.regions = {parameters.core_region};
  } else {
    cloud.regions = {parameters.core_region, parameters.shell_region};
  }
  return cloud;
}

}  // namespace tactoid::detail

namespace tactoid {

TACTOID_INLINE PointCloud<3> ball(const Ball& parameters) {
  parameters.validate();
  PointCloud<3> cloud = detail::ball_cells<3>(parameters, parameters.center);
  cloud.facets = extract_facets(cloud);
  return morton_ordered(cloud);
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template PointCloud<1> ball_cells<1>(const Ball& parameters, const Point<1>& center);
template PointCloud<2> ball_cells<2>(const Ball& parameters, const Point<2>& center);
template PointCloud<3> ball_cells<3>(const Ball& parameters, const Point<3>& center);
}  // namespace tactoid::detail
#endif
