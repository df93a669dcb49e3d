#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/boundary/axis_condition.hpp>

namespace tactoid {

template <int D>
std::vector<PrescribedMotion> with_axis_condition(const PointCloud<D>& cloud, std::vector<PrescribedMotion> motions) {
  if (!cloud.axisymmetric) return motions;
  std::vector<char> prescribed(cloud.size(), 0);
  for (const PrescribedMotion& motion : motions)
    for (const Index i : motion.particles)
      if (motion.components[0] && i < cloud.size()) prescribed[i] = 1;
  std::vector<Index> free;
  for (Index i = 0; i < cloud.size(); ++i)
    if (cloud.on_axis(cloud.positions[i]) && !prescribed[i]) free.push_back(i);
  if (!free.empty() || cloud.part) motions.push_back(fixed(std::move(free), {true, false, false}));
  return motions;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template std::vector<PrescribedMotion> with_axis_condition<1>(const PointCloud<1>& cloud, std::vector<PrescribedMotion> motions);
template std::vector<PrescribedMotion> with_axis_condition<2>(const PointCloud<2>& cloud,
                                                              std::vector<PrescribedMotion> motions);
template std::vector<PrescribedMotion> with_axis_condition<3>(const PointCloud<3>& cloud,
                                                              std::vector<PrescribedMotion> motions);
}  // namespace tactoid
#endif
