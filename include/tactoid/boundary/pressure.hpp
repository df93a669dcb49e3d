#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <tactoid/boundary/surface_tension.hpp>

namespace tactoid {

/// A uniform pressure on the whole current surface of a body: traction −p n, eqn (17) of Zeng and Li, Soft Matter 2012,
/// 8, 5765. The force at a particle, −p ∫ N_I n da (exact over the bilinear facets), is −p ∂V/∂x of the enclosed volume
/// if the surface is closed: net force and torque are then zero to round-off, and the energy is p V. On an open surface
/// it is a following load without an energy, and its power is external power.
///
/// Pressures are gauge pressures. An ambient pressure p₀ acts on all sides, also where the body is in contact (a thin
/// liquid film separates the surfaces), and is balanced by the same p₀ inside: measured from p₀, it drops out of every
/// force. Entering the 100 kPa of an atmosphere as `pressure` only compresses the body, and drowns the few kPa that
/// move a cell in discretisation error. A BoundaryTerm in 2 (per thickness, or of the rings of a meridian) and
/// 3 dimensions.
struct AmbientPressure {
  static constexpr bool follows_redistribution = true;  ///< keeps nothing of the body
  static constexpr Reads reads = Reads::facets;  ///< the surface
  double pressure = 0.0;                     ///< p, gauge, Pa; positive compresses
  PerDimension<SurfaceIntegral> integral{};  ///< set by initialize()

  /// Throws ParameterError unless finite.
  void validate() const { require_finite("AmbientPressure.pressure", pressure, "Pa"); }

  /// Throws ParameterError for a pressure that is not finite, GeometryError for a cloud without facets or with
  /// periodic directions.
  template <int D>
    requires(D >= 2)
  void initialize(const PointCloud<D>& cloud, const ParticleFields& body) {
    validate();
    integral.emplace<D>().initialize(cloud, body);
  }

  /// Adds −p ∫ N_I n da; returns p V on a closed surface, else the power.
  TermEnergy apply(const ParticleFields& body, double);

  /// Gershgorin's bound of the load's stiffness over the masses.
  [[nodiscard]] double stiffness_rate(const ParticleFields& body) const;
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/boundary/pressure.ipp>
#endif
