#pragma once

#include <cmath>

#include <tactoid/core/errors.hpp>
#include <tactoid/kinematics/kinematics.hpp>
#include <tactoid/material/material.hpp>

namespace tactoid {

/// Modified Mooney–Rivlin solid: Zeng and Li, Soft Matter 2012, 8, 5765, eqns (5)–(7).
///
///   W = C₁ (I₁ − 3 I₃^{1/3}) + C₂ (I₂ − 3 I₃^{2/3}) + ½ λ (ln I₃)² − p_i (J − 1)
///   S = 2 { (C₁ + C₂ I₁) 1 − C₂ C − (C₁ I₃^{1/3} + 2 C₂ I₃^{2/3} − λ ln I₃) C⁻¹ } − p_i J C⁻¹,   P = F S
///
/// The last term of W is an initial hydrostatic pressure: the Cauchy stress at rest is −p_i 1 (and the term is −p_i 1
/// at any deformation). Small strain: shear modulus 2 (C₁ + C₂), bulk modulus 4 λ. NaN for J < 0.
/// The defaults are the nucleus of the paper.
struct ModifiedMooneyRivlin {
  static constexpr bool dissipative = true;  ///< no closed cycle yields work

  double density = 1000.0;        ///< ρ₀, kg/m³
  double c1 = 2126.0;             ///< C₁, Pa
  double c2 = 170.0;              ///< C₂, Pa
  double lambda = 1.7e5;          ///< λ, Pa
  double initial_pressure = 0.0;  ///< p_i, Pa; hydrostatic pressure at F = 1

  /// Throws ParameterError unless density > 0, c1 + c2 > 0, lambda > 0 and all are finite.
  void validate() const {
    require_positive("ModifiedMooneyRivlin.density", density, "kg/m^3");
    require_finite("ModifiedMooneyRivlin.c1", c1, "Pa");
    require_finite("ModifiedMooneyRivlin.c2", c2, "Pa");
    require_positive("ModifiedMooneyRivlin.c1 + ModifiedMooneyRivlin.c2", c1 + c2, "Pa");
    require_positive("ModifiedMooneyRivlin.lambda", lambda, "Pa");
    require_finite("ModifiedMooneyRivlin.initial_pressure", initial_pressure, "Pa");
  }

  /// Shear modulus at small strain, 2 (C₁ + C₂), Pa.
  [[nodiscard]] double shear_modulus() const { return 2.0 * (c1 + c2); }

  /// Bulk modulus at small strain, 4 λ, Pa.
  [[nodiscard]] double bulk_modulus() const { return 4.0 * lambda; }

  /// Speed of longitudinal waves at rest, √((K + 4 G/3)/ρ₀), m/s. The initial pressure does not enter it.
  [[nodiscard]] double wave_speed() const {
    return std::sqrt((bulk_modulus() + 4.0 / 3.0 * shear_modulus()) / density);
  }

  /// The same solid with C₁, C₂ and λ times `factor`: the paper's substrates I, II, III are ×2, ×5, ×10.
  [[nodiscard]] ModifiedMooneyRivlin scaled(double factor) const {
    ModifiedMooneyRivlin m = *this;
    m.c1 *= factor;
    m.c2 *= factor;
    m.lambda *= factor;
    return m;
  }

  /// W, J per reference volume.
  template <class T>
  [[nodiscard]] T energy(const Tensor<T>& F) const {
    using std::exp;
    using std::log;
    const Tensor<T> C = right_cauchy_green(F);
    const T J = determinant(F);
    const T log_I3 = T(2.0) * log(J);
    const T root = exp(log_I3 * T(1.0 / 3.0));  // I₃^{1/3}
    return T(c1) * (first_invariant(C) - T(3.0) * root) + T(c2) * (second_invariant(C) - T(3.0) * root * root) +
           T(0.5 * lambda) * log_I3 * log_I3 - T(initial_pressure) * (J - T(1.0));
  }

  /// P = F S = ∂W/∂F, Pa.
  template <class T>
  [[nodiscard]] Tensor<T> first_piola(const Tensor<T>& F) const {
    using std::exp;
    using std::log;
    const Tensor<T> C = right_cauchy_green(F);
    const Tensor<T> cofactors = cofactor(F);
    const T J = determinant(F, cofactors);
    const T log_I3 = T(2.0) * log(J);
    const T root = exp(log_I3 * T(1.0 / 3.0));  // I₃^{1/3}
    const T on_F = T(2.0 * c1) + T(2.0 * c2) * first_invariant(C);
    const T on_cofactors =
        -(T(2.0 * c1) * root + T(4.0 * c2) * root * root - T(2.0 * lambda) * log_I3) / J - T(initial_pressure);
    return F * on_F - (F * C) * T(2.0 * c2) + cofactors * on_cofactors;
  }
};

static_assert(Material<ModifiedMooneyRivlin>);

}  // namespace tactoid
