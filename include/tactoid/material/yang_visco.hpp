#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/unsatisfied.hpp>
#include <tactoid/kinematics/kinematics.hpp>
#include <tactoid/material/material.hpp>
#include <tactoid/material/modified_mooney_rivlin.hpp>

namespace tactoid {

/// The invariant I in the bracket [A₁ + A₂ (I − 3)] of Yang's branch.
///
/// static T of(const Tensor<T>& C);      I of a symmetric C, for T = double, Lanes, Dual
/// static constexpr double at_rest;      I at C = 1
template <class I>
concept BracketInvariant =
    (requires(const Tensor<double>& C) {
      { I::of(C) } -> std::same_as<double>;
    } || unsatisfied<"A BracketInvariant has `static T of(const Tensor<T>& C)`.">) &&
    (requires {
      { I::at_rest } -> std::convertible_to<double>;
    } || unsatisfied<"A BracketInvariant has `static constexpr double at_rest`, its value at C = 1.">);

/// I = I₃, as Zeng and Li print it. At rest I₃ = 1, so the bracket is A₁ − 2 A₂, and it changes with volume only.
struct ThirdInvariant {
  static constexpr double at_rest = 1.0;  ///< of I₃
  /// I₃ = det C.
  template <class T>
  [[nodiscard]] static T of(const Tensor<T>& C) {
    return third_invariant(C);
  }
};

/// I = I₂, as in Yang, Shim and Lim, Int. J. Impact Eng. 2000, 24, 545. At rest I₂ = 3, so the bracket is A₁, and it
/// grows with shear and stretch too.
struct SecondInvariant {
  static constexpr double at_rest = 3.0;  ///< of I₂
  /// I₂ = ½ [(tr C)² − tr C²].
  template <class T>
  [[nodiscard]] static T of(const Tensor<T>& C) {
    return second_invariant(C);
  }
};

/// Visco-hyperelastic solid of Yang, Shim and Lim, the substrate: Zeng and Li, Soft Matter 2012, 8, 5765, eqn (8).
///
///   σ = J⁻¹ F S Fᵀ + F Q Fᵀ,   Q(t) = ∫₀ᵗ [A₁ + A₂ (I − 3)] e^{−(t−τ)/A₃} Ė(τ) dτ,   P = F S + J F Q
///
/// (the viscous stress carries no 1/J, as printed). S is the second Piola–Kirchhoff stress of `elastic`. The history is
/// advanced exactly for a constant strain rate within the step, with the bracket at the strain (Eₙ + Eₙ₊₁)/2:
///
///   Q ← e^{−Δt/A₃} Q + [A₁ + A₂ (I − 3)]_{n+½} (A₃/Δt)(1 − e^{−Δt/A₃}) ΔE
///
/// Δt = 0 is the sudden step: Q does not decay and gains [..] ΔE.
///
/// *The invariant.* The paper prints I = I₃; the law's source has I = I₂. The default is I₃. With the paper's constants
/// (A₁ = 3.5 MPa, A₂ = 0.83 MPa) the branch at rest is 1.84 MPa stiff with I₃ and 3.5 MPa with I₂: with I₂ waves are
/// faster and the stable step shorter, both by up to √(3.5/1.84) = 1.4; and in shear at constant volume the bracket
/// stays constant with I₃ but grows with I₂. In uniaxial compression it falls with both.
///
/// Q has no energy: Response.energy is that of `elastic`, and Response.dissipated_power = (J F Q) : Ḟ is the stress
/// power of the branch (negative while it gives back what it has stored): the work that it takes is accounted for. The
/// law as printed does not guarantee that a cycle takes work: in cycles of large strain (0.45) and much faster than A₃,
/// with the paper's constants, a net gain of 0.4 % (I₃) or 2 % (I₂) of the work turned over occurs (material gate).
/// a1 = a2 = 0 is the purely elastic solid.
template <Material Elastic = ModifiedMooneyRivlin, BracketInvariant Invariant = ThirdInvariant>
  requires(detail::HasEnergy<Elastic> ||
           unsatisfied<"The elastic part of YangVisco has `T energy(const Tensor<T>& F) const`.">)
struct YangVisco {
  static constexpr bool uses_rate = true;  ///< the stress power of the branch needs Ḟ

  Elastic elastic = {};              ///< the hyperelastic part
  double a1 = 3.5e6;                 ///< A₁, Pa
  double a2 = 8.3e5;                 ///< A₂, Pa
  double a3 = 5.0e-6;                ///< A₃, relaxation time, s
  double density = elastic.density;  ///< ρ₀, kg/m³: that of `elastic`, once and for all

