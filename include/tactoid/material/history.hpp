#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

#include <tactoid/material/material.hpp>

namespace tactoid {

// A History<T> holds nothing but scalars T: single ones, arrays, Vectors or Tensors of T. So it can be read as a row
// of scalars, in the same order for every T; that is how histories are packed into lanes and given derivatives.

/// Number of scalars in the history of the law M; 0 for a law without memory.
template <class M>
inline constexpr std::size_t history_size =
    std::is_empty_v<HistoryOf<M, double>> ? 0 : sizeof(HistoryOf<M, double>) / sizeof(double);

/// The history of the law M as a row of history_size<M> scalars.
template <class M, class T>
[[nodiscard]] T* history_scalars(HistoryOf<M, T>& history) {
  static_assert(std::is_empty_v<HistoryOf<M, T>> || sizeof(HistoryOf<M, T>) == history_size<M> * sizeof(T),
                "A law's History<T> must hold scalars T only (single ones, arrays, Vectors, Tensors).");
  return reinterpret_cast<T*>(std::addressof(history));
}

/// The same history with another scalar: every scalar of type T is converted to U.
template <class M, class U, class T>
[[nodiscard]] HistoryOf<M, U> convert_history(const HistoryOf<M, T>& history) {
  HistoryOf<M, T> source = history;
  HistoryOf<M, U> target;
  if constexpr (history_size<M> > 0) {
    const T* from = history_scalars<M, T>(source);
    U* to = history_scalars<M, U>(target);
    for (std::size_t i = 0; i < history_size<M>; ++i) to[i] = U(from[i]);
  }
  return target;
}

}  // namespace tactoid
