#pragma once

#include <concepts>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/geometry/particle_fields.hpp>
#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid {

/// A force on every particle in proportion to its mass, f_I = m_I b: a BoundaryTerm in every dimension.
///   BodyForce{.acceleration = Vector3(0.0, 0.0, -9.81)}
///     gravity; the energy −Σ m b·x is stored
///   BodyForce{.acceleration = [](const Vector3& X, double t) { … }}
///     b(X, t) at reference positions X (m) and times t (s); its power is external power
/// Components beyond the dimension of the body are ignored. In a meridian section (1) is along the axis, and (0) away from it:
/// a constant acceleration has none there.
template <class Acceleration = Vector3>
struct BodyForce {
  static constexpr bool follows_redistribution = true;  ///< keeps nothing of the body
  /// The acceleration is a vector, not a function.
  static constexpr bool constant = std::convertible_to<Acceleration, Vector3>;
  static_assert(
      constant || requires(const Acceleration& b, const Vector3& X) {
        { b(X, 0.0) } -> std::convertible_to<Vector3>;
      }, "BodyForce.acceleration is a Vector3 or a function (const Vector3& X, double t) -> Vector3.");

  Acceleration acceleration{};  ///< b, N/kg = m/s²
  int dimension = 0;            ///< set by initialize()

  /// Throws ParameterError for a constant acceleration that is not finite.
  void validate() const {
    if constexpr (constant)
      for (int k = 0; k < 3; ++k) require_finite("BodyForce.acceleration", Vector3(acceleration)[k], "N/kg");
  }

  /// Throws ParameterError for a constant acceleration that is not finite, or not along the axis of a meridian
  /// section.
  template <int D>
  void initialize(const PointCloud<D>& cloud, const ParticleFields&) {
    validate();
    if constexpr (constant)
      if (cloud.axisymmetric && Vector3(acceleration)[0] != 0.0)
        throw ParameterError("BodyForce.acceleration of an axisymmetric body must be along its axis, (0, b, 0).");
    dimension = D;
  }

  /// Adds m_I b; returns −Σ m b·x as potential, or Σ m b·v as external power.
  TermEnergy apply(const ParticleFields& body, double time) {
    parallel_for(body.force.size(), [&](std::size_t i) { body.force[i] += force(body, i, time); });
    TermEnergy total;
    for (std::size_t i = 0; i < body.force.size(); ++i) {
      if constexpr (constant)
        total.potential -= force(body, i, time).dot(body.position[i]);
      else
        total.external_power += force(body, i, time).dot(body.velocity[i]);
    }
    return total;
  }

  [[nodiscard]] double stiffness_rate(const ParticleFields&) const { return 0.0; }  ///< limits nothing

 private:
  Vector4 force(const ParticleFields& body, std::size_t i, double time) const {
    Vector4 f = Vector4::Zero();
    if constexpr (constant)
      f.head<3>() = body.mass[i] * acceleration;
    else
      f.head<3>() = body.mass[i] * Vector3(acceleration(Vector3(body.reference[i].head<3>()), time));
    for (int k = dimension; k < 3; ++k) f[k] = 0.0;
    return f;
  }
};

}  // namespace tactoid
