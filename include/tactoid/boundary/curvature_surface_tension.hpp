#pragma once

#include <vector>

#include <Eigen/Geometry>

#include <tactoid/boundary/surface_tension.hpp>

namespace tactoid {

/// Surface tension as a traction from the curvature, as Zeng and Li, Soft Matter 2012, 8, 5765, print it in eqn (17):
///
///   f_I = −σ₀ κ_I n_I a_I,       κ = ∇·n,
///
/// with unit normals n_I at the particles (of the sum of the area vectors around them), κ_I the surface divergence of
/// their interpolation averaged with the shape function of I, and a_I the current nodal area. Not the gradient of
/// an energy: net force and torque vanish with the mesh size only. The potential reported is σ₀ A, for comparison with
/// SurfaceTension; what the forces do beyond it is reported as external power, so that a balance closes.
/// A BoundaryTerm in 2 and 3 dimensions.
struct CurvatureSurfaceTension {
  static constexpr bool follows_redistribution = true;  ///< keeps nothing of the body
  static constexpr Reads reads = Reads::facets;  ///< the surface
  double tension = 0.072e-3;                 ///< σ₀, N/m
  PerDimension<SurfaceIntegral> integral{};  ///< set by initialize()
  Field normals{};                           ///< unit normals, per particle (zero inside) at the last call of apply
  std::vector<double> areas{};               ///< current nodal areas, per particle, m²
  std::vector<double> curvatures{};          ///< κ, per particle, 1/m

  /// Throws ParameterError unless tension >= 0.
  void validate() const { require_non_negative("CurvatureSurfaceTension.tension", tension, "N/m"); }

  /// Throws ParameterError unless tension >= 0, GeometryError for a cloud without facets or with periodic directions.
  template <int D>
    requires(D >= 2)
  void initialize(const PointCloud<D>& cloud, const ParticleFields& body);

  /// Adds −σ₀ κ_I a_I n_I; returns σ₀ A, and the power of the forces beyond its change.
  TermEnergy apply(const ParticleFields& body, double);

  /// Of σ₀ A, which these forces approximate.
  [[nodiscard]] double stiffness_rate(const ParticleFields& body) const;
  /// For checkpoints: normals, areas and curvatures, for who reads them before the next step.
  template <class Archive>
  void state(Archive& archive) {
    if (integral.empty()) return;
    integral.visit([&](const auto& s) {
      state_at(archive, "normals", normals, s.surface.nodes);
      state_at(archive, "areas", areas, s.surface.nodes);
      state_at(archive, "curvatures", curvatures, s.surface.nodes);
    });
  }

 private:
  template <int D>
  TermEnergy apply_to(SurfaceIntegral<D>& s, const ParticleFields& body);
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/boundary/curvature_surface_tension.ipp>
#endif
