#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/rigid_surface.hpp>

namespace tactoid {

TACTOID_INLINE void RigidPlane::validate() const {
  for (int k = 0; k < 3; ++k) {
    require_finite("RigidPlane.point", point[k], "m");
    require_finite("RigidPlane.velocity", velocity[k], "m/s");
  }
  require_positive("length of RigidPlane.normal", normal.norm());
}

TACTOID_INLINE void RigidSphere::validate() const {
  for (int k = 0; k < 3; ++k) {
    require_finite("RigidSphere.center", center[k], "m");
    require_finite("RigidSphere.velocity", velocity[k], "m/s");
  }
  require_positive("RigidSphere.radius", radius, "m");
}

}  // namespace tactoid
