#pragma once

#include <limits>

#include <Eigen/Core>

namespace tactoid {

/// Several quadrature points at once: an arithmetic type whose operations act on W doubles side by side.
/// Laws that are generic over their scalar run on Lanes without a change; Eigen maps the lanes to the
/// registers of the machine (two, four or eight doubles wide) and vectorises log and exp.
template <int W>
struct Lanes {
  using Array = Eigen::Array<double, W, 1>;  ///< what holds the lanes
  static constexpr int width = W;            ///< number of lanes

  Array lane;  ///< one number per lane; not initialised by default

  Lanes() = default;
  /// The same number in all lanes.
  Lanes(double all) : lane(Array::Constant(all)) {}  // NOLINT: a number is a constant over all lanes
  explicit Lanes(const Array& a) : lane(a) {}  ///< lane by lane

  ///@{
  /// Arithmetic in every lane.
  Lanes& operator+=(const Lanes& b) { lane += b.lane; return *this; }
  Lanes& operator-=(const Lanes& b) { lane -= b.lane; return *this; }
  Lanes& operator*=(const Lanes& b) { lane *= b.lane; return *this; }
  Lanes& operator/=(const Lanes& b) { lane /= b.lane; return *this; }
  ///@}

  ///@{
  /// Arithmetic in every lane.
  friend Lanes operator+(Lanes a, const Lanes& b) { return a += b; }
  friend Lanes operator-(Lanes a, const Lanes& b) { return a -= b; }
  friend Lanes operator*(Lanes a, const Lanes& b) { return a *= b; }
  friend Lanes operator/(Lanes a, const Lanes& b) { return a /= b; }
  friend Lanes operator-(const Lanes& a) { return Lanes(Array(-a.lane)); }
  ///@}

  ///@{
  /// The function in every lane.
  friend Lanes sqrt(const Lanes& a) { return Lanes(Array(a.lane.sqrt())); }
  friend Lanes log(const Lanes& a) { return Lanes(Array(a.lane.log())); }
  friend Lanes exp(const Lanes& a) { return Lanes(Array(a.lane.exp())); }
  friend Lanes abs(const Lanes& a) { return Lanes(Array(a.lane.abs())); }
  ///@}
};

/// Number of lanes of a scalar type, and access to one of them.
template <class T>
inline constexpr int lane_count = 1;
/// Of Lanes<W>: W.
template <int W>
inline constexpr int lane_count<Lanes<W>> = W;

/// The only lane of a double.
[[nodiscard]] inline double lane(double a, int) { return a; }
/// Sets the only lane of a double.
inline void set_lane(double& a, int, double value) { a = value; }
/// Lane l, 0 <= l < W.
template <int W>
[[nodiscard]] inline double lane(const Lanes<W>& a, int l) { return a.lane[l]; }
/// Sets lane l, 0 <= l < W.
template <int W>
inline void set_lane(Lanes<W>& a, int l, double value) { a.lane[l] = value; }

}  // namespace tactoid

namespace Eigen {
template <int W>
struct NumTraits<tactoid::Lanes<W>> : NumTraits<double> {
  using Real = tactoid::Lanes<W>;
  using NonInteger = tactoid::Lanes<W>;
  using Literal = tactoid::Lanes<W>;
  using Nested = tactoid::Lanes<W>;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 0, ReadCost = 1, AddCost = 1, MulCost = 1 };
};
}  // namespace Eigen
