// A law of one's own: Gent's rubber, given by its energy alone and with its stress by hand. Both pass the gate of the
// library's own laws, then pull a block to 1.6 times its length.
#include <cmath>

#include <tactoid/tactoid.hpp>
#include <tactoid/verify/material_gate.hpp>

using namespace tactoid;

/// Gent's rubber (Rubber Chem. Technol. 1996, 69, 59), whose chains cannot stretch beyond I₁ = 3 + J_m:
///   W = −½ μ J_m ln(1 − (I₁ − 3)/J_m) − μ ln J + ½ λ (ln J)²
/// The stress is the derivative of the energy, by automatic differentiation.
struct GentEnergy {
  static constexpr bool dissipative = true;  ///< promises that no closed cycle yields work: the gate then requires it

  double density = 1000.0;  ///< ρ₀, kg/m³
  double mu = 1.0e3;        ///< μ, Pa
  double lambda = 9.0e3;    ///< λ, Pa
  double limit = 5.0;       ///< J_m

  void validate() const {
    require_positive("Gent.density", density, "kg/m^3");
    require_positive("Gent.mu", mu, "Pa");
    require_positive("Gent.lambda", lambda, "Pa");
    require_positive("Gent.limit", limit);
  }
  [[nodiscard]] double wave_speed() const { return std::sqrt((lambda + 2.0 * mu) / density); }
  [[nodiscard]] double shear_modulus() const { return mu; }

  template <class T>
  [[nodiscard]] T energy(const Tensor<T>& F) const {
    using std::log;
    const T log_J = log(determinant(F));
    const T room = T(1.0) - (contract(F, F) - T(3.0)) / T(limit);
    return T(-0.5 * mu * limit) * log(room) - T(mu) * log_J + T(0.5 * lambda) * log_J * log_J;
  }
};

/// The same law with its stress by hand, P = μ F/(1 − (I₁ − 3)/J_m) + (λ ln J − μ) F⁻ᵀ: several times faster.
struct Gent : GentEnergy {
  template <class T>
  [[nodiscard]] Tensor<T> first_piola(const Tensor<T>& F) const {
    using std::log;
    const Tensor<T> cofactors = cofactor(F);
    const T J = determinant(F, cofactors);
    const T room = T(1.0) - (contract(F, F) - T(3.0)) / T(limit);
    return F * (T(mu) / room) + cofactors * ((T(lambda) * log(J) - T(mu)) / J);
  }
};

/// Force that holds a block of 2 × 1 × 1 m at 1.6 times its length, its ends clamped, N.
template <class Law>
double pull(const Law& law) {
  PointCloud<3> cloud = box({.size = {2.0, 1.0, 1.0}, .cells = {8, 4, 4}});
  const auto left = select(cloud, [](const Point<3>& X) { return X[0] < 1e-9; });
  const auto right = select(cloud, [](const Point<3>& X) { return X[0] > 2.0 - 1e-9; });
  Body block{"block", std::move(cloud), Rkpm<3>{}, NodalCentroids{}, Materials{Region{"body", law}}};
  StaticProblem problem{block, {fixed(left), {right, [](const Vector3&, double) { return Vector3(1.2, 0.0, 0.0); }}}};
  const StaticReport report = StaticNewton{.load_steps = 3}.solve(problem);
  fmt::print("held at 1.6 times its length by {:.6f} N, found in {} iterations\n", problem.reaction(1)[0],
             report.iterations);
  return problem.reaction(1)[0];
}

int main() {
  const GateReport of_energy = material_gate(GentEnergy{}), of_stress = material_gate(Gent{});
  fmt::print("Energy alone:\n{}\nStress by hand:\n{}\n", of_energy.text(), of_stress.text());
  if (!of_energy.passed() || !of_stress.passed()) return 1;

  const double by_energy = pull(GentEnergy{}), by_hand = pull(Gent{});
  return std::abs(by_energy - by_hand) <= 1e-9 * std::abs(by_hand) ? 0 : 1;
}
