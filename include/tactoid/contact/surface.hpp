#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid {

/// Marks "no facet", as beyond the rim of an open surface.
inline constexpr Index no_facet = ~Index{0};

/// Tangents of a facet at a point: ∂x/∂s and ∂x/∂t for s, t ∈ [0, 1]. In two dimensions ∂x/∂t is the unit vector
/// out of the plane, times the circumference 2πr in a meridian section, so that the same cross product gives the outward
/// normal and the element of length, or of the ring's area.
struct FacetTangents {
  Vector3 s;  ///< ∂x/∂s, m
  Vector3 t;  ///< ∂x/∂t, m (D = 2: 1, or m of the circumference)
  /// ∂x/∂s × ∂x/∂t: outward, its length is the surface element da/(ds dt), m² (plane: m).
  [[nodiscard]] Vector3 area_vector() const { return s.cross(t); }
};

/// The boundary of a body as facets: segments (D = 2) or bilinear quadrilaterals (D = 3), with who touches whom.
/// The facets of a cloud never change; positions are handed in with each call, one per particle of the body, so
/// the same object serves the reference and every deformed configuration. The axis of a meridian section is no surface.
template <int D>
struct FacetSurface {
  static_assert(D == 2 || D == 3, "Surfaces exist in 2 and 3 dimensions.");
  static constexpr int dimension = D;                                 ///< D
  static constexpr std::size_t corners = 1u << (D - 1);  ///< nodes of a facet
  static constexpr std::size_t sides = D == 2 ? 2 : 4;   ///< end points (D = 2) or edges (D = 3)
  using Facet = typename PointCloud<D>::Facet;                        ///< numbers of its nodes
  using Local = std::array<double, static_cast<std::size_t>(D - 1)>;  ///< (s) or (s, t), each in [0, 1]
  using Shape = std::array<double, corners>;                          ///< one number per node of a facet

  std::vector<Facet> facets;       ///< nodes of each facet, in the order of PointCloud
  std::vector<Index> nodes;        ///< particles on the surface, ascending
  std::vector<Index> ring_start;   ///< per particle: where its facets start in `ring` (one entry more than particles)
  std::vector<Index> ring;         ///< facets around each particle, ascending
  std::vector<double> nodal_area;  ///< per particle: reference area ∫ N_I dA, m² (plane: m); 0 inside the body
  std::vector<std::array<Index, sides>> side_neighbors;  ///< per facet: who shares its sides, or no_facet
  bool closed = false;                                   ///< every edge has a facet on both sides, or is on the axis
  bool axisymmetric = false;                             ///< segments of a meridian: each stands for its ring

  FacetSurface() = default;

  /// Throws GeometryError for a cloud without facets, or with periodic directions (its facets would wrap around).
  explicit FacetSurface(const PointCloud<D>& cloud);

  [[nodiscard]] static Local make_local(double s, [[maybe_unused]] double t) {  ///< (s) for D = 2, (s, t) for D = 3
    if constexpr (D == 2)
      return {s};
    else
      return {s, t};
  }

  /// Shape functions N_a(s, t) of the facet's nodes; they sum to 1.
  [[nodiscard]] static Shape shape(const Local& l) {
    if constexpr (D == 2)
      return {1.0 - l[0], l[0]};
    else
      return {(1.0 - l[0]) * (1.0 - l[1]), l[0] * (1.0 - l[1]), (1.0 - l[0]) * l[1], l[0] * l[1]};
  }
  /// ∂N_a/∂s and ∂N_a/∂t (the latter zero for D = 2).
  [[nodiscard]] static Shape shape_s(const Local& l) {
    if constexpr (D == 2)
      return {-1.0, 1.0};
    else
      return {-(1.0 - l[1]), 1.0 - l[1], -l[1], l[1]};
  }
  /// ∂N_a/∂t; zero for D = 2.
  [[nodiscard]] static Shape shape_t(const Local& l) {
    if constexpr (D == 2)
      return {0.0, 0.0};
    else
      return {-(1.0 - l[0]), -l[0], 1.0 - l[0], l[0]};
  }

  /// A nodal field at a point of a facet: Σ N_a v_a.
  [[nodiscard]] Vector4 interpolate(Index facet, const Local& local, std::span<const Vector4> values) const;

