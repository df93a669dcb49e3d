#pragma once

#include <algorithm>
#include <cstddef>

namespace tactoid {

/// A string as a template argument.
template <std::size_t N>
struct FixedString {
  char text[N]{};  ///< with its final zero
  consteval FixedString(const char (&s)[N]) { std::copy_n(s, N, text); }  ///< from a literal
};

/// Always false. Written as `(requirement || unsatisfied<"sentence">)` inside a concept, it leaves the
/// concept's meaning alone, but a compiler that reports why a type fails prints the sentence.
template <FixedString Sentence>
concept unsatisfied = (Sentence.text[0] == '\0');

}  // namespace tactoid
