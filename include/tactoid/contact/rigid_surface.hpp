#pragma once

#include <cmath>
#include <concepts>
#include <functional>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/core/unsatisfied.hpp>

namespace tactoid {

/// Where a point stands to a rigid surface.
struct RigidGap {
  double gap = 0.0;                    ///< signed distance, positive outside, m
  Vector3 normal = Vector3::Zero();    ///< ∂gap/∂x, unit
  Vector3 velocity = Vector3::Zero();  ///< of the surface there, m/s
};

/// A surface that does not deform: `RigidGap at(const Vector3& x, double time) const` tells the signed gap of a
/// point x (m), its gradient, and the velocity of the surface; `void validate() const` throws ParameterError.
template <class S>
concept RigidSurface = (requires(const S& s, const Vector3& x, double time) {
                         { s.at(x, time) } -> std::same_as<RigidGap>;
                       } || unsatisfied<"A RigidSurface has `RigidGap at(const Vector3& x, double time) const`.">) &&
                       (requires(const S& s) { s.validate(); } ||
                        unsatisfied<"A RigidSurface has `void validate() const` that throws ParameterError.">);

/// A plane, at rest or moving steadily. The side to which the normal points is outside.
struct RigidPlane {
  Vector3 point = Vector3::Zero();     ///< a point of the plane at time 0, m
  Vector3 normal = Vector3::UnitZ();   ///< outward; its length does not matter
  Vector3 velocity = Vector3::Zero();  ///< m/s

  /// Throws ParameterError for a normal of no length, and for what is not finite.
  void validate() const;
  /// Gap of x (m) at the time (s).
  [[nodiscard]] RigidGap at(const Vector3& x, double time) const {
    const Vector3 n = normal.normalized();
    return {n.dot(x - point - time * velocity), n, velocity};
  }
};

/// A sphere (D = 2: a circle), at rest or moving steadily.
struct RigidSphere {
  Vector3 center = Vector3::Zero();    ///< at time 0, m
  double radius = 1e-6;                ///< m
  Vector3 velocity = Vector3::Zero();  ///< m/s

  /// Throws ParameterError unless radius > 0, and for what is not finite.
  void validate() const;
  /// Gap of x (m) at the time (s); in the centre the normal is z.
  [[nodiscard]] RigidGap at(const Vector3& x, double time) const {
    const Vector3 r = x - center - time * velocity;
    const double distance = r.norm();
    return {distance - radius, distance > 0.0 ? Vector3(r / distance) : Vector3(Vector3::UnitZ()), velocity};
  }
};

/// Moves a rigid surface along a prescribed path: displacement (m) and velocity (m/s) as functions of the time (s).
/// The velocity must be the derivative of the displacement, or the energy balance does not close.
template <RigidSurface S>
struct Moving {
  S surface{};                                  ///< at time 0
  std::function<Vector3(double)> displacement;  ///< of the time, s: m
  std::function<Vector3(double)> velocity;      ///< of the time, s: m/s

  /// Throws ParameterError where the surface does, and for a missing function.
  void validate() const {
    surface.validate();
    if (!displacement || !velocity)
      throw ParameterError("Moving.displacement and Moving.velocity must both be given, as functions of the time.");
  }
  /// Gap of x (m) at the time (s).
  [[nodiscard]] RigidGap at(const Vector3& x, double time) const {
    RigidGap g = surface.at(x - displacement(time), time);
    g.velocity += velocity(time);
    return g;
  }
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/rigid_surface.ipp>
#endif
