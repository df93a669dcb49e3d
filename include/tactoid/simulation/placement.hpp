#pragma once

#include <cstddef>
#include <tuple>
#include <utility>

namespace tactoid {

/// The bodies of a simulation, by number: `Bodies{cell, substrate}` are bodies 0 and 1.
template <class... B>
struct Bodies {
  std::tuple<B...> list;
  explicit Bodies(B... bodies) : list(std::move(bodies)...) {}
};

/// A contact between bodies A and B.
template <std::size_t A, std::size_t B, class C>
struct Between {
  static constexpr std::size_t first = A, second = B;
  C contact;
};
template <std::size_t A, std::size_t B, class C>
[[nodiscard]] Between<A, B, C> between(C contact) {
  static_assert(A != B, "A contact is between two different bodies.");
  return {std::move(contact)};
}

/// A boundary term or an essential condition on body I.
template <std::size_t I, class T>
struct On {
  static constexpr std::size_t body = I;
  T term;
};
template <std::size_t I, class T>
[[nodiscard]] On<I, T> on(T term) {
  return {std::move(term)};
}

/// `Contacts{between<0, 1>(LigandReceptor{}), …}`; may be empty.
template <class... C>
struct Contacts {
  std::tuple<C...> list;
  explicit Contacts(C... contacts) : list(std::move(contacts)...) {}
};

/// `Boundaries{on<0>(SurfaceTension{}), on<1>(fixed(bottom)), …}`; may be empty.
template <class... B>
struct Boundaries {
  std::tuple<B...> list;
  explicit Boundaries(B... terms) : list(std::move(terms)...) {}
};

}  // namespace tactoid
