#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <tactoid/core/tensor.hpp>

namespace tactoid {

namespace detail {
/// Of the pages in [first, last), those that hold nothing else.
void give_back_pages(std::byte* first, std::byte* last);
}  // namespace detail

/// Gives memory that was released, but that the C library keeps for later, back to the system (where it is glibc): to be called where much less is needed from now on.
void give_back_released();

/// Gives the memory of elements that are not used back to the system, in whole pages. Their values are lost, and they take memory again when they are written to. Systems that cannot (all
/// but Linux) keep it. `used`: numbers of elements, ascending.
template <class T>
void give_back_unused(std::vector<T>& values, std::span<const Index> used) {
  auto* const bytes = reinterpret_cast<std::byte*>(values.data());
  std::size_t next = 0;  // the first element of which nothing is known
  for (const Index i : used) {
    if (i >= values.size()) break;
    if (i > next) detail::give_back_pages(bytes + next * sizeof(T), bytes + i * sizeof(T));
    next = std::size_t{i} + 1;
  }
  if (next < values.size()) detail::give_back_pages(bytes + next * sizeof(T), bytes + values.size() * sizeof(T));
}

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/core/pages.ipp>
#endif
