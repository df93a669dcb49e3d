#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
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

/// What is asked of a kernel at a point; returns the condition number of its moment matrix.
template <int D>
using EvaluateKernel = std::function<double(std::span<const KernelNeighbor<D>>, ShapeFunctions<D>&)>;

/// `radii` are those of support_radii, `support` and `basis_size` those of the kernel.
template <int D>
[[nodiscard]] ShapeFunctionTable<D> fill_table(const PointCloud<D>& cloud, const std::vector<Point<D>>& points, const ShapeFunctionOptions& options,
                                               const std::vector<double>& radii, double support, int basis_size, bool with_values,
                                               const EvaluateKernel<D>& evaluate);

}  // namespace detail

/// Shape functions of the cloud and their reference gradients at the given points, with supports from
/// support_radii and volumes from nodal_volumes. Throws GeometryError that names point, position, neighbour count and
/// condition number where the moment matrix cannot be trusted: the order is never lowered silently.
template <Kernel K>
[[nodiscard]] ShapeFunctionTable<K::dimension> shape_functions(const K& kernel, const PointCloud<K::dimension>& cloud,
                                                               const std::vector<Point<K::dimension>>& points,
                                                               const ShapeFunctionOptions& options = {}) {
  constexpr int D = K::dimension;
  kernel.validate();
  return detail::fill_table<D>(cloud, points, options, support_radii(kernel, cloud), kernel.support, K::basis_size, true,
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
  kernel.validate();
  return detail::fill_table<D>(cloud, points, options, support_radii(kernel, cloud), kernel.support, K::basis_size, false,
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

#if !defined(TACTOID_COMPILED)
#include <tactoid/kernel/shape_functions.ipp>
#endif
