#pragma once

#include <cstdint>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/facets.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/geometry/validate.hpp>

namespace tactoid {

namespace detail {

/// Hash of a counter (the finaliser of splitmix64) to a number in [−1, 1).
[[nodiscard]] inline double hashed_uniform(std::uint64_t seed, std::uint64_t counter) {
  std::uint64_t z = seed * 0xD1342543DE82EF95ull + (counter + 1) * 0x9E3779B97F4A7C15ull;
  for (int round = 0; round < 2; ++round) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    z ^= z >> 31;
  }
  return static_cast<double>(z >> 11) * 0x1.0p-52 - 1.0;
}

}  // namespace detail

/// The cloud with every interior particle moved at random: each component uniform in ± `fraction` times its
/// shortest cell edge. Particles on facets stay. `fraction` is in [0, 0.5); the same seed gives the same cloud
/// on every machine; a part of a regular grid is moved as the whole is (of other clouds, move the whole before part_of). Throws ParameterError for the fraction, GeometryError if a cell inverts.
template <int D>
[[nodiscard]] PointCloud<D> jitter(const PointCloud<D>& cloud, double fraction, std::uint64_t seed = 1);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/jitter.ipp>
#endif
