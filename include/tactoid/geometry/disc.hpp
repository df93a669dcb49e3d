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
  void validate_as(const std::string& type) const;  ///< the same, with another name in the message
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
  void validate() const;
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
[[nodiscard]] double outward_share(const Circle& circle, int k);

[[nodiscard]] PointCloud<2> circle_cells(const Circle& circle);

}  // namespace detail

/// Particles of a circle: (core_cells + 1)² + 4 core_cells rings. Throws ParameterError.
[[nodiscard]] PointCloud<2> circle(const Circle& parameters);

/// Particles of a disc: `layers` times those of a circle; 16640 with the default counts. Throws ParameterError.
[[nodiscard]] PointCloud<3> disc(const Disc& parameters);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/disc.ipp>
#endif
