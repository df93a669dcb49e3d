#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/order.hpp>

namespace tactoid {

template <int D>
std::vector<Index> morton_order(const std::vector<Point<D>>& points) {
  std::vector<Index> order(points.size());
  std::iota(order.begin(), order.end(), Index{0});
  if (points.empty()) return order;
  Point<D> lower = points[0];
  Point<D> upper = points[0];
  for (const Point<D>& p : points) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  constexpr int bits = 63 / D > 21 ? (D == 1 ? 52 : 31) : 21;
  const double extent = (upper - lower).maxCoeff();
  const double scale = extent > 0.0 ? static_cast<double>((std::uint64_t{1} << bits) - 1) / extent : 0.0;
  std::vector<std::uint64_t> codes(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int k = 0; k < D; ++k) {
      const auto x = static_cast<std::uint64_t>((points[i][k] - lower[k]) * scale);
      for (int b = 0; b < bits; ++b) codes[i] |= ((x >> b) & 1u) << (b * D + k);
    }
  }
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return codes[a] != codes[b] ? codes[a] < codes[b] : a < b; });
  return order;
}

template <int D>
PointCloud<D> morton_ordered(const PointCloud<D>& cloud) {
  if (cloud.part) throw ParameterError("morton_ordered: the particles of a part of a cloud have an order of their own.");
  PointCloud<D> ordered;
  ordered.regions = cloud.regions;
  ordered.period = cloud.period;
  ordered.axisymmetric = cloud.axisymmetric;
  const std::vector<Index> order = morton_order<D>(cloud.positions);
  std::vector<Index> number(cloud.size());
  ordered.positions.reserve(cloud.size());
  for (Index i = 0; i < order.size(); ++i) {
    ordered.positions.push_back(cloud.positions[order[i]]);
    number[order[i]] = i;
  }
  const auto renumbered = [&](auto entity) {
    for (Index& i : entity) i = number[i];
    return entity;
  };
  const auto centers = [&](const auto& entities) {
    std::vector<Point<D>> middle;
    middle.reserve(entities.size());
    for (const auto& entity : entities) {
      const Point<D>& first = cloud.positions[entity[0]];
      Point<D> sum = Point<D>::Zero();
      for (const Index i : entity) sum += cloud.difference(first, cloud.positions[i]);
      middle.push_back(first + sum / static_cast<double>(entity.size()));
    }
    return middle;
  };
  ordered.cells.reserve(cloud.cells.size());
  ordered.cell_regions.reserve(cloud.cells.size());
  for (const Index c : morton_order<D>(centers(cloud.cells))) {
    ordered.cells.push_back(renumbered(cloud.cells[c]));
    ordered.cell_regions.push_back(cloud.cell_regions[c]);
  }
  ordered.facets.reserve(cloud.facets.size());
  for (const Index f : morton_order<D>(centers(cloud.facets)))
    ordered.facets.push_back(renumbered(cloud.facets[f]));
  return ordered;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template std::vector<Index> morton_order<1>(const std::vector<Point<1>>& points);
template std::vector<Index> morton_order<2>(const std::vector<Point<2>>& points);
template std::vector<Index> morton_order<3>(const std::vector<Point<3>>& points);
template PointCloud<1> morton_ordered<1>(const PointCloud<1>& cloud);
template PointCloud<2> morton_ordered<2>(const PointCloud<2>& cloud);
template PointCloud<3> morton_ordered<3>(const PointCloud<3>& cloud);
}  // namespace tactoid
#endif
