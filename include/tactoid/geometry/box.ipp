#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/geometry/box.hpp>

namespace tactoid::detail {

TACTOID_INLINE void validate_brick(const char* name, const char* length, int direction, double size, int cells,
                                   bool periodic, double origin) {
  const std::string suffix = direction < 0 ? "" : fmt::format("[{}]", direction);
  require_positive(fmt::format("{}.{}{}", name, length, suffix), size, "m");
  require_finite(fmt::format("{}.origin{}", name, suffix), origin, "m");
  const int least = periodic ? 3 : 1;
  if (cells < least)
    reject(fmt::format("{}.cells{}", name, suffix), cells, "",
           periodic ? "at least 3 in a periodic direction" : "at least 1");
}

template <int D>
PointCloud<D> brick(const Point<D>& size, const std::array<int, static_cast<std::size_t>(D)>& cells,
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

}  // namespace tactoid::detail

namespace tactoid {

TACTOID_INLINE void Bar::validate() const { detail::validate_brick("Bar", "length", -1, length, cells, periodic, origin); }

TACTOID_INLINE void Rectangle::validate() const {
  for (int k = 0; k < 2; ++k) {
    const auto i = static_cast<std::size_t>(k);
    detail::validate_brick("Rectangle", "size", k, size[k], cells[i], periodic[i], origin[k]);
  }
}

TACTOID_INLINE void Box::validate() const {
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    detail::validate_brick("Box", "size", k, size[k], cells[i], periodic[i], origin[k]);
  }
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template PointCloud<1> brick<1>(const Point<1>& size, const std::array<int, static_cast<std::size_t>(1)>& cells,
                                const std::array<bool, static_cast<std::size_t>(1)>& periodic, const Point<1>& origin,
                                const std::string& region);
template PointCloud<2> brick<2>(const Point<2>& size, const std::array<int, static_cast<std::size_t>(2)>& cells,
                                const std::array<bool, static_cast<std::size_t>(2)>& periodic, const Point<2>& origin,
                                const std::string& region);
template PointCloud<3> brick<3>(const Point<3>& size, const std::array<int, static_cast<std::size_t>(3)>& cells,
                                const std::array<bool, static_cast<std::size_t>(3)>& periodic, const Point<3>& origin,
                                const std::string& region);
}  // namespace tactoid::detail
#endif
