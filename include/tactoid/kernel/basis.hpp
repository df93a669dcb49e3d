#pragma once

#include <cmath>

#include <tactoid/core/tensor.hpp>

namespace tactoid {

/// Number of monomials up to `order` in D variables.
template <int D, int Order>
inline constexpr int monomial_count = Order == 1 ? 1 + D : 1 + D + D * (D + 1) / 2;

/// The values of the monomials at a point.
template <int D, int Order>
using BasisVector = Eigen::Matrix<double, monomial_count<D, Order>, 1>;
/// Moment matrices M = Σ w p pᵀ.
template <int D, int Order>
using BasisMatrix = Eigen::Matrix<double, monomial_count<D, Order>, monomial_count<D, Order>>;

/// The monomials p(z) = (1, z_1, …, z_D) of order 1, followed by z_k z_l (k <= l) for order 2.
template <int D, int Order>
[[nodiscard]] BasisVector<D, Order> monomials(const Point<D>& z) {
  static_assert(Order == 1 || Order == 2, "The polynomial basis has order 1 or 2.");
  BasisVector<D, Order> p;
  p[0] = 1.0;
  for (int k = 0; k < D; ++k) p[1 + k] = z[k];
  if constexpr (Order == 2) {
    int i = 1 + D;
    for (int k = 0; k < D; ++k)
      for (int l = k; l < D; ++l) p[i++] = z[k] * z[l];
  }
  return p;
}

}  // namespace tactoid
