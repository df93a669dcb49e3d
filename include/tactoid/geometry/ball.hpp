#pragma once

#include <cmath>
#include <string>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/facets.hpp>
#include <tactoid/geometry/o_grid.hpp>
#include <tactoid/geometry/order.hpp>

namespace tactoid {

/// A ball with a concentric core (a cell with its nucleus): a cube of cells rounded to the core's sphere, and shells
/// of cells around it. Nodes lie exactly on both spheres, so the interface of the two regions runs through particles.
/// Shells are of about equal width: where they widen outward as the spacing along the sphere does, the lowest modes of a
/// ball with a small core are much too slow (l = 2 of the default counts, core of 0.382 R: 2.6 % against 0.9 %).
struct Ball {
  double radius = 0.0;                       ///< R, m, > 0
  double core_radius = 0.0;                  ///< radius of the core (nucleus), m, in (0, radius); unused if shells = 0
  int core_cells = 10;                       ///< cells along an edge of the core, >= 2
  int shells = 5;                            ///< layers of cells around the core; 0: the core is the whole ball
  double shell_grading = 0.15;               ///< g in [0, 1): widths fall from about 1 + g of the mean inside to 1 − g outside
  Point<3> center = Point<3>::Zero();        ///< m
  std::string core_region = "nucleus";       ///< name of the region of the core
  std::string shell_region = "cytoplasm";    ///< name of the region of the shells; may be that of the core
  /// Throws ParameterError for a value that is not in its range.
  void validate() const {
    require_positive("Ball.radius", radius, "m");
    if (core_cells < 2) reject("Ball.core_cells", core_cells, "", "at least 2");
    if (shells < 0) reject("Ball.shells", shells, "", "zero or positive");
    if (shells > 0 && !(core_radius > 0.0 && core_radius < radius))
      reject("Ball.core_radius", core_radius, "m",
             fmt::format("positive and below Ball.radius = {:g} m (the nucleus must fit into the cell)", radius));
    if (!(shell_grading >= 0.0 && shell_grading < 1.0)) reject("Ball.shell_grading", shell_grading, "", "in [0, 1)");
    for (int k = 0; k < 3; ++k) require_finite("Ball.center", center[k], "m");
  }
};

namespace detail {

/// Particles, cells and regions of a ball (D = 3) or of the circle in which a plane through its centre cuts it.
template <int D>
[[nodiscard]] PointCloud<D> ball_cells(const Ball& parameters, const Point<D>& center) {
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

}  // namespace detail

/// Particles of a ball: (n + 1)³ + shells ((n + 1)³ − (n − 1)³) with n core cells; 4341 with the default counts.
/// Throws ParameterError.
[[nodiscard]] inline PointCloud<3> ball(const Ball& parameters) {
  parameters.validate();
  PointCloud<3> cloud = detail::ball_cells<3>(parameters, parameters.center);
  cloud.facets = extract_facets(cloud);
  return morton_ordered(cloud);
}

}  // namespace tactoid
