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
  inline void validate() const;  ///< throws ParameterError for a value that is not in its range
};

/// A rectangle of equal cells.
struct Rectangle {
  Point<2> size = Point<2>::Zero();                ///< edge lengths, m, > 0
  std::array<int, 2> cells = {0, 0};               ///< cells per direction, >= 1 (>= 3 where periodic)
  std::array<bool, 2> periodic = {false, false};   ///< far sides are near sides
  Point<2> origin = Point<2>::Zero();              ///< corner with the least coordinates, m
  std::string region = "body";                     ///< name of the region
  inline void validate() const;                    ///< throws ParameterError for a value that is not in its range
};

/// A box of equal cells.
struct Box {
  Point<3> size = Point<3>::Zero();                       ///< edge lengths, m, > 0
  std::array<int, 3> cells = {0, 0, 0};                   ///< cells per direction, >= 1 (>= 3 where periodic)
  std::array<bool, 3> periodic = {false, false, false};   ///< far sides are near sides
  Point<3> origin = Point<3>::Zero();                     ///< corner with the least coordinates, m
  std::string region = "body";                            ///< name of the region
  inline void validate() const;                           ///< throws ParameterError for a value that is not in its range
};

namespace detail {

inline void validate_brick(const char* name, const char* length, int direction, double size, int cells, bool periodic,
                           double origin) {
  const std::string suffix = direction < 0 ? "" : fmt::format("[{}]", direction);
  require_positive(fmt::format("{}.{}{}", name, length, suffix), size, "m");
  require_finite(fmt::format("{}.origin{}", name, suffix), origin, "m");
  const int least = periodic ? 3 : 1;
  if (cells < least)
    reject(fmt::format("{}.cells{}", name, suffix), cells, "",
           periodic ? "at least 3 in a periodic direction" : "at least 1");
}

template <int D>
[[nodiscard]] PointCloud<D> brick(const Point<D>& size, const std::array<int, static_cast<std::size_t>(D)>& cells,
                                  const std::array<bool, static_cast<std::size_t>(D)>& periodic,
                                  const Point<D>& origin, const std::string& region) {
  PointCloud<D> cloud;
  cloud.regions = {region};
  std::array<Index, static_cast<std::size_t>(D)> nodes{};
  std::size_t node_count = 1;
  std::size_t cell_count = 1;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    nodes[k] = static_cast<Index>(cells[k] + (periodic[k] ? 0 : 1));
    node_count *= nodes[k];
    cell_count *= static_cast<std::size_t>(cells[k]);
    if (periodic[k]) cloud.period[static_cast<int>(k)] = size[static_cast<int>(k)];
  }
  cloud.positions.reserve(node_count);
  for (std::size_t n = 0; n < node_count; ++n) {
    Point<D> x;
    std::size_t rest = n;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const int d = static_cast<int>(k);
      x[d] = origin[d] + size[d] * (static_cast<double>(rest % nodes[k]) / static_cast<double>(cells[k]));
      rest /= nodes[k];
    }
    cloud.positions.push_back(x);
  }
  cloud.cells.reserve(cell_count);
  for (std::size_t c = 0; c < cell_count; ++c) {
    typename PointCloud<D>::Cell cell;
    for (std::size_t a = 0; a < cell.size(); ++a) {
      std::size_t rest = c;
      std::size_t number = 0;
      std::size_t stride = 1;
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const std::size_t along = rest % static_cast<std::size_t>(cells[k]) + ((a >> k) & 1u);
        rest /= static_cast<std::size_t>(cells[k]);
        number += (along % nodes[k]) * stride;  // wraps in periodic directions
        stride *= nodes[k];
      }
      cell[a] = static_cast<Index>(number);
    }
    cloud.cells.push_back(cell);
  }
  cloud.cell_regions.assign(cell_count, 0);
  cloud.facets = extract_facets(cloud);
  return morton_ordered(cloud);
}

}  // namespace detail

inline void Bar::validate() const { detail::validate_brick("Bar", "length", -1, length, cells, periodic, origin); }
inline void Rectangle::validate() const {
  for (int k = 0; k < 2; ++k) {
    const auto i = static_cast<std::size_t>(k);
    detail::validate_brick("Rectangle", "size", k, size[k], cells[i], periodic[i], origin[k]);
  }
}
inline void Box::validate() const {
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    detail::validate_brick("Box", "size", k, size[k], cells[i], periodic[i], origin[k]);
  }
}

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

}  // namespace tactoid
