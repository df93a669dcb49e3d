#pragma once

#include <cstdint>

#ifdef __AVX512F__
#include <immintrin.h>
#endif

/// Four or eight doubles that the hot loops keep in registers: the vector types of g++ and clang++ where the machine has a register
/// of that length, and two halves where it has not (g++ keeps a vector type without a register in memory). Arithmetic, also with a
/// number (`2.0 * a`), comes with the type; a product that is added becomes one instruction where the machine has it.
namespace tactoid {

namespace detail {
/// Two vectors side by side as one of twice the length.
template <class Half>
struct Twice {
  Half first = {};   ///< the elements in front
  Half second = {};  ///< as many behind them

  Twice() = default;
  [[gnu::always_inline]] Twice(const Half& low, const Half& high) : first(low), second(high) {}
  /// One by one, of four.
  [[gnu::always_inline]] Twice(double a, double b, double c, double d) : first{a, b}, second{c, d} {}

  ///@{
  /// Element i.
  [[gnu::always_inline]] double operator[](int i) const {
    constexpr int half = sizeof(Half) / sizeof(double);
    return i < half ? first[i] : second[i - half];
  }
  [[gnu::always_inline]] double& operator[](int i) { return reinterpret_cast<double*>(this)[i]; }
  ///@}

  ///@{
  /// In every place.
  [[gnu::always_inline]] Twice& operator+=(const Twice& b) { return first += b.first, second += b.second, *this; }
  [[gnu::always_inline]] Twice& operator-=(const Twice& b) { return first -= b.first, second -= b.second, *this; }
  [[gnu::always_inline]] Twice& operator*=(double b) { return first *= b, second *= b, *this; }
  [[gnu::always_inline]] friend Twice operator+(const Twice& a, const Twice& b) { return {a.first + b.first, a.second + b.second}; }
  [[gnu::always_inline]] friend Twice operator-(const Twice& a, const Twice& b) { return {a.first - b.first, a.second - b.second}; }
  [[gnu::always_inline]] friend Twice operator*(const Twice& a, const Twice& b) { return {a.first * b.first, a.second * b.second}; }
  [[gnu::always_inline]] friend Twice operator*(double a, const Twice& b) { return {a * b.first, a * b.second}; }
  ///@}
};
}  // namespace detail

#ifdef __AVX__
/// Four doubles, 32 bytes.
using Quad [[gnu::vector_size(32)]] = double;

namespace detail {
/// A Quad as it lies in memory: anywhere where doubles may lie, and part of whatever object.
using QuadInMemory [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;
}  // namespace detail

/// Element K in all places.
template <int K>
[[gnu::always_inline]] inline Quad everywhere(const Quad& a) { return __builtin_shufflevector(a, a, K, K, K, K); }

/// Three floats in double precision, and 0 in the place of what follows them: a number that is no float.
[[gnu::always_inline]] inline void widen(const float* p, Quad& wide) {
  using Words [[gnu::vector_size(16), gnu::aligned(4), gnu::may_alias]] = std::int32_t;
  using Floats [[gnu::vector_size(16)]] = float;
  const auto bits = *reinterpret_cast<const Words*>(p) & Words{-1, -1, -1, 0};  // as a float it is denormal, and slow to convert
  wide = __builtin_convertvector(reinterpret_cast<Floats>(bits), Quad);
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
#else
namespace detail {
using Pair [[gnu::vector_size(16)]] = double;
/// A Quad as it lies in memory: anywhere where doubles may lie, and part of whatever object. (Of members alone g++ would not know that.)
struct [[gnu::may_alias]] QuadInMemory {
  using Half [[gnu::vector_size(16), gnu::aligned(8), gnu::may_alias]] = double;
  Half first;
  Half second;
  [[gnu::always_inline]] operator Twice<Pair>() const {
    const Pair low = first, high = second;  // copies, which are aligned
    return {low, high};
  }
  [[gnu::always_inline]] QuadInMemory& operator=(const Twice<Pair>& b) { return first = b.first, second = b.second, *this; }
  [[gnu::always_inline]] QuadInMemory& operator+=(const Twice<Pair>& b) { return first += b.first, second += b.second, *this; }
  [[gnu::always_inline]] QuadInMemory& operator-=(const Twice<Pair>& b) { return first -= b.first, second -= b.second, *this; }
};
}  // namespace detail

/// Four doubles, 32 bytes.
using Quad = detail::Twice<detail::Pair>;

/// Element K in all places.
template <int K>
[[gnu::always_inline]] inline Quad everywhere(const Quad& a) {
  const detail::Pair& half = K < 2 ? a.first : a.second;
  const detail::Pair both = __builtin_shufflevector(half, half, K % 2, K % 2);
  return {both, both};
}

/// Three floats in double precision, and 0 in the place of what follows them: a number that is no float.
[[gnu::always_inline]] inline void widen(const float* p, Quad& wide) {
  wide = {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]), 0.0};
}

/// Rows become columns: a[i] of the four become the new a, and so on.
[[gnu::always_inline]] inline void transpose(Quad& a, Quad& b, Quad& c, Quad& d) {
  const Quad A = a, B = b, C = c, D = d;
  a = {__builtin_shufflevector(A.first, B.first, 0, 2), __builtin_shufflevector(C.first, D.first, 0, 2)};
  b = {__builtin_shufflevector(A.first, B.first, 1, 3), __builtin_shufflevector(C.first, D.first, 1, 3)};
  c = {__builtin_shufflevector(A.second, B.second, 0, 2), __builtin_shufflevector(C.second, D.second, 0, 2)};
  d = {__builtin_shufflevector(A.second, B.second, 1, 3), __builtin_shufflevector(C.second, D.second, 1, 3)};
}
#endif

/// Four doubles from p on.
[[gnu::always_inline]] inline Quad quad(const double* p) { return *reinterpret_cast<const detail::QuadInMemory*>(p); }
/// The same to assign to.
[[gnu::always_inline]] inline detail::QuadInMemory& quad(double* p) { return *reinterpret_cast<detail::QuadInMemory*>(p); }

#ifdef __AVX512F__
/// Eight doubles, 64 bytes: two Quads side by side.
using Octet [[gnu::vector_size(64)]] = double;

/// Two Quads as one Octet.
[[gnu::always_inline]] inline Octet join(const Quad& low, const Quad& high) { return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7); }
/// The first four.
[[gnu::always_inline]] inline Quad low(const Octet& a) { return __builtin_shufflevector(a, a, 0, 1, 2, 3); }
/// The last four.
[[gnu::always_inline]] inline Quad high(const Octet& a) { return __builtin_shufflevector(a, a, 4, 5, 6, 7); }
/// Element K of each half, in all places of this half.
template <int K>
[[gnu::always_inline]] inline Octet spread(const Octet& a) { return __builtin_shufflevector(a, a, K, K, K, K, 4 + K, 4 + K, 4 + K, 4 + K); }
/// Element K in all places of both halves.
template <int K>
[[gnu::always_inline]] inline Octet twice(const Quad& a) { return __builtin_shufflevector(a, a, K, K, K, K, K, K, K, K); }

