#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid {

TACTOID_INLINE void Part::validate() const {
  if (ranks < 1) reject("Part.ranks", ranks, "", "at least 1");
  if (rank < 0 || rank >= ranks) reject("Part.rank", rank, "", fmt::format("in [0, {})", ranks));
  require_positive("Part.support", support);
}

}  // namespace tactoid
