#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/kernel/kernel.hpp>
#include <tactoid/kernel/reproducing.hpp>
#include <tactoid/kernel/support.hpp>
#include <tactoid/neighbors/neighbor_table.hpp>
#include <tactoid/quadrature/coloring.hpp>
#include <tactoid/quadrature/consistency.hpp>
#include <tactoid/quadrature/quadrature.hpp>
#include <tactoid/quadrature/rows.hpp>

namespace tactoid {

/// Nodal integration at the centroids of the nodal cells, integration-consistent and stabilised: the default.
///
/// - One quadrature point per particle (and region, where regions meet in a particle), at the centroid of the
///   part of its nodal cell that lies in the region; its weight is the volume of that part. The nodal cell is an
///   eighth (in 3D) of each adjacent background cell.
/// - The gradient there is the value-based one of the kernel, G_qI = w [M⁻¹ p(X_I − X_q)]_{1..D}, exact for
///   linear fields, corrected once so that the divergence theorem holds for the discrete integral
///   (make_consistent): linear patch test to round-off.
/// - The stabilising energy of particle I, owner of q, is
///     ½ c V_q (D / Σ_J w_J |ΔX_J|²) Σ_J w_J |Δu_J − (F_q − 1) ΔX_J|²,   Δ_J from the particle (not the centroid),
///   varied exactly. It vanishes for affine fields and leaves six zero modes in 3D (three in 2D). Its pairs are the
///   nearest particles: w_J = 1 − (|ΔX_J| / (`stabilization_reach` × spacing of J))², 0 beyond. Short bonds act on the
///   shortest waves, which are the spurious ones; the whole support costs more and separates them less.
///   c = `solid_ratio` × the shear modulus of the law, or `fluid_modulus` where the law has none.
/// - In a meridian section the same holds for the rings: V_q = 2π ∫ R dA with the centroid of the part of the section, the
///   field at a point, of the stretch around the axis 1 + u_R/R, is the one of the linear shape functions, and the divergence
///   theorem includes that stretch.
/// - The mass of a point goes to its neighbours by linear shape functions φ_I(X_q): mass and centre of mass of the
///   body are exact. They are linear for a quadratic basis too, whose shares can be negative at corners.
struct NodalCentroids {
  double solid_ratio = 0.12;            ///< stabilisation modulus over shear modulus, in solids; >= 0
  double stabilization_reach = 1.25;    ///< of the bonds of the stabilisation, in spacings (longest edges) of a particle; > 1
  double solid_damping_time = 2e-9;     ///< stabilisation viscosity over modulus, in solids, s; >= 0
  /// Stabilisation modulus in laws without a shear modulus, Pa; >= 0. It is tied to the reference shape, which a fluid
  /// has not. Below the stresses of interest it carries no load (5 Pa in the spreading examples); above the pressures it
  /// keeps the currents of the discretisation small, and holds a fluid of little viscosity together.
  double fluid_modulus = 500.0;
  double fluid_viscosity = 2.5e-5;      ///< stabilisation viscosity there, Pa s; >= 0; without effect where the modulus is 0
  double condition_limit = 1e10;        ///< largest condition number of a moment matrix that is accepted
  double consistency_tolerance = 1e-13; ///< of the column conditions; 0: no correction (for comparisons only)
  std::size_t points_per_chunk = 0;  ///< points that one thread adds at a time; 0: by the size of the body

  /// Throws ParameterError for a value that is not in its range.
  void validate() const {
    require_non_negative("NodalCentroids.solid_ratio", solid_ratio);
    if (!(stabilization_reach > 1.0) || !std::isfinite(stabilization_reach))
      reject("NodalCentroids.stabilization_reach", stabilization_reach, "", "above 1");
    require_non_negative("NodalCentroids.fluid_modulus", fluid_modulus, "Pa");
    require_non_negative("NodalCentroids.solid_damping_time", solid_damping_time, "s");
    require_non_negative("NodalCentroids.fluid_viscosity", fluid_viscosity, "Pa s");
    require_positive("NodalCentroids.condition_limit", condition_limit);
    require_non_negative("NodalCentroids.consistency_tolerance", consistency_tolerance);
  }

  /// Of a region whose law has this shear modulus, Pa; 0 is a fluid.
  [[nodiscard]] Stabilization stabilization(double shear_modulus) const {
    if (shear_modulus > 0.0) return {solid_ratio * shear_modulus, solid_damping_time};
    return {fluid_modulus, fluid_modulus > 0.0 ? fluid_viscosity / fluid_modulus : 0.0};
  }

