#pragma once

#include <concepts>

#include <tactoid/core/tensor.hpp>
#include <tactoid/core/unsatisfied.hpp>

namespace tactoid {

/// How the motion carries the director: Zeng and Li, Soft Matter 2012, 8, 5765, eqns (2) and (10).
///
/// The balance ρᵈ D̃h/Dt = γ {∇²h − r(h)} holds for an objective rate D̃h/Dt = Dh/Dt − A h, so that
///   Dh/Dt = A h + (γ/ρᵈ) {∇²h − r(h)},
/// and a rate is known by its operator A, linear in the velocity gradient L = Ḟ F⁻¹ (1/s):
///   static Tensor<T> rate_operator(const Tensor<T>& L);     for T = double, Lanes, Dual
/// For a rigid spin (L skew) A must be L. It is called once per point and step, and never allocates or throws.
template <class R>
concept ObjectiveRate = requires(const Tensor<double>& L) {
  { R::rate_operator(L) } -> std::convertible_to<Tensor<double>>;
} || unsatisfied<"An ObjectiveRate has `static Tensor<T> rate_operator(const Tensor<T>& L)`: the A(L) of Dh/Dt = A h + "
                 "relaxation.">;

}  // namespace tactoid
