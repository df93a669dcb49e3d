#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include <tactoid/contact/facet_derivatives.hpp>
#include <tactoid/contact/per_dimension.hpp>
#include <tactoid/contact/surface.hpp>
#include <tactoid/contact/surface_transfer.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/geometry/particle_fields.hpp>

namespace tactoid {

/// A surface and the quadrature of integrals over its current facets, with scratch for forces per facet corner
/// (so that facets are independent, and the sum at a particle has a fixed order).
template <int D>
struct SurfaceIntegral {
  FacetSurface<D> surface;                                           ///< the facets
  FacetQuadrature<D> quadrature;                                     ///< 2 Gauss points along each side
  std::vector<std::array<Vector3, FacetSurface<D>::corners>> force;  ///< of each facet on its nodes
  std::vector<double> value;                                         ///< of each facet
  std::vector<double> smallest;  ///< δ of each facet's points, in the unit of their area vectors: |c| counts as √(|c|² + δ²); empty: 0

  /// From the facets of a cloud. Throws GeometryError for a cloud without facets or with periodic directions.
  void initialize(const PointCloud<D>& cloud, const ParticleFields& body);

  /// Lets δ be a share of what |c| is at the present positions.
  void smooth(double share, std::span<const Vector4> x) {
    for (Index f = 0; f < surface.facets.size(); ++f)
      for (const auto& point : quadrature.points) smallest.push_back(share * surface.tangents(f, point.local, x).area_vector().norm());
  }
  /// √(|c|² + δ²) of the area vector c at point k of facet f.
  [[nodiscard]] double size(Index f, std::size_t k, const Vector3& c) const {
    const double delta = smallest.empty() ? 0.0 : smallest[f * quadrature.points.size() + k];
    return std::sqrt(c.squaredNorm() + delta * delta);
  }

  /// Adds the forces per facet to the particles and returns the sum of the values.
  double gather(const ParticleFields& body) const;

  /// For checkpoints: the values per facet, for who reads them before the next step, and δ, which redistribution changes.
  template <class Archive>
  void state(Archive& archive) {
    archive("value", value);
    archive("smallest", smallest);
  }
};

namespace detail {

/// Area (length, area of the ring) of facet `f` and its gradient in the facet's nodes.
template <int D>
double facet_area(const SurfaceIntegral<D>& s, Index f, std::span<const Vector4> x,
                  std::array<Vector3, FacetSurface<D>::corners>& gradient);

/// Calls emit(i, j, K) with the second derivative of `tension` × area in the nodes of every facet.
template <int D, class Emit>
void add_area_stiffness(const SurfaceIntegral<D>& s, const ParticleFields& body, double tension, const Emit& emit) {
  constexpr std::size_t corners = FacetSurface<D>::corners;
  for (Index f = 0; f < s.surface.facets.size(); ++f) {
    std::array<std::array<Tensor3, corners>, corners> K;
    for (auto& row : K) row.fill(Tensor3::Zero());
    for (std::size_t p = 0; p < s.quadrature.points.size(); ++p) {
      const auto& point = s.quadrature.points[p];
      const FacetTangents tangents = s.surface.tangents(f, point.local, body.position);
      const auto second = area_curvatures(s.surface, point.local, tangents, s.size(f, p, tangents.area_vector()));
      for (std::size_t k = 0; k < corners; ++k)
        for (std::size_t l = 0; l < corners; ++l) K[k][l] += tension * point.weight * second[k][l];
    }
    for (std::size_t k = 0; k < corners; ++k)
      for (std::size_t l = 0; l < corners; ++l) emit(s.surface.facets[f][k], s.surface.facets[f][l], K[k][l]);
  }
}

}  // namespace detail

/// Row sums of the stiffness (second derivative) of σ₀ A over the masses: Gershgorin's bound of ω², 1/s².
template <int D>
[[nodiscard]] double area_stiffness_rate(const SurfaceIntegral<D>& s, const ParticleFields& body, double tension);

/// Surface tension as the gradient of the surface energy σ₀ A (plane: σ₀ times the length, per thickness): the force at
/// a particle is −σ₀ ∂A/∂x, with A integrated over the bilinear facets by 2×2 Gauss points. In the limit it is the
/// traction −σ₀ κ n of Zeng and Li, Soft Matter 2012, 8, 5765, eqn (17). Exactly conservative: net force (of rings: along the axis) and torque
/// are zero to round-off. A BoundaryTerm in 2 and 3 dimensions.
struct SurfaceTension {
  static constexpr Reads reads = Reads::facets;  ///< the surface
  double tension = 0.072e-3;                 ///< σ₀, N/m
  /// Share of its first size below which a facet resists less and less to vanish, in [0, 1): |c| counts as √(|c|² + δ²). The force of a facet
  /// that vanishes jumps, to the other side, and no implicit step finds its way there; a facet of its first size pulls by ½ share² less.
  double smoothing = 0.0;
  PerDimension<SurfaceIntegral> integral{};  ///< set by initialize()

  /// Throws ParameterError unless tension >= 0 and smoothing is in [0, 1).
  void validate() const {
    require_non_negative("SurfaceTension.tension", tension, "N/m");
    if (!(smoothing >= 0.0 && smoothing < 1.0)) reject("SurfaceTension.smoothing", smoothing, "", "in [0, 1)");
  }

  /// Throws ParameterError as validate(), GeometryError for a cloud without facets or with periodic directions.
  template <int D>
    requires(D >= 2)
  void initialize(const PointCloud<D>& cloud, const ParticleFields& body);

  /// Facets have new sizes now, of which `smoothing` is a share.
  void redistribute(const SurfaceTransfer&, const ParticleFields& body);

  /// Adds −σ₀ ∂A/∂x_I and returns σ₀ A.
  TermEnergy apply(const ParticleFields& body, double);

  /// The exact second derivative of σ₀ A.
  template <class Emit>
  void add_stiffness(const ParticleFields& body, const Emit& emit) const {
    integral.visit([&](const auto& s) { detail::add_area_stiffness(s, body, tension, emit); });
  }

  /// Gershgorin's bound, see area_stiffness_rate.
  [[nodiscard]] double stiffness_rate(const ParticleFields& body) const;

  /// Current area of the surface, m² (plane: length, m), at the last call of apply; tension must be positive. With `smoothing` a little more.
  [[nodiscard]] double area() const;
  /// For checkpoints: the area.
  template <class Archive>
  void state(Archive& archive) { archive.part("integral", integral); }
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/boundary/surface_tension.ipp>
#endif
