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
  void validate() const;
};

namespace detail {

/// Particles, cells and regions of a ball (D = 3) or of the circle in which a plane through its centre cuts it.
template <int D>
[[nodiscard]] PointCloud<D> ball_cells(const Ball& parameters, const Point<D>& center);

}  // namespace detail

/// Particles of a ball: (n + 1)³ + shells ((n + 1)³ − (n − 1)³) with n core cells; 4341 with the default counts.
/// Throws ParameterError.
[[nodiscard]] PointCloud<3> ball(const Ball& parameters);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/ball.ipp>
#endif