/// Eight doubles from p on.
[[gnu::always_inline]] inline Octet octet(const double* p) {
  using InMemory [[gnu::vector_size(64), gnu::aligned(8), gnu::may_alias]] = double;
  return *reinterpret_cast<const InMemory*>(p);
}

/// Twice three floats in double precision, each three of them with something that is no float behind it.
[[gnu::always_inline]] inline void widen(const float* p, Octet& wide) {
  using Words [[gnu::vector_size(32), gnu::aligned(4), gnu::may_alias]] = std::int32_t;
  using Floats [[gnu::vector_size(32)]] = float;
  const auto bits = *reinterpret_cast<const Words*>(p) & Words{-1, -1, -1, 0, -1, -1, -1, 0};
  wide = _mm512_cvtps_pd(reinterpret_cast<Floats>(bits));  // of __builtin_convertvector g++ 12 makes five instructions
}
#else
/// Eight doubles, 64 bytes: two Quads side by side.
using Octet = detail::Twice<Quad>;

/// Two Quads as one Octet.
[[gnu::always_inline]] inline Octet join(const Quad& low, const Quad& high) { return {low, high}; }
/// The first four.
[[gnu::always_inline]] inline const Quad& low(const Octet& a) { return a.first; }
/// The last four.
[[gnu::always_inline]] inline const Quad& high(const Octet& a) { return a.second; }
/// Element K of each half, in all places of this half.
template <int K>
[[gnu::always_inline]] inline Octet spread(const Octet& a) { return {everywhere<K>(a.first), everywhere<K>(a.second)}; }
/// Element K in all places of both halves.
template <int K>
[[gnu::always_inline]] inline Octet twice(const Quad& a) { return {everywhere<K>(a), everywhere<K>(a)}; }

/// Eight doubles from p on.
[[gnu::always_inline]] inline Octet octet(const double* p) { return {quad(p), quad(p + 4)}; }

/// Twice three floats in double precision, each three of them with something that is no float behind it.
[[gnu::always_inline]] inline void widen(const float* p, Octet& wide) {
  widen(p, wide.first);
  widen(p + 4, wide.second);
}
#endif

}  // namespace tactoid