  /// Tangents at a point of a facet, with the particles at `x` (m).
  [[nodiscard]] FacetTangents tangents(Index facet, const Local& local, std::span<const Vector4> x) const {
    const Facet& c = facets[facet];
    if constexpr (D == 2) {
      const double r = (1.0 - local[0]) * x[c[0]][0] + local[0] * x[c[1]][0];
      return {Vector3((x[c[1]] - x[c[0]]).template head<3>()), (axisymmetric ? 2.0 * std::numbers::pi * r : 1.0) * Vector3::UnitZ()};
    } else {
      const Vector4 along_s = (1.0 - local[1]) * (x[c[1]] - x[c[0]]) + local[1] * (x[c[3]] - x[c[2]]);
      const Vector4 along_t = (1.0 - local[0]) * (x[c[2]] - x[c[0]]) + local[0] * (x[c[3]] - x[c[1]]);
      return {Vector3(along_s.template head<3>()), Vector3(along_t.template head<3>())};
    }
  }

  /// Rates of the tangents for the velocities v of the particles.
  [[nodiscard]] FacetTangents tangent_rates(Index facet, const Local& local, std::span<const Vector4> v) const {
    FacetTangents rates = tangents(facet, local, v);
    if (D == 2 && !axisymmetric) rates.t.setZero();
    return rates;
  }

  /// ∂(2πr)/∂r_a at a point of a meridian: how far the second tangent follows the radial places of the nodes; zero elsewhere.
  [[nodiscard]] Shape circumference_slopes(const Local& local) const;

  /// Unit outward normal at a point of a facet.
  [[nodiscard]] Vector3 normal(Index facet, const Local& local, std::span<const Vector4> x) const {
    if constexpr (D == 2) {  // also on the axis, where the ring has no length
      const Vector4 along = x[facets[facet][1]] - x[facets[facet][0]];
      return Vector3(along[1], -along[0], 0.0).normalized();
    } else {
      return tangents(facet, local, x).area_vector().normalized();
    }
  }

  /// Facets around particle `node`.
  [[nodiscard]] std::span<const Index> facets_of(Index node) const {
    return {ring.data() + ring_start[node], ring.data() + ring_start[node + 1]};
  }

  /// Corners at the two ends of side `k`. Sides of a quadrilateral: t = 0, t = 1, s = 0, s = 1; a side of a segment is
  /// one of its end points.
  [[nodiscard]] static constexpr std::array<std::size_t, 2> side_corners(std::size_t k) {
    if constexpr (D == 2) return {k, k};
    constexpr std::array<std::array<std::size_t, 2>, 4> of = {{{0, 1}, {2, 3}, {0, 2}, {1, 3}}};
    return of[k];
  }

  /// The facets that share a side with facet `f`: no_facet where there is none.
  [[nodiscard]] const std::array<Index, sides>& neighbors_of(Index f) const { return side_neighbors[f]; }

  /// The facet on the other side of the edge a–b of `facet`; no_facet at the rim of an open surface (D = 3).
  [[nodiscard]] Index across(Index facet, Index a, Index b) const {
    for (const Index f : facets_of(a))
      if (f != facet && std::find(facets[f].begin(), facets[f].end(), b) != facets[f].end()) return f;
    return no_facet;
  }

 private:
  void build_rings(const PointCloud<D>& cloud);
};

/// Gauss points on the facets of a surface, with weights of the reference configuration.
template <int D>
struct FacetQuadrature {
  using Local = typename FacetSurface<D>::Local;  ///< place on a facet
  /// A Gauss point of the unit facet.
  struct FacetPoint {
    Local local;                            ///< where on the facet
    typename FacetSurface<D>::Shape shape;  ///< N_a there
    double weight;                          ///< Gauss weight on the unit facet (they sum to 1)
  };
  std::vector<FacetPoint> points;  ///< the same on every facet
  std::vector<double> area;        ///< per facet and point (facet-major): reference area it stands for, m² (plane: m)

  FacetQuadrature() = default;

  /// `per_direction` Gauss points along each side, 1 to 4. Throws ParameterError outside of that.
  FacetQuadrature(const FacetSurface<D>& surface, std::span<const Vector4> reference, int per_direction);

  /// The weights of the points of a facet.
  [[nodiscard]] std::vector<double> weights() const {
    std::vector<double> list;
    for (const FacetPoint& point : points) list.push_back(point.weight);
    return list;
  }
  [[nodiscard]] std::size_t size() const { return area.size(); }  ///< number of points on all facets
  /// Facet of point q.
  [[nodiscard]] Index facet_of(std::size_t q) const { return static_cast<Index>(q / points.size()); }
  /// Point q on its facet.
  [[nodiscard]] const FacetPoint& point(std::size_t q) const { return points[q % points.size()]; }

 private:
  struct Rule {
    std::array<double, 4> x, w;
  };
  static Rule rule(int n);
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/surface.ipp>
#endif
