#pragma once

#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/simulation/body_fields.hpp>

namespace tactoid::verification {

/// Values at the particles of a cloud that does not deform, of unit masses.
[[nodiscard]] inline BodyFields at_rest(const PointCloud<3>& cloud) {
  BodyFields fields;
  for (const Point<3>& X : cloud.positions) fields.reference.push_back(pad(X));
  fields.position = fields.reference;
  fields.velocity.assign(cloud.size(), Vector4::Zero());
  fields.force.assign(cloud.size(), Vector4::Zero());
  fields.mass.assign(cloud.size(), 1.0);
  fields.volume.assign(cloud.size(), 1.0);
  return fields;
}

}  // namespace tactoid::verification
