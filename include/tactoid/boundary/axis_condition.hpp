#pragma once

#include <utility>
#include <vector>

#include <tactoid/boundary/prescribed_motion.hpp>
#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid {

/// The essential conditions of a body, and the one that every meridian section has: nothing leaves the axis. Particles
/// on the axis whose radial component is prescribed already are left to that. Simulation and StaticProblem add it to
/// theirs, after the conditions given; to those of a part of a cloud always, since all processes have the same conditions.
template <int D>
[[nodiscard]] std::vector<PrescribedMotion> with_axis_condition(const PointCloud<D>& cloud, std::vector<PrescribedMotion> motions);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/boundary/axis_condition.ipp>
#endif
