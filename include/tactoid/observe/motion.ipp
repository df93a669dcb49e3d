#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/observe/motion.hpp>

namespace tactoid {

TACTOID_INLINE Motion motion(std::span<const double> mass, std::span<const Vector4> reference,
                             std::span<const Vector4> displacement, std::span<const Vector4> velocity) {
  Motion m;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    const Vector3 x = reference[i].head<3>() + displacement[i].head<3>(), p = mass[i] * velocity[i].head<3>();
    m.mass += mass[i];
    m.momentum += p;
    m.angular_momentum += Vector3(x[1] * p[2] - x[2] * p[1], x[2] * p[0] - x[0] * p[2], x[0] * p[1] - x[1] * p[0]);
    m.center_of_mass += mass[i] * x;
  }
  m.center_of_mass /= m.mass;
  return m;
}

TACTOID_INLINE Motion detail::summed(const Motion& own, RowShare& share) {
  Motion m = own;
  m.center_of_mass *= m.mass;
  for (Vector3* sum : {&m.momentum, &m.angular_momentum, &m.center_of_mass}) share.reduce({sum->data(), 3}, {});
  m.mass = share.sum(m.mass);
  m.center_of_mass /= m.mass;
  return m;
}

}  // namespace tactoid
