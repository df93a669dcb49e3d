#pragma once

#include <array>
#include <cmath>

#include <Eigen/Core>

namespace tactoid {

/// A number with its derivatives to N variables (forward automatic differentiation). T is double, Lanes
/// or Dual again (second derivatives).
template <class T, int N>
struct Dual {
  T value{};                      ///< the number itself
  std::array<T, N> derivative{};  ///< its derivative to each variable

  Dual() = default;
  /// A constant: all derivatives are zero.
  Dual(double constant) : value(constant) { derivative.fill(T(0.0)); }  // NOLINT: constants convert
  /// A constant of the inner scalar.
  Dual(const T& constant) requires(!std::is_same_v<T, double>) : value(constant) { derivative.fill(T(0.0)); }

  /// The variable number `i` at the value `v`.
  static Dual variable(const T& v, int i) {
    Dual x(v);
    x.derivative[static_cast<std::size_t>(i)] = T(1.0);
    return x;
  }

  ///@{
  /// Arithmetic by the rules of differentiation.
  Dual& operator+=(const Dual& b) {
    value += b.value;
    for (std::size_t i = 0; i < N; ++i) derivative[i] += b.derivative[i];
    return *this;
  }
  Dual& operator-=(const Dual& b) {
    value -= b.value;
    for (std::size_t i = 0; i < N; ++i) derivative[i] -= b.derivative[i];
    return *this;
  }
  Dual& operator*=(const Dual& b) {
    for (std::size_t i = 0; i < N; ++i) derivative[i] = derivative[i] * b.value + value * b.derivative[i];
    value *= b.value;
    return *this;
  }
  Dual& operator/=(const Dual& b) {
    const T inverse = T(1.0) / b.value;
    value *= inverse;
    for (std::size_t i = 0; i < N; ++i) derivative[i] = (derivative[i] - value * b.derivative[i]) * inverse;
    return *this;
  ///@}
  }
  ///@{
  /// Arithmetic by the rules of differentiation.
  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator*(Dual a, const Dual& b) { return a *= b; }
  friend Dual operator/(Dual a, const Dual& b) { return a /= b; }
  friend Dual operator-(const Dual& a) { return Dual(0.0) - a; }
  ///@}

  ///@{
  /// Compares the values; derivatives do not count.
  friend bool operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend bool operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend bool operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend bool operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }
  friend bool operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  ///@}

  ///@{
  /// The function, and its derivatives by the chain rule. abs has the slope +1 at 0.
  friend Dual sqrt(const Dual& a) {
    using std::sqrt;
    const T root = sqrt(a.value);
    return chain(a, root, T(0.5) / root);
  }
  friend Dual log(const Dual& a) {
    using std::log;
    return chain(a, log(a.value), T(1.0) / a.value);
  }
  friend Dual exp(const Dual& a) {
    using std::exp;
    const T e = exp(a.value);
    return chain(a, e, e);
  }
  friend Dual sin(const Dual& a) {
    using std::cos;
    using std::sin;
    return chain(a, sin(a.value), cos(a.value));
  }
  friend Dual cos(const Dual& a) {
    using std::cos;
    using std::sin;
    return chain(a, cos(a.value), -sin(a.value));
  }
  friend Dual abs(const Dual& a) { return a.value < T(0.0) ? -a : a; }
  ///@}

 private:
  static Dual chain(const Dual& a, const T& f, const T& slope) {
    Dual r;
    r.value = f;
    for (std::size_t i = 0; i < N; ++i) r.derivative[i] = slope * a.derivative[i];
    return r;
  }
};

}  // namespace tactoid

namespace Eigen {
template <class T, int N>
struct NumTraits<tactoid::Dual<T, N>> : NumTraits<double> {
  using Real = tactoid::Dual<T, N>;
  using NonInteger = tactoid::Dual<T, N>;
  using Literal = tactoid::Dual<T, N>;
  using Nested = tactoid::Dual<T, N>;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1, ReadCost = 1, AddCost = 1, MulCost = 1 };
};
}  // namespace Eigen
