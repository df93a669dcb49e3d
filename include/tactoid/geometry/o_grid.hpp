#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid::detail {

/// The point of the unit sphere (circle) that belongs to the point `d` of the surface of the cube [−1, 1]^D:
/// equiangular, so that equal steps on the cube are nearly equal angles.
template <int D>
[[nodiscard]] Point<D> equiangular_direction(const Point<D>& d);

/// Lattice point of [−1, 1]^D as its distance s from the centre in the maximum norm and its direction d = c / s on
/// the surface of the cube.
template <int D>
struct CubePoint {
  double s = 0.0;
  Point<D> d = Point<D>::Zero();
};

/// An O-grid: a core of `core_cells`^D cells and `shells` layers of cells around it. Positions come from
/// core(CubePoint) and shell(k, d), k = 1 … shells, where d is a lattice point on the surface of the cube. The
/// region of the core is 0, that of the shells 1. Facets and region names are left to the caller.
template <int D, class CoreMap, class ShellMap>
[[nodiscard]] PointCloud<D> o_grid(int core_cells, int shells, const CoreMap& core, const ShellMap& shell) {
  PointCloud<D> cloud;
  const auto n = static_cast<std::size_t>(core_cells);
  std::size_t core_nodes = 1;
  for (int k = 0; k < D; ++k) core_nodes *= n + 1;
  const auto lattice = [n](std::size_t node) {
    std::array<std::size_t, static_cast<std::size_t>(D)> i{};
    for (auto& along : i) {
      along = node % (n + 1);
      node /= n + 1;
    }
    return i;
  };
  const auto node_number = [n](const std::array<std::size_t, static_cast<std::size_t>(D)>& i) {
    std::size_t number = 0;
    for (std::size_t k = i.size(); k-- > 0;) number = number * (n + 1) + i[k];
    return number;
  };
  std::vector<Point<D>> surface;  // d of the surface nodes
  std::vector<std::size_t> surface_number(core_nodes, 0);
  std::vector<Index> surface_node;
  for (std::size_t node = 0; node < core_nodes; ++node) {
    Point<D> c;
    const auto i = lattice(node);
    for (int k = 0; k < D; ++k)
      c[k] = (2.0 * static_cast<double>(i[static_cast<std::size_t>(k)]) - static_cast<double>(n)) /
             static_cast<double>(n);
    CubePoint<D> point{c.cwiseAbs().maxCoeff(), c};
    if (point.s > 0.0) point.d /= point.s;
    cloud.positions.push_back(core(point));
    if (point.s == 1.0) {
      surface_number[node] = surface.size();
      surface.push_back(point.d);
      surface_node.push_back(static_cast<Index>(node));
    }
  }
  for (int k = 1; k <= shells; ++k)
    for (const Point<D>& d : surface) cloud.positions.push_back(shell(k, d));
  const auto layer_node = [&](int k, std::size_t node) {
    const std::size_t s = surface_number[node];
    return k == 0 ? surface_node[s]
                  : static_cast<Index>(core_nodes + static_cast<std::size_t>(k - 1) * surface.size() + s);
  };

  using Cell = typename PointCloud<D>::Cell;
  for (std::size_t node = 0; node < core_nodes; ++node) {
    const auto i = lattice(node);
    bool inside = true;
    for (const std::size_t along : i) inside = inside && along < n;
    if (!inside) continue;
    Cell cell;
    for (std::size_t a = 0; a < cell.size(); ++a) {
      auto corner = i;
      for (std::size_t k = 0; k < corner.size(); ++k) corner[k] += (a >> k) & 1u;
      cell[a] = static_cast<Index>(node_number(corner));
    }
    cloud.cells.push_back(cell);
  }
  cloud.cell_regions.assign(cloud.cells.size(), 0);

  // Shell cells over every side of the core's surface: the axes of the side first, outwards last.
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(D); ++axis) {
    for (const bool upper : {false, true}) {
      const bool positive = ((static_cast<std::size_t>(D) - 1 - axis) % 2 == 0) == upper;
      for (std::size_t node = 0; node < core_nodes; ++node) {
        const auto i = lattice(node);
        bool starts = i[axis] == (upper ? n : 0);
        for (std::size_t k = 0; k < i.size(); ++k) starts = starts && (k == axis || i[k] < n);
        if (!starts) continue;
        for (int layer = 0; layer < shells; ++layer) {
          Cell cell;
          for (std::size_t a = 0; a < cell.size(); ++a) {
            auto corner = i;
            std::size_t bit = 0;
            for (std::size_t k = 0; k < corner.size(); ++k) {
              if (k == axis) continue;
              std::size_t step = (a >> bit) & 1u;
              if (bit == 0 && !positive) step = 1 - step;
              corner[k] += step;
              ++bit;
            }
            cell[a] = layer_node(layer + static_cast<int>((a >> (D - 1)) & 1u), node_number(corner));
          }
          cloud.cells.push_back(cell);
        }
      }
    }
  }
  cloud.cell_regions.resize(cloud.cells.size(), 1);
  return cloud;
}

}  // namespace tactoid::detail

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/o_grid.ipp>
#endif
