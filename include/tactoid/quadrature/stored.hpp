#pragma once

#include <type_traits>
#include <utility>

#include <tactoid/quadrature/point_table.hpp>

namespace tactoid {

/// A Quadrature like Q whose bodies store their gradients as Real, double or float: `stored_as<float>(NodalCentroids{})`.
/// In single precision the gradients take four sevenths of the memory and the bandwidth, which is what large bodies wait for; everything is still
/// computed in double precision. Gradients are rounded once, when the body is composed, by 6e-8 of their size: deformation gradients
/// are off by 1e-7, while linear momentum is kept to round-off. For explicit steps: statics and implicit steps need double.
template <class Real, class Q>
struct Stored : Q {
  static_assert(std::is_same_v<Real, float> || std::is_same_v<Real, double>, "Gradients are stored as float or as double.");
  using StoredReal = Real;  ///< of the gradients in the table
};
/// The quadrature q, with gradients stored as Real.
template <class Real, class Q>
[[nodiscard]] Stored<Real, Q> stored_as(Q q) {
  return {std::move(q)};
}

namespace detail {
template <class Q>
struct StoredReal {
  using type = double;
};
template <class Q>
  requires requires { typename Q::StoredReal; }
struct StoredReal<Q> {
  using type = typename Q::StoredReal;
};
}  // namespace detail

/// What a body with the quadrature Q keeps of a pair: TableEntry, or SingleTableEntry.
template <class Q>
using StoredEntry = std::conditional_t<std::is_same_v<typename detail::StoredReal<Q>::type, float>, SingleTableEntry, TableEntry>;

}  // namespace tactoid
