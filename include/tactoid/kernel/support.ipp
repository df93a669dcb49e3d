#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/kernel/support.hpp>
#include <tactoid/neighbors/neighbor_search.hpp>

namespace tactoid {

template <int D>
std::vector<double> neighbor_spacings(const PointCloud<D>& cloud) {
  constexpr std::size_t around = D == 1 ? 2 : D == 2 ? 8 : 26;
  const NeighborSearch<D> search(cloud.positions, cloud.period);
  std::vector<double> spacing(cloud.size());
  parallel_for(cloud.size(), [&](std::size_t i) {
    spacing[i] = search.nearest(cloud.positions[i], around + 1).back().distance / std::sqrt(static_cast<double>(D));  // itself included
  });
  return spacing;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template std::vector<double> neighbor_spacings<1>(const PointCloud<1>& cloud);
template std::vector<double> neighbor_spacings<2>(const PointCloud<2>& cloud);
template std::vector<double> neighbor_spacings<3>(const PointCloud<3>& cloud);
}  // namespace tactoid
#endif
