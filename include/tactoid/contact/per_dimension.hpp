#pragma once

#include <utility>
#include <variant>

#include <tactoid/core/errors.hpp>

namespace tactoid {

/// Holds a T<2> or a T<3>, whichever `emplace` made: so that a contact is written without its dimension
/// (`LigandReceptor{…}`) and learns it when the simulation is composed.
template <template <int> class T>
class PerDimension {
 public:
  /// Makes a new T<D>, D = 2 or 3, in the place of what was held.
  template <int D>
  T<D>& emplace() {
    return value_.template emplace<T<D>>();
  }
  [[nodiscard]] bool empty() const { return std::holds_alternative<std::monostate>(value_); }  ///< before `emplace`

  /// Calls f with the T<D> held. Throws Error before `emplace`.
  template <class F>
  decltype(auto) visit(F&& f) {
    require_value();
    if (auto* two = std::get_if<T<2>>(&value_)) return std::forward<F>(f)(*two);
    return std::forward<F>(f)(*std::get_if<T<3>>(&value_));
  }
  /// Calls f with the T<D> held. Throws Error before `emplace`.
  template <class F>
  decltype(auto) visit(F&& f) const {
    require_value();
    if (const auto* two = std::get_if<T<2>>(&value_)) return std::forward<F>(f)(*two);
    return std::forward<F>(f)(*std::get_if<T<3>>(&value_));
  }

  /// Of what is held, where that has one.
  template <class Archive>
  void state(Archive& archive) {
    if (!empty()) visit([&](auto& held) { archive.part("held", held); });
  }

 private:
  void require_value() const {
    if (empty()) throw Error("A contact or boundary term was used before initialize() was called.");
  }
  std::variant<std::monostate, T<2>, T<3>> value_;
};

}  // namespace tactoid
