#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <tactoid/core/tensor.hpp>
#include <tactoid/geometry/particle_fields.hpp>
#include <tactoid/quadrature/row_share.hpp>

namespace tactoid {

/// Momentum, angular momentum about the origin and centre of mass of a body.
struct Motion {
  double mass = 0.0;                           ///< kg
  Vector3 momentum = Vector3::Zero();          ///< kg m/s
  Vector3 angular_momentum = Vector3::Zero();  ///< kg m²/s, about the origin
  Vector3 center_of_mass = Vector3::Zero();    ///< m
};

/// From lumped masses, the reference positions of the particles, and the unknowns: values at the particles, or
/// coefficients (the sums are those of the fields, since shape functions reproduce the position). Sums run in the
/// order of the particles.
[[nodiscard]] Motion motion(std::span<const double> mass, std::span<const Vector4> reference,
                            std::span<const Vector4> displacement, std::span<const Vector4> velocity);

/// Of a value-based body, from the values at its particles.
[[nodiscard]] inline Motion motion(const ParticleFields& body) {
  Field displacement(body.mass.size());
  for (std::size_t i = 0; i < displacement.size(); ++i) displacement[i] = body.position[i] - body.reference[i];
  return motion(body.mass, body.reference, displacement, body.velocity);
}

namespace detail {

/// The same of the particles that belong to each of several processes, together. Collective.
[[nodiscard]] Motion motion_of_own(std::span<const double> mass, std::span<const Vector4> reference, std::span<const Vector4> displacement,
                                   std::span<const Vector4> velocity, RowShare& share);

}  // namespace detail

/// Of body N of a simulation, at the present instant; of a body of which each process has a part, of the whole (collective). Of a body of revolution: over whole rings, along the axis alone.
template <std::size_t N, class S>
[[nodiscard]] Motion motion(const S& simulation) {
  const auto& body = simulation.template body<N>();
  const Field velocity = simulation.template velocity<N>();
  Motion m = body.in_parts() ? detail::motion_of_own(body.masses(), body.reference(), body.displacement, velocity, *body.share())
                             : motion(body.masses(), body.reference(), body.displacement, velocity);
  if (body.table().axisymmetric) {
    m.momentum[0] = m.center_of_mass[0] = 0.0;
    m.angular_momentum.setZero();
  }
  return m;
}

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/observe/motion.ipp>
#endif
