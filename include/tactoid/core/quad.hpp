#pragma once

#include <cstdint>
#include <cstring>

#ifdef __AVX2__
#include <immintrin.h>
#endif

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

/// Three floats and a number, 16 aligned bytes, as three doubles and that number, 32 aligned bytes.
inline void widen(const void* from, void* to) {
#ifdef __AVX2__  // g++ makes more than twice as many instructions of the other one
  const __m128i all = _mm_load_si128(static_cast<const __m128i*>(from));
  const __m128i floats = _mm_and_si128(all, _mm_setr_epi32(-1, -1, -1, 0));  // as a float the number is denormal: slow to convert
  const __m256d number = _mm256_castsi256_pd(_mm256_cvtepu32_epi64(all));
  _mm256_store_pd(static_cast<double*>(to), _mm256_blend_pd(_mm256_cvtps_pd(_mm_castsi128_ps(floats)), number, 8));
#else
  float x[3];
  std::memcpy(x, from, sizeof x);
  const double wide[3] = {static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2])};
  std::memcpy(to, wide, sizeof wide);
  std::memcpy(static_cast<char*>(to) + sizeof wide, static_cast<const char*>(from) + sizeof x, sizeof(std::uint32_t));
#endif
}

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