  /// Six components (00, 11, 22, 12, 02, 01) of a symmetric tensor.
  template <class T>
  using Symmetric = Eigen::Matrix<T, 6, 1>;

  /// What a point keeps: the branch and the strain up to which it has come.
  template <class T>
  struct History {
    Symmetric<T> branch = Symmetric<T>::Zero();  ///< Q, Pa
    Symmetric<T> strain = Symmetric<T>::Zero();  ///< E at the end of the last step
  };

  /// Throws ParameterError unless a1, a2 are finite, a3 > 0, `density` is that of `elastic`, `elastic` is valid, and
  /// the bracket at rest is not negative.
  void validate() const {
    if constexpr (requires { elastic.validate(); }) elastic.validate();
    require_positive("YangVisco.density", density, "kg/m^3");
    if (density != elastic.density) reject("YangVisco.density", density, "kg/m^3", "that of YangVisco.elastic");
    require_finite("YangVisco.a1", a1, "Pa");
    require_finite("YangVisco.a2", a2, "Pa");
    require_positive("YangVisco.a3", a3, "s");
    require_non_negative("YangVisco: A1 + A2 (I - 3) at rest", bracket_at_rest(), "Pa");
  }

  /// [A₁ + A₂ (I − 3)] at rest, Pa: A₁ − 2 A₂ for I₃, A₁ for I₂. The modulus of Q = bracket · E in a sudden strain.
  [[nodiscard]] double bracket_at_rest() const { return a1 + a2 * (Invariant::at_rest - 3.0); }

  /// Shear modulus of a sudden strain at rest, Pa: the elastic one and half of the bracket.
  [[nodiscard]] double shear_modulus() const { return tactoid::shear_modulus(elastic) + 0.5 * bracket_at_rest(); }

  /// Speed of longitudinal waves at rest, m/s: P-wave modulus of `elastic` + the bracket, which acts before it relaxes.
  [[nodiscard]] double wave_speed() const {
    const double c = elastic.wave_speed();
    return std::sqrt(c * c + std::max(0.0, bracket_at_rest()) / density);
  }

  /// Advances the history by PointState::time_step to F, and answers P = F S + J F Q, the energy of `elastic`, and
  /// the stress power of the branch.
  template <class T>
  [[nodiscard]] Response<T> response(const PointState<T>& point, History<T>& history) const {
    const Tensor<T>& F = point.deformation_gradient;
    advance(green_lagrange(F), point.time_step, history);

    const T J = determinant(F);
    const Tensor<T> branch = (F * unpack(history.branch)) * J;  // J F Q

    Response<T> r;
    if constexpr (detail::HasStress<Elastic>) r.stress = elastic.first_piola(F) + branch;
    else r.stress = stress_of_energy(elastic, F) + branch;
    r.energy = elastic.energy(F);
    r.dissipated_power = contract(branch, point.deformation_rate);
    return r;
  }

  /// Advances the history by the time step (s, >= 0) to the strain E.
  template <class T>
  void advance(const Tensor<T>& E, double time_step, History<T>& history) const {
    const double x = time_step / a3;
    const double decay = std::exp(-x);
    const double mean = x > 0.0 ? -std::expm1(-x) / x : 1.0;  // (A₃/Δt)(1 − e^{−Δt/A₃})

    const Symmetric<T> strain = pack(E);
    const Symmetric<T> twice_mid = strain + history.strain;
    const Tensor<T> C_mid = Tensor<T>::Identity() + unpack(twice_mid);
    const T bracket = T(a1 - 3.0 * a2) + T(a2) * Invariant::of(C_mid);
    history.branch = history.branch * T(decay) + (strain - history.strain) * (bracket * T(mean));
    history.strain = strain;
  }

 private:
  template <class T>
  static Symmetric<T> pack(const Tensor<T>& A) {
    Symmetric<T> s;
    s(0) = A(0, 0), s(1) = A(1, 1), s(2) = A(2, 2), s(3) = A(1, 2), s(4) = A(0, 2), s(5) = A(0, 1);
    return s;
  }
  template <class T>
  static Tensor<T> unpack(const Symmetric<T>& s) {
    Tensor<T> A;
    A(0, 0) = s(0), A(1, 1) = s(1), A(2, 2) = s(2);
    A(1, 2) = A(2, 1) = s(3), A(0, 2) = A(2, 0) = s(4), A(0, 1) = A(1, 0) = s(5);
    return A;
  }
};

static_assert(Material<YangVisco<>> && Material<YangVisco<ModifiedMooneyRivlin, SecondInvariant>>);

}  // namespace tactoid
