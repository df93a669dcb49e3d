#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include <tactoid/geometry/cell_map.hpp>

namespace tactoid {

/// Ranks of points along a Morton (Z) curve through their bounding cube: the point numbers in that order.
/// Equal codes keep the order they had.
template <int D>
[[nodiscard]] std::vector<Index> morton_order(const std::vector<Point<D>>& points);

/// The same cloud with particles, cells and facets numbered along a Morton curve, so that neighbours in space are
/// near in memory. Throws ParameterError for a part of a cloud.
template <int D>
[[nodiscard]] PointCloud<D> morton_ordered(const PointCloud<D>& cloud);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/order.ipp>
#endif
