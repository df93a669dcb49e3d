#pragma once

#include <cmath>

#include <tactoid/core/tensor.hpp>

namespace tactoid {

// One small function per tensor. T is double, Lanes or Dual; nothing here compares or branches.
// F_iK = ∂x_i/∂X_K is the deformation gradient, J = det F, Ḟ its material rate.

/// Cofactor matrix, cof F = J F⁻ᵀ = ∂J/∂F. Defined for a singular F too.
template <class T>
[[nodiscard]] inline Tensor<T> cofactor(const Tensor<T>& F) {
  Tensor<T> c;
  c(0, 0) = F(1, 1) * F(2, 2) - F(1, 2) * F(2, 1);
  c(0, 1) = F(1, 2) * F(2, 0) - F(1, 0) * F(2, 2);
  c(0, 2) = F(1, 0) * F(2, 1) - F(1, 1) * F(2, 0);
  c(1, 0) = F(2, 1) * F(0, 2) - F(2, 2) * F(0, 1);
  c(1, 1) = F(2, 2) * F(0, 0) - F(2, 0) * F(0, 2);
  c(1, 2) = F(2, 0) * F(0, 1) - F(2, 1) * F(0, 0);
  c(2, 0) = F(0, 1) * F(1, 2) - F(0, 2) * F(1, 1);
  c(2, 1) = F(0, 2) * F(1, 0) - F(0, 0) * F(1, 2);
  c(2, 2) = F(0, 0) * F(1, 1) - F(0, 1) * F(1, 0);
  return c;
}

/// J = det F from F and its cofactors: J = F_0K (cof F)_0K.
template <class T>
[[nodiscard]] inline T determinant(const Tensor<T>& F, const Tensor<T>& cofactors) {
  return F(0, 0) * cofactors(0, 0) + F(0, 1) * cofactors(0, 1) + F(0, 2) * cofactors(0, 2);
}

/// J = det F.
template <class T>
[[nodiscard]] inline T determinant(const Tensor<T>& F) {
  return F(0, 0) * (F(1, 1) * F(2, 2) - F(1, 2) * F(2, 1)) + F(0, 1) * (F(1, 2) * F(2, 0) - F(1, 0) * F(2, 2)) +
         F(0, 2) * (F(1, 0) * F(2, 1) - F(1, 1) * F(2, 0));
}

/// What one evaluation of the cofactors gives: cof F, J and F⁻¹ = (cof F)ᵀ / J.
template <class T>
struct Inversion {
  Tensor<T> cofactors;  ///< cof F = J F⁻ᵀ
  T determinant;        ///< J
  Tensor<T> inverse;    ///< F⁻¹; not finite for J = 0
};

/// cof F, J and F⁻¹ together.
template <class T>
[[nodiscard]] inline Inversion<T> invert(const Tensor<T>& F) {
  Inversion<T> r{.cofactors = cofactor(F), .determinant = {}, .inverse = {}};  // in place: lanes are large to copy
  r.determinant = determinant(F, r.cofactors);
  const T reciprocal = T(1.0) / r.determinant;
  r.inverse = r.cofactors.transpose() * reciprocal;
  return r;
}

/// F⁻¹.
template <class T>
[[nodiscard]] inline Tensor<T> inverse(const Tensor<T>& F) {
  return invert(F).inverse;
}

/// A : B = A_ij B_ij.
template <class T>
[[nodiscard]] inline T contract(const Tensor<T>& A, const Tensor<T>& B) {
  T sum = A(0, 0) * B(0, 0);
  for (int k = 1; k < 9; ++k) sum += A(k % 3, k / 3) * B(k % 3, k / 3);
  return sum;
}

/// sym A = (A + Aᵀ)/2.
template <class T>
[[nodiscard]] inline Tensor<T> symmetric_part(const Tensor<T>& A) {
  return (A + A.transpose()) * T(0.5);
}

/// skew A = (A − Aᵀ)/2.
template <class T>
[[nodiscard]] inline Tensor<T> skew_part(const Tensor<T>& A) {
  return (A - A.transpose()) * T(0.5);
}

/// Right Cauchy–Green tensor C = Fᵀ F.
template <class T>
[[nodiscard]] inline Tensor<T> right_cauchy_green(const Tensor<T>& F) {
  return F.transpose() * F;
}

/// Left Cauchy–Green tensor b = F Fᵀ.
template <class T>
[[nodiscard]] inline Tensor<T> left_cauchy_green(const Tensor<T>& F) {
  return F * F.transpose();
}

/// Green–Lagrange strain E = (Fᵀ F − 1)/2, from H = F − 1 as sym H + HᵀH/2, which keeps small strains exact.
template <class T>
[[nodiscard]] inline Tensor<T> green_lagrange(const Tensor<T>& F) {
  const Tensor<T> H = F - Tensor<T>::Identity();
  return (H + H.transpose() + H.transpose() * H) * T(0.5);
}

/// Spatial velocity gradient L = Ḟ F⁻¹, L_ij = ∂v_i/∂x_j, 1/s.
template <class T>
[[nodiscard]] inline Tensor<T> velocity_gradient(const Tensor<T>& F_rate, const Tensor<T>& F_inverse) {
  return F_rate * F_inverse;
}

/// Rate of deformation d = sym L, 1/s.
template <class T>
[[nodiscard]] inline Tensor<T> rate_of_deformation(const Tensor<T>& L) {
  return symmetric_part(L);
}

/// Spin w = skew L = (L − Lᵀ)/2, 1/s: a vector that turns with the spin has the rate w h.
template <class T>
[[nodiscard]] inline Tensor<T> spin(const Tensor<T>& L) {
  return skew_part(L);
}

/// Nanson: n da = J F⁻ᵀ N dA. From the reference area vector to the current one.
template <class T>
[[nodiscard]] inline Vector<T> nanson(const Tensor<T>& F, const Vector<T>& reference_area) {
  return cofactor(F) * reference_area;
}

/// σ = P Fᵀ / J.
template <class T>
[[nodiscard]] inline Tensor<T> cauchy_from_piola(const Tensor<T>& P, const Tensor<T>& F) {
  const T reciprocal = T(1.0) / determinant(F);
  return (P * F.transpose()) * reciprocal;
}

/// P = J σ F⁻ᵀ = σ cof F.
template <class T>
[[nodiscard]] inline Tensor<T> piola_from_cauchy(const Tensor<T>& sigma, const Tensor<T>& F) {
  return sigma * cofactor(F);
}

/// I₁ = tr C.
template <class T>
[[nodiscard]] inline T first_invariant(const Tensor<T>& C) {
  return C(0, 0) + C(1, 1) + C(2, 2);
}

/// Upper bound of the largest eigenvalue of a symmetric tensor, exact where two eigenvalues are equal:
/// t/3 + √(2/3 (A:A − t²/3)), t = tr A.
template <class T>
[[nodiscard]] T largest_eigenvalue_bound(const Tensor<T>& A) {
  using std::sqrt, std::abs;
  const T mean = first_invariant(A) * T(1.0 / 3.0);
  return mean + sqrt(abs(contract(A, A) - mean * mean * T(3.0)) * T(2.0 / 3.0));
}

/// I₂ = ½ [(tr C)² − tr C²] = the sum of the principal minors; for a symmetric C.
template <class T>
[[nodiscard]] inline T second_invariant(const Tensor<T>& C) {
  return C(0, 0) * C(1, 1) - C(0, 1) * C(1, 0) + C(1, 1) * C(2, 2) - C(1, 2) * C(2, 1) + C(2, 2) * C(0, 0) -
         C(2, 0) * C(0, 2);
}

/// I₃ = det C = J².
template <class T>
[[nodiscard]] inline T third_invariant(const Tensor<T>& C) {
  return determinant(C);
}

/// Cauchy stress and volume ratio at a quadrature point.
struct PointSample {
  Tensor3 cauchy;  ///< Cauchy stress σ, Pa
  double J = 1.0;  ///< det F
};

/// Effective stress, Zeng and Li, Soft Matter 2012, 8, 5765, eqn (18):
/// σ_e = √½ [(σ₁−σ₂)² + (σ₂−σ₃)² + (σ₃−σ₁)²]^{1/2} of the principal Cauchy stresses, written in components.
template <class T>
[[nodiscard]] inline T effective_stress(const Tensor<T>& sigma) {
  using std::sqrt;
  const T a = sigma(0, 0) - sigma(1, 1), b = sigma(1, 1) - sigma(2, 2), c = sigma(2, 2) - sigma(0, 0);
  const T shear = sigma(0, 1) * sigma(1, 0) + sigma(1, 2) * sigma(2, 1) + sigma(2, 0) * sigma(0, 2);
  return sqrt(T(0.5) * (a * a + b * b + c * c) + T(3.0) * shear);
}

}  // namespace tactoid
