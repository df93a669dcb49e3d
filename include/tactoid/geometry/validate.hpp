#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/cell_map.hpp>

namespace tactoid {

/// A position in words: "(1e-06, 0, 2e-06) m".
template <int D>
[[nodiscard]] std::string describe(const Point<D>& x);

/// Throws GeometryError, with place and cause, if the cloud has no particles or cells, a position that is not
/// finite, one beyond the axis of a meridian section, an index out of range, a cell that uses a particle twice or has a Jacobian that is not positive at
/// one of its corners, or a particle that no cell uses.
template <int D>
void validate(const PointCloud<D>& cloud);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/validate.ipp>
#endif
