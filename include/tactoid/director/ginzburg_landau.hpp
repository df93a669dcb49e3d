#pragma once

#include <tactoid/core/tensor.hpp>

namespace tactoid {

// Penalty that keeps |h| near 1: Zeng and Li, Soft Matter 2012, 8, 5765, eqn (3). A wall between h and −h has the
// profile tanh(x / (√2 ε_d)).

/// R(h) = (|h|² − 1)² / (4 ε_d²), 1/m²; core_size = ε_d, m.
template <class T>
[[nodiscard]] inline T ginzburg_landau_energy(const Vector<T>& h, double core_size) {
  const T excess = h(0) * h(0) + h(1) * h(1) + h(2) * h(2) - T(1.0);
  return T(0.25 / (core_size * core_size)) * excess * excess;
}

/// r(h) = dR/dh = (|h|² − 1) h / ε_d², 1/m².
template <class T>
[[nodiscard]] inline Vector<T> ginzburg_landau(const Vector<T>& h, double core_size) {
  const T excess = h(0) * h(0) + h(1) * h(1) + h(2) * h(2) - T(1.0);
  return h * (excess * T(1.0 / (core_size * core_size)));
}

}  // namespace tactoid
