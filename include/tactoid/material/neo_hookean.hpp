#pragma once

#include <cmath>

#include <tactoid/core/errors.hpp>
#include <tactoid/kinematics/kinematics.hpp>
#include <tactoid/material/material.hpp>

namespace tactoid {

/// Compressible neo-Hookean solid (Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis,
/// 2nd ed., section 6.4.3), the reference law of verification and benchmarks:
///
///   W = ½ μ (I₁ − 3 − 2 ln J) + ½ λ (ln J)²,   P = μ (F − F⁻ᵀ) + λ ln J F⁻ᵀ
///
/// Small strain: the Lamé constants are λ and μ. NaN for J < 0.
struct NeoHookean {
  static constexpr bool dissipative = true;  ///< no closed cycle yields work

  double density = 1000.0;  ///< ρ₀, kg/m³
  double mu = 1.0e3;        ///< μ, shear modulus, Pa
  double lambda = 1.0e4;    ///< λ, first Lamé constant, Pa

  /// The law of Young's modulus E > 0 (Pa) and Poisson's ratio −1 < ν < ½.
  /// Throws ParameterError outside of these ranges.
  [[nodiscard]] static NeoHookean from_young(double young, double poisson, double density = 1000.0) {
    require_positive("NeoHookean.young", young, "Pa");
    if (!(poisson > -1.0 && poisson < 0.5))
      reject("NeoHookean.poisson", poisson, "", "greater than -1 and less than 0.5");
    return {.density = density,
            .mu = young / (2.0 * (1.0 + poisson)),
            .lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))};
  }

  /// Throws ParameterError unless density > 0, mu > 0 and the bulk modulus λ + 2μ/3 > 0.
  void validate() const {
    require_positive("NeoHookean.density", density, "kg/m^3");
    require_positive("NeoHookean.mu", mu, "Pa");
    require_finite("NeoHookean.lambda", lambda, "Pa");
    if (!(bulk_modulus() > 0.0)) reject("NeoHookean.lambda", lambda, "Pa", "greater than -2/3 NeoHookean.mu");
  }

  /// Shear modulus at small strain, μ, Pa.
  [[nodiscard]] double shear_modulus() const { return mu; }

  /// Bulk modulus at small strain, λ + 2μ/3, Pa.
  [[nodiscard]] double bulk_modulus() const { return lambda + 2.0 / 3.0 * mu; }

  /// Speed of longitudinal waves at rest, √((λ + 2μ)/ρ₀), m/s.
  [[nodiscard]] double wave_speed() const { return std::sqrt((lambda + 2.0 * mu) / density); }

  /// W, J per reference volume.
  template <class T>
  [[nodiscard]] T energy(const Tensor<T>& F) const {
    using std::log;
    const T log_J = log(determinant(F));
    return T(0.5 * mu) * (contract(F, F) - T(3.0) - T(2.0) * log_J) + T(0.5 * lambda) * log_J * log_J;
  }

  /// P = ∂W/∂F, Pa.
  template <class T>
  [[nodiscard]] Tensor<T> first_piola(const Tensor<T>& F) const {
    using std::log;
    const Tensor<T> cofactors = cofactor(F);
    const T J = determinant(F, cofactors);
    const T on_cofactors = (T(lambda) * log(J) - T(mu)) / J;
    return F * T(mu) + cofactors * on_cofactors;
  }
};

static_assert(Material<NeoHookean>);

}  // namespace tactoid
