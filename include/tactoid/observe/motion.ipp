#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/observe/motion.hpp>

namespace tactoid {

namespace detail {

/// With center_of_mass times the mass.
template <class Particles>
[[nodiscard]] Motion sums_of_motion(const Particles& particles, std::span<const double> mass, std::span<const Vector4> reference,
                                    std::span<const Vector4> displacement, std::span<const Vector4> velocity) {
  Motion m;
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const std::size_t i = particles[k];
    const Vector3 x = reference[i].head<3>() + displacement[i].head<3>(), p = mass[i] * velocity[i].head<3>();
    m.mass += mass[i];
    m.momentum += p;
    m.angular_momentum += Vector3(x[1] * p[2] - x[2] * p[1], x[2] * p[0] - x[0] * p[2], x[0] * p[1] - x[1] * p[0]);
    m.center_of_mass += mass[i] * x;
  }
  return m;
}

TACTOID_INLINE Motion motion_of_own(std::span<const double> mass, std::span<const Vector4> reference, std::span<const Vector4> displacement,
                                    std::span<const Vector4> velocity, RowShare& share) {
  Motion m = sums_of_motion(OwnParticles(&share, mass.size()), mass, reference, displacement, velocity);
  for (Vector3* sum : {&m.momentum, &m.angular_momentum, &m.center_of_mass}) share.reduce({sum->data(), 3}, {});
  m.mass = share.sum(m.mass);
  m.center_of_mass /= m.mass;
  return m;
}

}  // namespace detail

TACTOID_INLINE Motion motion(std::span<const double> mass, std::span<const Vector4> reference,
                             std::span<const Vector4> displacement, std::span<const Vector4> velocity) {
  Motion m = detail::sums_of_motion(OwnParticles(nullptr, mass.size()), mass, reference, displacement, velocity);
  m.center_of_mass /= m.mass;
  return m;
}

}  // namespace tactoid
