#pragma once

#include <concepts>
#include <span>
#include <vector>

#include <tactoid/core/tensor.hpp>
#include <tactoid/core/unsatisfied.hpp>

namespace tactoid {

/// A particle as a kernel sees it from the evaluation point X.
template <int D>
struct KernelNeighbor {
  Point<D> offset;       ///< X_I − X, m
  double support = 0.0;  ///< support radius a_I of the particle, m
  double volume = 1.0;   ///< nodal volume ΔV_I (m, m², m³)
};

/// Shape functions of the neighbours of one point.
template <int D>
struct ShapeFunctions {
  std::vector<double> value;        ///< φ_I(X)
  std::vector<Point<D>> gradient;   ///< ∇₀φ_I(X), 1/m
  double condition = 0.0;           ///< condition number of the scaled moment matrix
};

/// A meshfree approximation with reproducing conditions.
///
/// It has `dimension`, `order` (of the polynomial basis: 1 or 2), `basis_size`, a type `Window` (see windows.hpp), a
/// parameter `double support` (support radius as a multiple of the local particle spacing), `void validate() const`,
/// and
///   void shape_functions(std::span<const KernelNeighbor<D>>, ShapeFunctions<D>& out) const
///       the shape functions and their analytic gradients;
///   double direct_gradient(std::span<const KernelNeighbor<D>>, std::vector<Point<D>>& out) const
///       the value-based gradient operator G_I (exact on the basis when applied to particle values) and
///       the condition number of its moment matrix, as the return value.
/// Both are called once per quadrature point at set-up, from several threads. They do not throw: with too few
/// neighbours or a singular moment matrix the condition number is infinite, and the caller reports it.
template <class K>
concept Kernel =
    (requires {
      { K::dimension } -> std::convertible_to<int>;
      { K::order } -> std::convertible_to<int>;
      { K::basis_size } -> std::convertible_to<int>;
    } || unsatisfied<"A Kernel has static constants `dimension`, `order` and `basis_size`.">) &&
    (requires(double q) {
      { K::Window::value(q) } -> std::convertible_to<double>;
    } || unsatisfied<"A Kernel has a type `Window` with `static double value(double q)`, the weight at q = r/support.">) &&
    (requires(const K& k) {
      { k.support } -> std::convertible_to<double>;
      k.validate();
    } || unsatisfied<"A Kernel has a parameter `double support` (support radius per local particle spacing) and "
                     "`void validate() const`.">) &&
    (requires(const K& k, std::span<const KernelNeighbor<K::dimension>> n, ShapeFunctions<K::dimension>& s) {
      k.shape_functions(n, s);
    } || unsatisfied<"A Kernel has `void shape_functions(std::span<const KernelNeighbor<D>>, "
                     "ShapeFunctions<D>&) const`.">) &&
    (requires(const K& k, std::span<const KernelNeighbor<K::dimension>> n, std::vector<Point<K::dimension>>& g) {
      { k.direct_gradient(n, g) } -> std::convertible_to<double>;
    } || unsatisfied<"A Kernel has `double direct_gradient(std::span<const KernelNeighbor<D>>, "
                     "std::vector<Point<D>>&) const`.">);

}  // namespace tactoid
