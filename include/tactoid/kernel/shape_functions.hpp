#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/geometry/validate.hpp>
#include <tactoid/kernel/kernel.hpp>
#include <tactoid/kernel/support.hpp>
#include <tactoid/neighbors/neighbor_table.hpp>

namespace tactoid {

/// Shape functions (or value-based gradients) at many points, in one flat table: entries of point q from offsets[q] to
/// offsets[q + 1], sorted by particle.
template <int D>
struct ShapeFunctionTable {
  std::vector<std::size_t> offsets = {0};  ///< one more than points
  std::vector<Index> indices;           ///< particles I
  std::vector<double> values;           ///< φ_I(X_q); empty in a table of value-based gradients
  std::vector<Point<D>> gradients;      ///< ∇₀φ_I(X_q), or G_qI, 1/m
  double largest_condition = 0.0;       ///< largest condition number of the moment matrices

  [[nodiscard]] std::size_t points() const { return offsets.size() - 1; }  ///< number of points
};

/// How a table of shape functions is checked.
struct ShapeFunctionOptions {
  double condition_limit = 1e10;  ///< largest condition number that is accepted, > 1
  /// Throws ParameterError unless condition_limit > 1.
  void validate() const {
    if (!(condition_limit > 1.0)) reject("ShapeFunctionOptions.condition_limit", condition_limit, "", "above 1");
  }
};

namespace detail {

/// The neighbours of a point as a kernel takes them.
template <int D>
void gather(const PointCloud<D>& cloud, const Point<D>& x, std::span<const Index> row,
            const std::vector<double>& supports, const std::vector<double>& volumes,
            std::vector<KernelNeighbor<D>>& out) {
  out.clear();
  for (const Index i : row) out.push_back({cloud.difference(x, cloud.positions[i]), supports[i], volumes[i]});
}

template <Kernel K, class Evaluate>
[[nodiscard]] ShapeFunctionTable<K::dimension> fill_table(const K& kernel, const PointCloud<K::dimension>& cloud,
                                                          const std::vector<Point<K::dimension>>& points,
                                                          const ShapeFunctionOptions& options, bool with_values,
                                                          const Evaluate& evaluate) {
  constexpr int D = K::dimension;
  kernel.validate();
  options.validate();
  const std::vector<double> supports = support_radii(kernel, cloud);
  const std::vector<double> volumes = nodal_volumes(cloud);
  NeighborTable neighbors = neighbor_table(cloud, points, supports);
  ShapeFunctionTable<D> table;
  table.gradients.resize(neighbors.indices.size());
  if (with_values) table.values.resize(neighbors.indices.size());
  std::vector<double> conditions(points.size());
  parallel_for(points.size(), [&](std::size_t q) {
    thread_local std::vector<KernelNeighbor<D>> near;
    thread_local ShapeFunctions<D> shape;
    gather<D>(cloud, points[q], neighbors.row(q), supports, volumes, near);
    conditions[q] = evaluate(std::span<const KernelNeighbor<D>>(near), shape);
    const auto first = static_cast<std::ptrdiff_t>(neighbors.offsets[q]);
    std::copy(shape.gradient.begin(), shape.gradient.end(), table.gradients.begin() + first);
    if (with_values) std::copy(shape.value.begin(), shape.value.end(), table.values.begin() + first);
  });
  for (std::size_t q = 0; q < points.size(); ++q) {
    if (!(conditions[q] <= options.condition_limit))
      throw GeometryError(fmt::format(
          "Point {} at {} has {} particles in reach, and a moment matrix of condition number {:.3g} (allowed: {:.3g}) "
          "for {} basis functions: enlarge the support of the kernel ({:g} spacings), or mend the cloud there.",
          q, describe<D>(points[q]), neighbors.row(q).size(), conditions[q], options.condition_limit, K::basis_size,
          kernel.support));
    table.largest_condition = std::max(table.largest_condition, conditions[q]);
  }
  table.offsets = std::move(neighbors.offsets);
  table.indices = std::move(neighbors.indices);
  return table;
}

}  // namespace detail

/// Shape functions of the cloud and their reference gradients at the given points, with supports from
/// support_radii and volumes from nodal_volumes. Throws GeometryError that names point, position, neighbour count and
/// condition number where the moment matrix cannot be trusted: the order is never lowered silently.
template <Kernel K>
[[nodiscard]] ShapeFunctionTable<K::dimension> shape_functions(const K& kernel, const PointCloud<K::dimension>& cloud,
                                                               const std::vector<Point<K::dimension>>& points,
                                                               const ShapeFunctionOptions& options = {}) {
  constexpr int D = K::dimension;
  return detail::fill_table(kernel, cloud, points, options, true,
                            [&](std::span<const KernelNeighbor<D>> near, ShapeFunctions<D>& shape) {
                              kernel.shape_functions(near, shape);
                              return shape.condition;
                            });
}

/// Value-based gradients G_qI of the cloud at the given points: Σ_I G_qI f(X_I) = ∇f(X_q) for f of the basis. Throws as
/// shape_functions does.
template <Kernel K>
[[nodiscard]] ShapeFunctionTable<K::dimension> direct_gradients(const K& kernel, const PointCloud<K::dimension>& cloud,
                                                                const std::vector<Point<K::dimension>>& points,
                                                                const ShapeFunctionOptions& options = {}) {
  constexpr int D = K::dimension;
  return detail::fill_table(kernel, cloud, points, options, false,
                            [&](std::span<const KernelNeighbor<D>> near, ShapeFunctions<D>& shape) {
                              return kernel.direct_gradient(near, shape.gradient);
                            });
}

/// Interpolated value Σ_I φ_I(X_q) f_I at point q of a field given by its coefficients; T is a double or a vector.
template <int D, class T>
[[nodiscard]] T interpolate(const ShapeFunctionTable<D>& table, std::size_t q, const std::vector<T>& coefficients) {
  std::size_t e = table.offsets[q];
  T sum = table.values[e] * coefficients[table.indices[e]];
  for (++e; e < table.offsets[q + 1]; ++e) sum += table.values[e] * coefficients[table.indices[e]];
  return sum;
}

}  // namespace tactoid
