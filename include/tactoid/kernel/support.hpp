#pragma once

#include <vector>

#include <tactoid/geometry/measures.hpp>
#include <tactoid/kernel/kernel.hpp>

namespace tactoid {

/// Support radius a_I of every particle, m: the kernel's `support` times the longest cell edge at the particle.
template <Kernel K>
[[nodiscard]] std::vector<double> support_radii(const K& kernel, const PointCloud<K::dimension>& cloud) {
  std::vector<double> radii = longest_edges(cloud);
  for (double& radius : radii) radius *= kernel.support;
  return radii;
}

}  // namespace tactoid
