#pragma once

#include <concepts>

#include <tactoid/core/unsatisfied.hpp>

namespace tactoid {

/// A window function w(q) of q = |X_I − X| / a_I >= 0: non-negative, zero for q >= 1, with continuous slope
/// dw/dq that vanishes at q = 0 and q = 1. Its scale is free: shape functions do not depend on it.
template <class W>
concept Window =
    (requires(double q) {
      { W::value(q) } -> std::same_as<double>;
    } || unsatisfied<"A Window has `static double value(double q)`.">) &&
    (requires(double q) {
      { W::slope(q) } -> std::same_as<double>;
    } || unsatisfied<"A Window has `static double slope(double q)`, the derivative of value.">);

/// Cubic B-spline, twice continuously differentiable; 2/3 at q = 0.
struct CubicBSpline {
  /// w(q), q >= 0: 2/3 − 4 q² (1 − q) up to ½, 4/3 (1 − q)³ beyond.
  [[nodiscard]] static double value(double q) {
    if (q >= 1.0) return 0.0;
    const double r = 1.0 - q;
    return q <= 0.5 ? 2.0 / 3.0 - 4.0 * q * q * r : 4.0 / 3.0 * r * r * r;
  }
  /// dw/dq.
  [[nodiscard]] static double slope(double q) {
    if (q >= 1.0) return 0.0;
    const double r = 1.0 - q;
    return q <= 0.5 ? q * (12.0 * q - 8.0) : -4.0 * r * r;
  }
};

/// Quintic B-spline, four times continuously differentiable; 11/20 at q = 0.
struct QuinticBSpline {
  /// w(q) = {(3 − s)₊⁵ − 6 (2 − s)₊⁵ + 15 (1 − s)₊⁵}/120 with s = 3 q.
  [[nodiscard]] static double value(double q) {
    const double s = 3.0 * q;
    return (power5(3.0 - s) - 6.0 * power5(2.0 - s) + 15.0 * power5(1.0 - s)) / 120.0;
  }
  /// dw/dq.
  [[nodiscard]] static double slope(double q) {
    const double s = 3.0 * q;
    return -15.0 * (power4(3.0 - s) - 6.0 * power4(2.0 - s) + 15.0 * power4(1.0 - s)) / 120.0;
  }

 private:
  [[nodiscard]] static double power4(double x) { return x > 0.0 ? x * x * x * x : 0.0; }
  [[nodiscard]] static double power5(double x) { return x > 0.0 ? x * x * x * x * x : 0.0; }
};

/// Wendland's compactly supported function of smoothness C² (positive definite up to three dimensions):
/// (1 − q)⁴ (4 q + 1); H. Wendland, Adv. Comput. Math. 1995, 4, 389.
struct WendlandC2 {
  /// w(q), q >= 0.
  [[nodiscard]] static double value(double q) {
    if (q >= 1.0) return 0.0;
    const double r2 = (1.0 - q) * (1.0 - q);
    return r2 * r2 * (4.0 * q + 1.0);
  }
  /// dw/dq = −20 q (1 − q)³.
  [[nodiscard]] static double slope(double q) {
    if (q >= 1.0) return 0.0;
    const double r = 1.0 - q;
    return -20.0 * q * r * r * r;
  }
};

}  // namespace tactoid
