#pragma once

#include <cmath>
#include <numbers>

#include <tactoid/core/random.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/material/material.hpp>

namespace tactoid::detail {

/// A smooth path of deformation and its rate from F = 1, with a director that does not change in time.
struct GatePath {
  Tensor3 end = Tensor3::Identity();              ///< F at s = 1 (monotone path) or half way (cycle)
  Tensor3 aside = Tensor3::Zero();                ///< added as s (1 − s) or sin(2πs): makes the path curved
  Vector3 director = Vector3::Zero();
  Tensor3 director_gradient = Tensor3::Zero();
  Tensor3 turn = Tensor3::Zero();                 ///< skew; the path is turned by the rotation exp(s · turn)
  bool closed = false;                            ///< F(1) = 1
  double duration = 1.0;                          ///< s

  [[nodiscard]] PointState<double> at(double s, double time_step) const {
    constexpr double pi = std::numbers::pi;
    const Tensor3 H = end - Tensor3::Identity();
    const double a = closed ? 0.5 * (1.0 - std::cos(2.0 * pi * s)) : s;
    const double b = closed ? std::sin(2.0 * pi * s) : s * (1.0 - s);
    const double a_rate = closed ? pi * std::sin(2.0 * pi * s) : 1.0;
    const double b_rate = closed ? 2.0 * pi * std::cos(2.0 * pi * s) : 1.0 - 2.0 * s;
    const Tensor3 F = Tensor3::Identity() + a * H + b * aside;
    const Tensor3 F_rate = (a_rate * H + b_rate * aside) / duration;
    const Tensor3 Q = rotation(s);
    PointState<double> p;
    p.deformation_gradient = Q * F;
    p.deformation_rate = Q * (F_rate + (turn / duration) * F);  // Q̇ = Q turn / duration
    p.director = Q * director;
    p.director_gradient = Q * director_gradient;
    p.time_step = time_step;
    return p;
  }

  /// exp(s · turn) by Rodrigues' formula.
  [[nodiscard]] Tensor3 rotation(double s) const {
    const double angle = s * Vector3(turn(2, 1), turn(0, 2), turn(1, 0)).norm();
    if (!(angle > 0.0)) return Tensor3::Identity();
    const Tensor3 unit = turn * (s / angle);
    return Tensor3::Identity() + std::sin(angle) * unit + (1.0 - std::cos(angle)) * unit * unit;
  }
};

inline Tensor3 random_tensor(Random& random, double size) {
  Tensor3 A;
  for (int k = 0; k < 9; ++k) A(k / 3, k % 3) = random.uniform(-size, size);
  return A;
}

/// Calls set(to, from) for every scalar of a state, and copies the time step.
template <class T, class Set>
void set_state(PointState<T>& to, const PointState<double>& from, const Set& set) {
  for (int i = 0; i < 3; ++i) {
    set(to.director(i), from.director(i));
    for (int K = 0; K < 3; ++K) {
      set(to.deformation_gradient(i, K), from.deformation_gradient(i, K));
      set(to.deformation_rate(i, K), from.deformation_rate(i, K));
      set(to.director_gradient(i, K), from.director_gradient(i, K));
    }
  }
  to.time_step = from.time_step;
}

}  // namespace tactoid::detail
