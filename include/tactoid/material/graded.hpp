#pragma once

#include <concepts>
#include <type_traits>

#include <tactoid/core/tensor.hpp>
#include <tactoid/core/unsatisfied.hpp>
#include <tactoid/material/material.hpp>

namespace tactoid {

/// A function of the reference position that gives the law there.
template <class F>
concept MaterialAtPosition =
    (std::invocable<const F&, const Vector3&> ||
     unsatisfied<"Graded takes a function of the reference position, called with `const Vector3& X` (m).">) &&
    (Material<std::remove_cvref_t<std::invoke_result_t<const F&, const Vector3&>>> ||
     unsatisfied<"The function given to Graded returns a Material.">);

/// A material whose parameters, any of them, depend on the reference position:
///
///   Graded{[](const Vector3& X) { return ModifiedMooneyRivlin{}.scaled(2.0 + X.x() / 1.0e-5); }}
///
/// It is evaluated once per quadrature point, when a body is composed; each law that it returns is validated then.
template <MaterialAtPosition F>
struct Graded {
  using Law = std::remove_cvref_t<std::invoke_result_t<const F&, const Vector3&>>;  ///< what the function returns

  F law_at;  ///< X (m, three components in every dimension) -> law

  /// The law at the reference position X, m.
  [[nodiscard]] Law at(const Vector3& X) const { return law_at(X); }
};

/// True for a Graded material.
template <class>
inline constexpr bool is_graded = false;
/// Of Graded itself.
template <class F>
inline constexpr bool is_graded<Graded<F>> = true;

/// What a region of a body can be made of: one law, or a graded one.
template <class M>
concept MaterialSource = is_graded<M> || Material<M>;

namespace detail {
template <class M>
struct LawOf {
  using type = M;
};
template <class F>
struct LawOf<Graded<F>> {
  using type = typename Graded<F>::Law;
};
}  // namespace detail

/// The law of a material, graded or not.
template <MaterialSource M>
using LawOf = typename detail::LawOf<M>::type;

/// The law at the reference position X, m: M itself where it is not graded.
template <MaterialSource M>
[[nodiscard]] LawOf<M> material_at(const M& material, [[maybe_unused]] const Vector3& X) {
  if constexpr (is_graded<M>) return material.at(X);
  else return material;
}

}  // namespace tactoid
