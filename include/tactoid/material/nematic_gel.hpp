#pragma once

#include <cmath>

#include <tactoid/core/errors.hpp>
#include <tactoid/kinematics/kinematics.hpp>
#include <tactoid/material/equation_of_state.hpp>
#include <tactoid/material/material.hpp>

namespace tactoid {

/// Active nematic gel, the cytoplasm: Zeng and Li, Soft Matter 2012, 8, 5765, eqn (4).
///
///   σ = −p 1 + 2 μ d − η (∇h)ᵀ(∇h) − ζ h⊗h,   ((∇h)ᵀ(∇h))_ij = h_{k,i} h_{k,j},   ∇h = ∇₀h F⁻¹,   P = J σ F⁻ᵀ
///
/// ζ < 0 is contractile: tension along h. The equation of state p(J) is a policy, since the paper gives none.
///
/// Response.energy is the energy of p alone. Response.dissipated_power = J 2μ d:d ≥ 0. The stresses
/// −η (∇h)ᵀ(∇h) − ζ h⊗h have no energy here; Response.active_power = −P_active : Ḟ is the power that they give to the
/// motion (> 0 when they drive it: a contractile gel that shortens along h), so that
///   d/dt (kinetic + energy) = power of the external forces + active_power − dissipated_power.
///
/// Where J ≤ 0 the stress is meaningless: the energy is NaN for J < 0, the stress is not finite for J = 0.
template <EquationOfState State = ReciprocalPressure>
struct NematicGel {
  static constexpr bool uses_rate = true;    ///< needs Ḟ
  static constexpr bool uses_director = true;  ///< needs h and ∇₀h
  static constexpr bool dissipative = true;  ///< no closed cycle yields work (activity apart)

  double density = 1000.0;               ///< ρ₀, kg/m³
  double viscosity = 0.003;              ///< μ, Pa·s
  double bulk_modulus = 6.8e5;           ///< K, Pa
  double reference_pressure = 28.8;      ///< p_ref, Pa: gauge pressure at rest; 2σ₀/R holds a suspended sphere
  double director_elasticity = 1.0e-12;  ///< η, N
  double activity = -1.0;                ///< ζ, Pa; < 0 contractile

  /// Throws ParameterError unless density, bulk_modulus > 0, viscosity, director_elasticity >= 0, and all are finite.
  void validate() const {
    require_positive("NematicGel.density", density, "kg/m^3");
    require_non_negative("NematicGel.viscosity", viscosity, "Pa s");
    require_positive("NematicGel.bulk_modulus", bulk_modulus, "Pa");
    require_finite("NematicGel.reference_pressure", reference_pressure, "Pa");
    require_non_negative("NematicGel.director_elasticity", director_elasticity, "N");
    require_finite("NematicGel.activity", activity, "Pa");
  }

  /// Speed of sound at rest, √(K/ρ₀), m/s.
  [[nodiscard]] double wave_speed() const { return std::sqrt(bulk_modulus / density); }

  /// Longitudinal viscous modulus, Pa·s: 2 d is not deviatoric, so a uniaxial rate d₁₁ gives σ₁₁ = 2 μ d₁₁.
  [[nodiscard]] double viscosity_modulus() const { return 2.0 * viscosity; }

  /// Pressure p at the volume ratio J, Pa.
  template <class T>
  [[nodiscard]] T pressure(const T& J) const {
    return State::pressure(J, reference_pressure, bulk_modulus);
  }

  /// P = J σ F⁻ᵀ, the energy of p, 2 μ J d:d and the active power, at one point or several; eqn (4).
  template <class T>
  [[nodiscard]] Response<T> response(const PointState<T>& point, NoHistory<T>&) const {
    const Inversion<T> F = invert(point.deformation_gradient);
    const T& J = F.determinant;
    const Tensor<T> d = rate_of_deformation(velocity_gradient(point.deformation_rate, F.inverse));
    const Tensor<T> G = point.director_gradient * F.inverse;  // h_{k,i}
    const Vector<T>& h = point.director;

    const Tensor<T> active =
        ((G.transpose() * G) * T(director_elasticity) + (h * h.transpose()) * T(activity)) * T(-1.0);
    Tensor<T> sigma = active + d * T(2.0 * viscosity);
    const T p = pressure(J);
    for (int i = 0; i < 3; ++i) sigma(i, i) -= p;

    Response<T> r;
    r.stress = sigma * F.cofactors;  // J σ F⁻ᵀ
    r.energy = State::energy(J, reference_pressure, bulk_modulus);
    r.dissipated_power = J * T(2.0 * viscosity) * contract(d, d);
    r.active_power = -(J * contract(active, d));  // P_active : Ḟ = J σ_active : d
    return r;
  }
};

static_assert(DirectorMaterial<NematicGel<>> && DirectorMaterial<NematicGel<LogarithmicPressure>>);

}  // namespace tactoid
