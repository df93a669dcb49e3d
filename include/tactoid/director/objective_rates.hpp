#pragma once

#include <tactoid/core/tensor.hpp>
#include <tactoid/director/director.hpp>
#include <tactoid/kinematics/kinematics.hpp>

namespace tactoid {

/// Corotational rate D̃h/Dt = Dh/Dt − w h, w = skew L: the director turns with the spin and keeps its length. Eqn (10).
struct Corotational {
  /// A = w = skew L, 1/s.
  template <class T>
  [[nodiscard]] static Tensor<T> rate_operator(const Tensor<T>& L) {
    return spin(L);
  }
};

/// Convected rate D̃h/Dt = Dh/Dt + Lᵀ h: the director is carried as the gradient of a material function (h = F⁻ᵀ h₀
/// without relaxation), so it shrinks under stretch along it. Eqn (10).
struct Convected {
  /// A = −Lᵀ, 1/s.
  template <class T>
  [[nodiscard]] static Tensor<T> rate_operator(const Tensor<T>& L) {
    return L.transpose() * T(-1.0);
  }
};

static_assert(ObjectiveRate<Corotational> && ObjectiveRate<Convected>);

}  // namespace tactoid
