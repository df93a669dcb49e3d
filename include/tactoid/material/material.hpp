#pragma once

#include <concepts>
#include <type_traits>

#include <tactoid/core/dual.hpp>
#include <tactoid/core/lanes.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/core/unsatisfied.hpp>

namespace tactoid {

/// What a law is told about a quadrature point (or about several, T = Lanes).
template <class T>
struct PointState {
  Tensor<T> deformation_gradient = Tensor<T>::Identity();  ///< F_iK = ∂x_i/∂X_K
  Tensor<T> deformation_rate = Tensor<T>::Zero();          ///< Ḟ, 1/s
  Vector<T> director = Vector<T>::Zero();                  ///< h at the point
  Tensor<T> director_gradient = Tensor<T>::Zero();         ///< ∇₀h, h_{k,K} = ∂h_k/∂X_K, 1/m
  double time_step = 0.0;                                  ///< time since the history was last advanced, s
};

/// What a law answers, per reference volume.
template <class T>
struct Response {
  Tensor<T> stress = Tensor<T>::Zero();  ///< first Piola–Kirchhoff stress P_iK, Pa
  T energy = T(0.0);                     ///< stored energy, J/m³
  T dissipated_power = T(0.0);           ///< power of the stresses that dissipate (viscosity, Yang's branch), W/m³
  T active_power = T(0.0);               ///< power that stresses without an energy give to the motion (activity,
                                         ///< director gradients), W/m³
};

/// History of a law without memory.
template <class T>
struct NoHistory {};

namespace detail {
template <class M>
concept HasEnergy = requires(const M& m, const Tensor<double>& F, const Tensor<Dual<double, 9>>& G) {
  { m.energy(F) } -> std::convertible_to<double>;
  { m.energy(G) } -> std::same_as<Dual<double, 9>>;  // a double would convert: the law is then not generic
};
template <class M>
concept HasStress = requires(const M& m, const Tensor<double>& F) {
  { m.first_piola(F) } -> std::convertible_to<Tensor<double>>;
};
template <class M, class = void>
struct HistoryOf {
  template <class T>
  using type = NoHistory<T>;
};
template <class M>
struct HistoryOf<M, std::void_t<typename M::template History<double>>> {
  template <class T>
  using type = typename M::template History<T>;
};
template <class M>
concept HasResponse = requires(const M& m, const PointState<double>& p, typename HistoryOf<M>::template type<double>& h) {
  { m.response(p, h) } -> std::convertible_to<Response<double>>;
};
}  // namespace detail

/// The variables that a law keeps at each point from step to step; NoHistory where it keeps none.
template <class M, class T>
using HistoryOf = typename detail::HistoryOf<M>::template type<T>;

/// A point-wise constitutive law.
///
/// A law is a plain struct of parameters, generic over its scalar T (double, Lanes, Dual). It has
///   double density;             kg/m³ in the reference configuration
///   double wave_speed() const;  m/s, fastest elastic wave at rest: sets the stable time step
/// and one of, from the least to the most that it can do:
///   T energy(const Tensor<T>& F) const;                 J per reference volume; the stress is its derivative,
///                                                       by automatic differentiation
///   Tensor<T> first_piola(const Tensor<T>& F) const;    with energy(F) beside it: the stress written by hand
///   template <class T> struct History { ... };          variables kept at the point (optional); default = at rest
///   Response<T> response(const PointState<T>&, History<T>&) const;   anything else: rates, memory, director.
///                                                       Advances the history by PointState::time_step.
/// and, where they apply,
///   void validate() const;                 throws ParameterError; called when a body is composed
///   static constexpr bool uses_rate;       true: needs Ḟ (default false)
///   static constexpr bool uses_director;   true: needs the director (default false)
///   double viscosity_modulus() const;      Pa·s, the viscous counterpart of ρ c²: limits the time step (default 0)
///   double shear_modulus() const;          Pa, scale of the stabilisation in solids (default 0)
///
/// A law never allocates, never throws inside response, and gives NaN where it is not defined (J ≤ 0).
template <class M>
concept Material =
    (requires(const M& m) {
      { m.density } -> std::convertible_to<double>;
    } || unsatisfied<"A Material has a member `double density` (kg/m^3, reference configuration).">) &&
    (requires(const M& m) {
      { m.wave_speed() } -> std::convertible_to<double>;
    } || unsatisfied<"A Material has `double wave_speed() const` (m/s): it sets the stable time step.">) &&
    (detail::HasResponse<M> || detail::HasEnergy<M> ||
     unsatisfied<"A Material has `T energy(const Tensor<T>& F) const`, generic over its scalar T, or `Response<T> "
                 "response(const PointState<T>&, History<T>&) const`.">);

/// Whether the law M says that it needs Ḟ.
template <class M>
inline constexpr bool uses_rate = [] {
  if constexpr (requires { M::uses_rate; }) return bool(M::uses_rate);
  else return false;
}();

/// Whether the law M says that it needs the director.
template <class M>
inline constexpr bool uses_director = [] {
  if constexpr (requires { M::uses_director; }) return bool(M::uses_director);
  else return false;
}();

/// A Material whose stress depends on the director; the body must then carry a director field.
template <class M>
concept DirectorMaterial =
    Material<M> &&
    (uses_director<M> || unsatisfied<"A DirectorMaterial says `static constexpr bool uses_director = true`.">);

/// What a law says of its viscosity (the longitudinal modulus, Pa·s); 0 where it says nothing.
template <class M>
[[nodiscard]] double viscosity_modulus(const M& m) {
  if constexpr (requires { { m.viscosity_modulus() } -> std::convertible_to<double>; }) return m.viscosity_modulus();
  else return 0.0;
}

/// What a law says of its shear modulus at small strain, Pa; 0 where it says nothing: then it counts as a fluid.
template <class M>
[[nodiscard]] double shear_modulus(const M& m) {
  if constexpr (requires { { m.shear_modulus() } -> std::convertible_to<double>; }) return m.shear_modulus();
  else return 0.0;
}

/// First Piola–Kirchhoff stress of an energy: P = ∂W/∂F by forward differentiation.
template <class M, class T>
[[nodiscard]] Tensor<T> stress_of_energy(const M& material, const Tensor<T>& F) {
  Tensor<Dual<T, 9>> G;
  for (int i = 0; i < 3; ++i)
    for (int K = 0; K < 3; ++K) G(i, K) = Dual<T, 9>::variable(F(i, K), 3 * i + K);
  const Dual<T, 9> W = material.energy(G);
  Tensor<T> P;
  for (int i = 0; i < 3; ++i)
    for (int K = 0; K < 3; ++K) P(i, K) = W.derivative[static_cast<std::size_t>(3 * i + K)];
  return P;
}

/// Evaluates any Material: the one call through which the library uses a law.
template <class M, class T>
[[nodiscard]] Response<T> respond(const M& material, const PointState<T>& point, HistoryOf<M, T>& history) {
  if constexpr (detail::HasResponse<M>) {
    return material.response(point, history);
  } else {
    const Tensor<T>& F = point.deformation_gradient;
    if constexpr (detail::HasStress<M>) return {.stress = material.first_piola(F), .energy = material.energy(F)};
    else return {.stress = stress_of_energy(material, F), .energy = material.energy(F)};
  }
}

}  // namespace tactoid
