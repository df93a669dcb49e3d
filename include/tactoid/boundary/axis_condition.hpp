#pragma once

#include <utility>
#include <vector>

#include <tactoid/boundary/prescribed_motion.hpp>
#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid {

/// The essential conditions of a body, and the one that every meridian section has: nothing leaves the axis. Particles
/// on the axis whose radial component is prescribed already are left to that. Simulation and StaticProblem add it to
/// theirs, after the conditions given.
template <int D>
[[nodiscard]] std::vector<PrescribedMotion> with_axis_condition(const PointCloud<D>& cloud, std::vector<PrescribedMotion> motions) {
  if (!cloud.axisymmetric) return motions;
  std::vector<char> prescribed(cloud.size(), 0);
  for (const PrescribedMotion& motion : motions)
    for (const Index i : motion.particles)
      if (motion.components[0] && i < cloud.size()) prescribed[i] = 1;
  std::vector<Index> free;
  for (Index i = 0; i < cloud.size(); ++i)
    if (cloud.on_axis(cloud.positions[i]) && !prescribed[i]) free.push_back(i);
  if (!free.empty()) motions.push_back(fixed(std::move(free), {true, false, false}));
  return motions;
}

}  // namespace tactoid
