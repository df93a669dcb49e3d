#pragma once

#include <vector>

#include <tactoid/core/tensor.hpp>
#include <tactoid/geometry/particle_fields.hpp>

namespace tactoid {

/// Momentum, angular momentum about the origin and centre of mass of particles.
struct Motion {
  double mass = 0.0;                            ///< kg
  Vector3 momentum = Vector3::Zero();           ///< kg m/s
  Vector3 angular_momentum = Vector3::Zero();   ///< kg m²/s, about the origin
  Vector3 center_of_mass = Vector3::Zero();     ///< m
};

/// Of value-based bodies, whose lumped masses sit at the particles. Sums run in the order of the particles.
[[nodiscard]] inline Motion motion(const ParticleFields& body) {
  Motion m;
  for (std::size_t i = 0; i < body.mass.size(); ++i) {
    const Vector3 x = body.position[i].head<3>(), p = body.mass[i] * body.velocity[i].head<3>();
    m.mass += body.mass[i];
    m.momentum += p;
    m.angular_momentum += Vector3(x[1] * p[2] - x[2] * p[1], x[2] * p[0] - x[0] * p[2], x[0] * p[1] - x[1] * p[0]);
    m.center_of_mass += body.mass[i] * x;
  }
  m.center_of_mass /= m.mass;
  return m;
}

}  // namespace tactoid
