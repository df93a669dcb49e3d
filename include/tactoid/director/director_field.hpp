#pragma once

#include <tactoid/core/errors.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/director/director.hpp>
#include <tactoid/director/ginzburg_landau.hpp>
#include <tactoid/director/objective_rates.hpp>
#include <tactoid/kinematics/kinematics.hpp>

namespace tactoid {

/// The laws of the director field: Zeng and Li, Soft Matter 2012, 8, 5765, eqns (2), (3), (10), divided by ρᵈ:
///   Dh/Dt = A(L) h + (γ/ρᵈ) {∇²h − r(h)}
/// ρᵈ is a density: J ρᵈ, per reference volume, does not change. D = γ/ρᵈ at J = 1, so a body has γ/ρᵈ = D J.
template <ObjectiveRate Rate = Corotational>
struct DirectorField {
  using rate = Rate;  ///< Corotational, Convected, or an own one

  double diffusivity = 1.0e-7;  ///< D = γ/ρᵈ at J = 1, m²/s
  double core_size = 0.5e-6;    ///< ε_d, m: the size of a defect's core

  /// Throws ParameterError unless diffusivity >= 0 and core_size > 0, both finite.
  void validate() const {
    require_non_negative("DirectorField.diffusivity", diffusivity, "m^2/s");
    require_positive("DirectorField.core_size", core_size, "m");
  }

  /// A of Dh/Dt = A h + relaxation, 1/s.
  template <class T>
  [[nodiscard]] static Tensor<T> rate_operator(const Tensor<T>& L) {
    return Rate::rate_operator(L);
  }

  /// Local source −D r(h), 1/s.
  template <class T>
  [[nodiscard]] Vector<T> source(const Vector<T>& h) const {
    return ginzburg_landau(h, core_size) * T(-diffusivity);
  }

  /// Diffusive flux in the reference configuration D ∇₀h C⁻¹, m/s, from F⁻¹ and ∇₀h (1/m). In the weak form it stands with
  /// a factor J: −Σ_q V_q J (D ∇₀h C⁻¹) G_qI is V_I times the relaxation D J ∇²h of Dh/Dt.
  template <class T>
  [[nodiscard]] Tensor<T> flux(const Tensor<T>& F_inverse, const Tensor<T>& director_gradient) const {
    return (director_gradient * (F_inverse * F_inverse.transpose())) * T(diffusivity);
  }

  /// Time step below which the penalty alone is stable explicitly, ε_d²/D, s (infinite for D = 0).
  [[nodiscard]] double penalty_time_step() const { return core_size * core_size / diffusivity; }
};

/// One step of Dh/Dt = A h + s by the Cayley transform, h ← (1 − ½Δt A)⁻¹ {(1 + ½Δt A) h + Δt s}: of second order in
/// Δt for a constant s, and of exactly constant |h| for a skew A and s = 0, for steps of any size.
template <class T>
[[nodiscard]] inline Vector<T> cayley_update(const Tensor<T>& A, const Vector<T>& h, double time_step,
                                             const Vector<T>& source) {
  const Tensor<T> half = A * T(0.5 * time_step);
  const Tensor<T> implicit = Tensor<T>::Identity() - half;
  const Vector<T> explicit_part = h + half * h + source * T(time_step);
  return inverse(implicit) * explicit_part;
}

}  // namespace tactoid
