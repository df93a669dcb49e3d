#pragma once

#include <cstddef>
#include <tuple>
#include <utility>

namespace tactoid {

/// The bodies of a simulation, by number: `Bodies{cell, substrate}` are bodies 0 and 1.
template <class... B>
struct Bodies {
  std::tuple<B...> list;                                        ///< of any types, in order
  explicit Bodies(B... bodies) : list(std::move(bodies)...) {}  ///< takes them over
};

/// A contact between bodies A and B.
template <std::size_t A, std::size_t B, class C>
struct Between {
  static constexpr std::size_t first = A;   ///< number of the body that the contact calls A
  static constexpr std::size_t second = B;  ///< number of the body that it calls B
  C contact;  ///< satisfies Contact
};
/// Places a contact: `between<0, 1>(LigandReceptor{})`. The order matters where a contact does not treat both bodies
/// alike (VanDerWaals).
template <std::size_t A, std::size_t B, class C>
[[nodiscard]] Between<A, B, C> between(C contact) {
  static_assert(A != B, "A contact is between two different bodies.");
  return {std::move(contact)};
}

/// A boundary term or an essential condition on body I.
template <std::size_t I, class T>
struct On {
  static constexpr std::size_t body = I;  ///< number of the body
  T term;                                 ///< satisfies BoundaryTerm, or is a PrescribedMotion
};
/// Places a term or a condition: `on<0>(SurfaceTension{})`, `on<1>(fixed(bottom))`.
template <std::size_t I, class T>
[[nodiscard]] On<I, T> on(T term) {
  return {std::move(term)};
}

/// `Contacts{between<0, 1>(LigandReceptor{}), …}`; may be empty.
template <class... C>
struct Contacts {
  std::tuple<C...> list;                                              ///< Between, of any contacts
  explicit Contacts(C... contacts) : list(std::move(contacts)...) {}  ///< takes them over
};

/// `Boundaries{on<0>(SurfaceTension{}), on<1>(fixed(bottom)), …}`; may be empty.
template <class... B>
struct Boundaries {
  std::tuple<B...> list;                                          ///< On, of any terms and conditions
  explicit Boundaries(B... terms) : list(std::move(terms)...) {}  ///< takes them over
};

}  // namespace tactoid
