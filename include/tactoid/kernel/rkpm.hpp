#pragma once

#include <span>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/kernel/reproducing.hpp>

namespace tactoid {

/// Reproducing kernel particle method: weights w(|X_I − X| / a_I) ΔV_I with the nodal volumes ΔV_I, as a quadrature
/// of the continuous convolution. W. K. Liu, S. Jun and Y. F. Zhang, Int. J. Numer. Methods Fluids 1995, 20, 1081.
/// D: dimension, Order: of the polynomials that are reproduced (1 or 2), WindowFunction: see windows.hpp.
template <int D, int Order = 1, Window WindowFunction = CubicBSpline>
struct Rkpm {
  static constexpr int dimension = D;                          ///< D
  static constexpr int order = Order;                          ///< of the polynomials that are reproduced
  static constexpr int basis_size = monomial_count<D, Order>;  ///< number of monomials
  using Window = WindowFunction;                               ///< the weight function

  double support = Order == 1 ? 1.75 : 2.75;  ///< support radius per longest cell edge, > 1 (order 2: > 1.5)

  /// Throws ParameterError unless support > 1 (order 2: > 1.5).
  void validate() const { detail::validate_support("Rkpm.support", support, Order); }

  /// φ_I(X) and ∇₀φ_I(X); zero, with an infinite condition number, where the moment matrix is singular.
  void shape_functions(std::span<const KernelNeighbor<D>> neighbors, ShapeFunctions<D>& out) const {
    detail::Reproducing<D, Order, WindowFunction, true>(neighbors).shape_functions(out);
  }

  /// G_I = w_I [M⁻¹ p(X_I − X)]_{1..D}: Σ_I G_I f(X_I) = ∇f(X) for polynomials f of the basis. Returns the condition
  /// number of the scaled moment matrix.
  double direct_gradient(std::span<const KernelNeighbor<D>> neighbors, std::vector<Point<D>>& out) const {
    const detail::Reproducing<D, Order, WindowFunction, true> approximation(neighbors);
    approximation.direct_gradient(out);
    return approximation.condition();
  }
};

}  // namespace tactoid
