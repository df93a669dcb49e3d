#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <tactoid/core/tensor.hpp>
#include <tactoid/kinematics/kinematics.hpp>
#include <tactoid/material/material.hpp>
#include <tactoid/quadrature/point_table.hpp>

namespace tactoid {

/// What a body whose reference was updated (Body::update_reference) keeps of its first configuration, to which its laws, its masses and
/// its histories belong. A quadrature point that was mapped by F₀ from there to the configuration of the table, and from that by F, has
///   F F₀,   Ḟ F₀,   ∇h F₀   for its law,   and the stress P F₀ᵀ over the volume V of the first configuration.
struct EarlierConfiguration {
  Field position;                 ///< X_I in the first configuration, m; empty: the table is built on it
  std::vector<double> volume;     ///< V_q in the first configuration, m³; that of the table is V_q det F₀
  std::vector<Tensor3> gradient;  ///< F₀ of each point

  [[nodiscard]] bool empty() const { return position.empty(); }  ///< the reference was never updated
};

/// What a law is told, from what the gradients of an updated table give.
template <class T>
void refer_to_first(PointState<T>& state, const Tensor<T>& earlier) {
  state.deformation_gradient = (state.deformation_gradient * earlier).eval();
  state.deformation_rate = (state.deformation_rate * earlier).eval();
  state.director_gradient = (state.director_gradient * earlier).eval();
}

/// Smooths the volume ratio of the points [begin, end) of a region, a fluid, over the pairs of the stabilisation: J ← J̄ with
/// Σ_q V_q J̄_q = Σ_q V_q J_q, F₀ ← (J̄/J)^⅓ F₀. Pressures that alternate from point to point exert no force through the gradients under
/// which they grew, and so are not held back there; through new gradients they would.
void smooth_volume_ratio(const PointTable& table, std::size_t begin, std::size_t end, EarlierConfiguration& earlier);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/simulation/earlier_configuration.ipp>
#endif
