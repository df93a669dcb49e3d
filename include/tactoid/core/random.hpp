#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace tactoid {

/// A small generator of random numbers (SplitMix64: Steele, Lea and Flood, OOPSLA 2014) whose sequence depends on the
/// seed alone: not on the compiler, as those of the standard library's distributions do.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}  ///< any number; the same seed gives the same sequence

  /// 64 random bits.
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

  /// Uniform in [from, to).
  double uniform(double from, double to) { return from + (to - from) * uniform(); }

  /// Normal with mean 0 and variance 1 (Box–Muller).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace tactoid