  /// The table of a cloud. Throws ParameterError; GeometryError where a moment matrix is singular or beyond
  /// condition_limit, naming point and neighbours; ComputationError where the columns cannot be made consistent.
  template <Kernel K>
  [[nodiscard]] PointTable build(const PointCloud<K::dimension>& cloud, const K& kernel) const {
    validate();
    std::vector<NodalCell<K::dimension>> cells = nodal_cells(cloud);
    std::sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) {
      return std::pair(a.region, a.particle) < std::pair(b.region, b.particle);
    });
    return table_of(cloud, kernel, cells, longest_edges(cloud), false);
  }

  /// The table of a cloud that has moved, with the points and the volumes that moved with it: `cells`, sorted by region. Only
  /// particles and facets of the cloud are used; supports follow the particles (neighbor_spacings). Volumes that have been carried along are not quite
  /// those of the cells, so the integrals over the boundary are fitted to them (fit_boundary). Throws what build() throws, and
  /// ParameterError for a periodic cloud.
  template <Kernel K>
  [[nodiscard]] PointTable build_moved(const PointCloud<K::dimension>& cloud, const K& kernel,
                                       const std::vector<NodalCell<K::dimension>>& cells) const {
    if (!cloud.period.isZero()) throw ParameterError("NodalCentroids.build_moved: a periodic cloud keeps its reference.");
    return table_of(cloud, kernel, cells, neighbor_spacings(cloud), true);
  }

 private:
  template <Kernel K>
  [[nodiscard]] PointTable table_of(const PointCloud<K::dimension>& cloud, const K& kernel, const std::vector<NodalCell<K::dimension>>& cells,
                                    const std::vector<double>& spacing, bool moved) const {
    constexpr int D = K::dimension;
    std::vector<Point<D>> centroids(cells.size());
    for (std::size_t q = 0; q < cells.size(); ++q) centroids[q] = cells[q].centroid;
    std::vector<double> supports = spacing;
    for (double& support : supports) support *= kernel.support;

    PointTable table = empty_table(cloud);
    std::vector<double> weights;
    const NeighborTable neighbors = neighbor_table(cloud, centroids, supports);
    lay_out_rows(table, neighbors);
    weights.assign(table.pairs(), 0.0);
    table.mass_shares.assign(table.pairs(), 0.0);
    for (const NodalCell<D>& cell : cells) {
      table.volume.push_back(cell.volume);
      table.region.push_back(cell.region);
      table.owner.push_back(cell.particle);
      table.position.push_back(pad(cell.centroid).template head<3>());
    }
    parallel_for(cells.size(), [&](std::size_t q) {
      std::vector<KernelNeighbor<D>> near;
      std::vector<Point<D>> gradient;
      std::vector<double> shares;
      const auto row = neighbors.row(q);
      for (Index i : row) near.push_back({cloud.difference(centroids[q], cloud.positions[i]), supports[i], 1.0});
      const double condition = kernel.direct_gradient(near, gradient);
      check_condition(q, table.position[q], row.size(), condition, condition_limit);
      detail::Reproducing<D, 1, typename K::Window, false>(near).values(shares);
      for (std::size_t k = 0; k < row.size(); ++k) {
        const std::size_t e = table.offsets[q] + k;
        for (int d = 0; d < D; ++d) table.entries[e].gradient[d] = gradient[k][d];
        table.mass_shares[e] = shares[k];
        weights[e] = K::Window::value(near[k].offset.norm() / near[k].support);
      }
    });
    color_chunks(table, points_per_chunk);
    if (consistency_tolerance > 0.0) {
      const std::vector<Point<D>> normals = boundary_normal_integrals(cloud);
      Field boundary;
      for (const Point<D>& b : normals) boundary.push_back(pad(b));
      if (cloud.axisymmetric) take_off_hoops(table, boundary);
      if (moved) fit_boundary(table, normals, boundary);
      make_consistent(table, weights, boundary, consistency_tolerance);
    }
    if (cloud.axisymmetric)
      for (std::size_t q = 0; q < table.points(); ++q)
        for (std::size_t e = table.offsets[q]; e < table.offsets[q + 1]; ++e)
          table.entries[e].gradient[2] = table.mass_shares[e] / table.position[q][0];
    weigh_stabilization(table, cloud, spacing);
    return table;
  }

  /// What is left of ∮ N_I n dA for the gradients in a meridian section, where div(φ e_R) = ∂φ/∂R + φ/R:
  ///   Σ_q V_q G_qI = b_I − Σ_q V_q φ_I(X_q)/R_q e_R.
  /// An affine fit has nothing to add to it, since V_q/R_q is 2π times the part of the section that has its centroid in q.
  static void take_off_hoops(const PointTable& table, Field& boundary) {
    for (std::size_t q = 0; q < table.points(); ++q)
      for (std::size_t e = table.offsets[q]; e < table.offsets[q + 1]; ++e)
        boundary[table.entries[e].particle][0] -= table.volume[q] * table.mass_shares[e] / table.position[q][0];
  }

  /// Weights of the stabilisation; its pairs move to the front of each row.
  template <int D>
  void weigh_stabilization(PointTable& table, const PointCloud<D>& cloud, const std::vector<double>& spacing) const {
    table.stabilization_scale.assign(table.points(), 0.0);
    table.bond_offsets.assign(1, 0);
    std::vector<std::pair<TableEntry, double>> bonded, others;  // with their shares of the mass
    for (std::size_t q = 0; q < table.points(); ++q) {
      const Index owner = table.owner[q];
      std::size_t e = table.offsets[q];
      double moment = 0.0;
      bonded.clear(), others.clear();
      for (; e < table.offsets[q + 1] && !is_padding(table, q, e); ++e) {
        const Index particle = table.entries[e].particle;
        const double distance = cloud.difference(cloud.positions[owner], cloud.positions[particle]).norm();
        const double x = distance / (stabilization_reach * spacing[particle]);
        const bool bond = particle != owner && x < 1.0;
        (bond ? bonded : others).emplace_back(table.entries[e], table.mass_shares[e]);
        if (!bond) continue;
        table.bond_weights.push_back(static_cast<float>(1.0 - x * x));
        moment += static_cast<double>(table.bond_weights.back()) * distance * distance;
      }
      if (bonded.size() % 2 == 1) table.bond_weights.push_back(0.0F);
      table.bond_offsets.push_back(table.bond_weights.size());
      const bool padded = e < table.offsets[q + 1];
      e = table.offsets[q];
      for (const auto* part : {&bonded, &others})
        for (const auto& [entry, share] : *part) {
          table.entries[e] = entry;
          table.mass_shares[e++] = share;
        }
      if (padded) table.entries[e].particle = table.entries[table.offsets[q]].particle;
      table.stabilization_scale[q] = moment > 0.0 ? table.volume[q] * D / moment : 0.0;
    }
  }
};

}  // namespace tactoid
