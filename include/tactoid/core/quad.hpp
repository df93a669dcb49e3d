#pragma once

/// Four doubles that the hot loops keep in a register: the vector types of g++ and clang++, which become one register with
/// AVX, and two or four narrower ones without. Arithmetic, also with a number (`2.0 * a`), and `a[i]` come with the type;
/// a product that is added becomes one instruction where the machine has it.
namespace tactoid {

/// Four doubles, 32 bytes.
using Quad [[gnu::vector_size(32)]] = double;

namespace detail {
/// A Quad as it lies in memory: anywhere where doubles may lie, and part of whatever object.
using QuadInMemory [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;
}  // namespace detail

/// Four doubles from p on.
[[gnu::always_inline]] inline const detail::QuadInMemory& quad(const double* p) { return *reinterpret_cast<const detail::QuadInMemory*>(p); }
/// The same to assign to.
[[gnu::always_inline]] inline detail::QuadInMemory& quad(double* p) { return *reinterpret_cast<detail::QuadInMemory*>(p); }

/// Rows become columns: a[i] of the four become the new a, and so on.
[[gnu::always_inline]] inline void transpose(Quad& a, Quad& b, Quad& c, Quad& d) {
  const Quad ab_low = __builtin_shufflevector(a, b, 0, 4, 2, 6), ab_high = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Quad cd_low = __builtin_shufflevector(c, d, 0, 4, 2, 6), cd_high = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

}  // namespace tactoid
