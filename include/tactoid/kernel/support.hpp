#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include <tactoid/core/parallel.hpp>
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

/// Spacing of the particles around each one, m, without the cells, which a fluid draws out: the distance of the 3^D − 1 nearest ones over
/// √D, as in a square or cubic lattice. Larger at a surface, and where particles lie denser in one direction than in another.
template <int D>
[[nodiscard]] std::vector<double> neighbor_spacings(const PointCloud<D>& cloud);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/kernel/support.ipp>
#endif
