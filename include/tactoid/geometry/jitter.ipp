#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/geometry/jitter.hpp>

namespace tactoid {

template <int D>
PointCloud<D> jitter(const PointCloud<D>& cloud, double fraction, std::uint64_t seed) {
  if (!(fraction >= 0.0 && fraction < 0.5)) reject("jitter.fraction", fraction, "", "in [0, 0.5)");
  PointCloud<D> moved = cloud;
  const std::vector<bool> fixed = on_boundary(cloud);
  const std::vector<double> spacing = shortest_edges(cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (fixed[i]) continue;
    for (int k = 0; k < D; ++k)
      moved.positions[i][k] +=
          fraction * spacing[i] * detail::hashed_uniform(seed, cloud.number(i) * 4 + static_cast<std::uint64_t>(k));
  }
  validate(moved);
  return moved;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template PointCloud<1> jitter<1>(const PointCloud<1>& cloud, double fraction, std::uint64_t seed);
template PointCloud<2> jitter<2>(const PointCloud<2>& cloud, double fraction, std::uint64_t seed);
template PointCloud<3> jitter<3>(const PointCloud<3>& cloud, double fraction, std::uint64_t seed);
}  // namespace tactoid
#endif
