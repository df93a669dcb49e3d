#pragma once

#include <cmath>
#include <string>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/facets.hpp>
#include <tactoid/geometry/o_grid.hpp>
#include <tactoid/geometry/order.hpp>

namespace tactoid {

/// A circle: a core square with partly rounded sides and rings of cells around it. The nodes of the outermost ring
/// lie on the circle.
struct Circle {
  double radius = 0.0;                   ///< m, > 0
  int core_cells = 21;                   ///< cells along a side of the core square, >= 1
  int rings = 19;                        ///< rings of 4 core_cells cells around it, >= 1
  double growth = 1.0;                   ///< width of a ring over that of the one inside, in [0.5, 2]
  double core_roundness = 0.5;           ///< 0: the core is a square, towards 1: a circle; in [0, 0.9]
  Point<2> center = Point<2>::Zero();    ///< m
  std::string region = "body";           ///< name of the region
  void validate() const { validate_as("Circle"); }  ///< throws ParameterError for a value that is not in its range
  void validate_as(const std::string& type) const {  ///< the same, with another name in the message
    require_positive(type + ".radius", radius, "m");
    if (core_cells < 1) reject(type + ".core_cells", core_cells, "", "at least 1");
    if (rings < 1) reject(type + ".rings", rings, "", "at least 1");
    if (!(growth >= 0.5 && growth <= 2.0)) reject(type + ".growth", growth, "", "in [0.5, 2]");
    if (!(core_roundness >= 0.0 && core_roundness <= 0.9))
      reject(type + ".core_roundness", core_roundness, "", "in [0, 0.9]");
    for (int k = 0; k < 2; ++k) require_finite(type + ".center", center[k], "m");
  }
};

/// A disc: a circle in layers. Its axis is z, its top face has the z of `origin`, and it goes down from there.
struct Disc {
  double radius = 0.0;                   ///< m, > 0
  double height = 0.0;                   ///< m, > 0
  int core_cells = 21;                   ///< cells along a side of the core square, >= 1
  int rings = 19;                        ///< rings of 4 core_cells cells around it, >= 1
  int layers = 8;                        ///< layers of particles, >= 2
  double growth = 1.0;                   ///< width of a ring over that of the one inside, in [0.5, 2]
  double core_roundness = 0.5;           ///< 0: the core is a square, towards 1: a circle; in [0, 0.9]
  Point<3> origin = Point<3>::Zero();    ///< centre of the top face, m
  std::string region = "body";           ///< name of the region
  [[nodiscard]] Circle circle() const {  ///< one layer of it
    return {radius, core_cells, rings, growth, core_roundness, origin.head<2>(), region};
  }
  /// Throws ParameterError for a value that is not in its range.
  void validate() const {
    circle().validate_as("Disc");
    require_positive("Disc.height", height, "m");
    if (layers < 2) reject("Disc.layers", layers, "", "at least 2");
    require_finite("Disc.origin", origin[2], "m");
  }
};

namespace detail {

/// Widths of the first `count` rings over that of the first one.
[[nodiscard]] inline double ring_widths(const Circle& circle, int count) {
  double widths = 0.0;
  for (int k = 0; k < count; ++k) widths += std::pow(circle.growth, k);
  return widths;
}

/// Half-width c of the core such that the first ring is as wide as a core cell, 2 c / n:
/// R = c + (2 c / n) (1 + g + … + g^(rings − 1)).
[[nodiscard]] inline double core_half_width(const Circle& circle) {
  return circle.radius / (1.0 + 2.0 * ring_widths(circle, circle.rings) / circle.core_cells);
}

/// Where ring k ends between the core (0) and the outermost circle (1).
[[nodiscard]] inline double outward_share(const Circle& circle, int k) {
  if (k == circle.rings) return 1.0;
  const double all = ring_widths(circle, circle.rings);
  double outward = 0.0;
  for (int j = 0; j < k; ++j) outward += std::pow(circle.growth, j) / all;
  return outward;
}

[[nodiscard]] inline PointCloud<2> circle_cells(const Circle& circle) {
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

}  // namespace detail

/// Particles of a circle: (core_cells + 1)² + 4 core_cells rings. Throws ParameterError.
[[nodiscard]] inline PointCloud<2> circle(const Circle& parameters) {
  parameters.validate();
  PointCloud<2> cloud = detail::circle_cells(parameters);
  cloud.facets = extract_facets(cloud);
  return morton_ordered(cloud);
}

/// Particles of a disc: `layers` times those of a circle; 16640 with the default counts. Throws ParameterError.
[[nodiscard]] inline PointCloud<3> disc(const Disc& parameters) {
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
