#pragma once

#include <vector>

#include <tactoid/geometry/particle_fields.hpp>
#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid::verification {

/// Values at the particles of a cloud that is no body: of unit masses, at rest where they are put.
struct FieldsAtRest {
  Field reference, position, velocity, force;
  std::vector<double> ones;

  explicit FieldsAtRest(const PointCloud<3>& cloud) : velocity(cloud.size(), Vector4::Zero()), force(velocity), ones(cloud.size(), 1.0) {
    for (const Point<3>& X : cloud.positions) reference.push_back(pad(X));
    position = reference;
  }
  /// As contacts and terms take it; valid as long as this object.
  [[nodiscard]] ParticleFields view() { return {reference, position, velocity, ones, ones, force}; }
};

}  // namespace tactoid::verification
