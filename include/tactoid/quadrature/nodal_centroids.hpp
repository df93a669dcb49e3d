#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>
#include <tuple>
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
#include <tactoid/quadrature/divided_build.hpp>
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
  void validate() const;

  /// Of a region whose law has this shear modulus, Pa; 0 is a fluid.
  [[nodiscard]] Stabilization stabilization(double shear_modulus) const {
    if (shear_modulus > 0.0) return {solid_ratio * shear_modulus, solid_damping_time};
    return {fluid_modulus, fluid_modulus > 0.0 ? fluid_viscosity / fluid_modulus : 0.0};
  }

  /// The table of a cloud; with `divided`, of which each rank makes its own rows. Throws ParameterError; GeometryError where a moment matrix is singular or beyond
  /// condition_limit, naming point and neighbours; ComputationError where the columns cannot be made consistent.
  template <Kernel K>
  [[nodiscard]] PointTable build(const PointCloud<K::dimension>& cloud, const K& kernel, DividedBuild* divided = nullptr) const {
    validate();
    std::vector<NodalCell<K::dimension>> cells = nodal_cells(cloud);
    const CloudPart* const part = cloud.part.get();  // own points come first in each region, and particles that lack cells have none
    if (part != nullptr) std::erase_if(cells, [&](const auto& cell) { return !part->complete[cell.particle]; });
    std::sort(cells.begin(), cells.end(), [&](const auto& a, const auto& b) {
      const auto place = [&](const auto& cell) { return std::tuple(cell.region, part != nullptr && !part->is_own(cell.particle), cell.particle); };
      return place(a) < place(b);
    });
    std::vector<double> spacing = longest_edges(cloud);
    if (part != nullptr) {
      if (divided != nullptr) divided->together([&] { take_spacings(*part, kernel.support, spacing); });
      else take_spacings(*part, kernel.support, spacing);
    }
    return table_of<K::dimension>(cloud, kernel.support, rows_of(kernel), cells, spacing, false, divided);
  }

  /// The table of a cloud that has moved, with the points and the volumes that moved with it: `cells`, sorted by region. Only
  /// particles and facets of the cloud are used; supports follow the particles (neighbor_spacings). Volumes that have been carried along are not quite
  /// those of the cells, so the integrals over the boundary are fitted to them (fit_boundary). Throws what build() throws, and
  /// ParameterError for a periodic cloud.
  template <Kernel K>
  [[nodiscard]] PointTable build_moved(const PointCloud<K::dimension>& cloud, const K& kernel,
                                       const std::vector<NodalCell<K::dimension>>& cells) const {
    if (!cloud.period.isZero()) throw ParameterError("NodalCentroids.build_moved: a periodic cloud keeps its reference.");
    return table_of<K::dimension>(cloud, kernel.support, rows_of(kernel), cells, neighbor_spacings(cloud), true, nullptr);
  }

 private:
  /// What a kernel makes of the particles around a point.
  template <int D>
  struct RowOfPoint {
    std::vector<Point<D>> gradient;  // value-based, 1/m
    std::vector<double> mass_share;  // linear shape functions
    std::vector<double> weight;      // of the window
    double condition = 0.0;          // of the moment matrix
  };
  template <int D>
  using RowsOf = std::function<void(std::span<const KernelNeighbor<D>>, RowOfPoint<D>&)>;

  template <Kernel K>
  [[nodiscard]] static RowsOf<K::dimension> rows_of(const K& kernel) {
    constexpr int D = K::dimension;
    return [kernel](std::span<const KernelNeighbor<D>> near, RowOfPoint<D>& row) {
      row.condition = kernel.direct_gradient(near, row.gradient);
      detail::Reproducing<D, 1, typename K::Window, false>(near).values(row.mass_share);
      row.weight.clear();
      for (const KernelNeighbor<D>& n : near) row.weight.push_back(K::Window::value(n.offset.norm() / n.support));
    };
  }

  /// Spacings of particles that lack cells, as they are in the whole. Throws ParameterError where the part was not made for supports as large as those here.
  static void take_spacings(const CloudPart& part, double support, std::vector<double>& spacing);

  template <int D>
  [[nodiscard]] PointTable table_of(const PointCloud<D>& cloud, double support, const RowsOf<D>& rows_of_points,
                                    const std::vector<NodalCell<D>>& cells, const std::vector<double>& spacing, bool moved, DividedBuild* divided) const;

  /// Gradients, shares of the mass and weights of the window (beside the entries) for the rows of a table that is laid out.
  template <int D>
  void fill_rows(PointTable& table, std::vector<double>& weights, const PointCloud<D>& cloud, const std::vector<double>& supports, const RowsOf<D>& rows_of_points,
                 const RowsToMake& rows) const;
  /// The rows that stand for all in the consistency of a divided table.
  template <int D>
  [[nodiscard]] PointTable sampled_rows(const PointTable& table, std::vector<double>& weights, const PointCloud<D>& cloud, const std::vector<double>& supports,
                                        const RowsOf<D>& rows_of_points, const DividedBuild::Find& find) const;

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
  void weigh_stabilization(PointTable& table, const PointCloud<D>& cloud, const std::vector<double>& spacing) const;
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/quadrature/nodal_centroids.ipp>
#endif
