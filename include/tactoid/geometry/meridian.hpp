#pragma once

#include <cmath>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/ball.hpp>
#include <tactoid/geometry/box.hpp>
#include <tactoid/geometry/disc.hpp>
#include <tactoid/geometry/order.hpp>
#include <tactoid/geometry/part.hpp>

namespace tactoid {

/// The meridian section of a ball about the axis, R >= 0: the half-circle in which the particles of ball() stand in the plane
/// y = 0. The axis of revolution is z, the second coordinate of the section. Throws ParameterError; the center must be on
/// the axis, the core must have an even number of cells, so that particles lie on it.
[[nodiscard]] PointCloud<2> meridian(const Ball& parameters);

/// The meridian section of a disc, R >= 0: a rectangle with the spacings of disc() along a radius (an odd number of core
/// cells counts as one more). Throws ParameterError; the origin must be on the axis.
[[nodiscard]] PointCloud<2> meridian(const Disc& parameters);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/meridian.ipp>
#endif
