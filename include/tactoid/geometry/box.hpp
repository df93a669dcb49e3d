#pragma once

#include <array>
#include <string>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/facets.hpp>
#include <tactoid/geometry/order.hpp>

namespace tactoid {

/// A line of equal cells.
struct Bar {
  double length = 0.0;          ///< m, > 0
  int cells = 0;                ///< number of cells, >= 1 (>= 3 if periodic)
  bool periodic = false;        ///< the far end is the near end
  double origin = 0.0;          ///< coordinate of the near end, m
  std::string region = "body";  ///< name of the region
  void validate() const;        ///< throws ParameterError for a value that is not in its range
};

/// A rectangle of equal cells.
struct Rectangle {
  Point<2> size = Point<2>::Zero();                ///< edge lengths, m, > 0
  std::array<int, 2> cells = {0, 0};               ///< cells per direction, >= 1 (>= 3 where periodic)
  std::array<bool, 2> periodic = {false, false};   ///< far sides are near sides
  Point<2> origin = Point<2>::Zero();              ///< corner with the least coordinates, m
  std::string region = "body";                     ///< name of the region
  void validate() const;                           ///< throws ParameterError for a value that is not in its range
};

/// A box of equal cells.
struct Box {
  Point<3> size = Point<3>::Zero();                       ///< edge lengths, m, > 0
  std::array<int, 3> cells = {0, 0, 0};                   ///< cells per direction, >= 1 (>= 3 where periodic)
  std::array<bool, 3> periodic = {false, false, false};   ///< far sides are near sides
  Point<3> origin = Point<3>::Zero();                     ///< corner with the least coordinates, m
  std::string region = "body";                            ///< name of the region
  void validate() const;                                  ///< throws ParameterError for a value that is not in its range
};

namespace detail {

void validate_brick(const char* name, const char* length, int direction, double size, int cells, bool periodic,
                    double origin);

template <int D>
[[nodiscard]] PointCloud<D> brick(const Point<D>& size, const std::array<int, static_cast<std::size_t>(D)>& cells,
                                  const std::array<bool, static_cast<std::size_t>(D)>& periodic,
                                  const Point<D>& origin, const std::string& region);

template <int D>
[[nodiscard]] PointCloud<D> brick_part(const Point<D>& size, const std::array<int, static_cast<std::size_t>(D)>& cells,
                                       const std::array<bool, static_cast<std::size_t>(D)>& periodic, const Point<D>& origin,
                                       const std::string& region, const Part& part);

}  // namespace detail

/// Particles on a line, `cells + 1` of them (`cells` if periodic). Throws ParameterError.
[[nodiscard]] inline PointCloud<1> bar(const Bar& parameters) {
  parameters.validate();
  return detail::brick<1>(Point<1>(parameters.length), {parameters.cells}, {parameters.periodic},
                          Point<1>(parameters.origin), parameters.region);
}

/// Particles on a regular grid. Throws ParameterError.
[[nodiscard]] inline PointCloud<2> rectangle(const Rectangle& parameters) {
  parameters.validate();
  return detail::brick<2>(parameters.size, parameters.cells, parameters.periodic, parameters.origin, parameters.region);
}

/// Particles on a regular grid. Throws ParameterError.
[[nodiscard]] inline PointCloud<3> box(const Box& parameters) {
  parameters.validate();
  return detail::brick<3>(parameters.size, parameters.cells, parameters.periodic, parameters.origin, parameters.region);
}

/// One rank's part of rectangle(parameters), made without the rest: time and memory are those of the part. The grid is divided into bricks of nearly as many particles each. In the whole,
/// particles are numbered row by row, the first direction fastest. Throws ParameterError, also where the grid cannot be divided so often.
[[nodiscard]] inline PointCloud<2> rectangle_part(const Rectangle& parameters, const Part& part) {
  parameters.validate();
  return detail::brick_part<2>(parameters.size, parameters.cells, parameters.periodic, parameters.origin, parameters.region, part);
}

/// One rank's part of box(parameters); as above.
[[nodiscard]] inline PointCloud<3> box_part(const Box& parameters, const Part& part) {
  parameters.validate();
  return detail::brick_part<3>(parameters.size, parameters.cells, parameters.periodic, parameters.origin, parameters.region, part);
}

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/box.ipp>
#endif
