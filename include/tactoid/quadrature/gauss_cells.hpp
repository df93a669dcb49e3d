#pragma once

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/kernel/kernel.hpp>
#include <tactoid/kernel/support.hpp>
#include <tactoid/neighbors/neighbor_table.hpp>
#include <tactoid/quadrature/coloring.hpp>
#include <tactoid/quadrature/quadrature.hpp>
#include <tactoid/quadrature/rows.hpp>

namespace tactoid {

/// Galerkin integration with the kernel's own shape functions at N Gauss points per direction of the background
/// cells. The unknowns are coefficients: the field at a particle is Σ_J φ_J(X_I) u_J.
///
/// Linear completeness holds at every point, but the quadrature of rational shape functions is not exact, so
/// the patch test holds only approximately, and a single point per cell leaves zero-energy modes. Use it for
/// statics and for comparison; NodalCentroids is the rule for long dynamic runs.
template <int N = 2>
struct GaussCells {
  static_assert(N >= 1 && N <= 3, "GaussCells takes 1, 2 or 3 points per direction.");
  double condition_limit = 1e10;      ///< largest condition number of a moment matrix that is accepted
  std::size_t points_per_chunk = 0;  ///< points that one thread adds at a time; 0: by the size of the body

  /// Throws ParameterError unless condition_limit > 0.
  void validate() const { require_positive("GaussCells.condition_limit", condition_limit); }

  [[nodiscard]] Stabilization stabilization(double) const { return {}; }  ///< none: the rule is used as it is

  /// The table of a cloud, with φ_I(X_q) and φ_J(X_I). Throws ParameterError, and GeometryError where a moment matrix
  /// is singular or beyond condition_limit.
  template <Kernel K>
  [[nodiscard]] PointTable build(const PointCloud<K::dimension>& cloud, const K& kernel) const {
    constexpr int D = K::dimension;
    validate();
    std::vector<CellPoint<D>> points = gauss_points<N>(cloud);
    // Cell after cell within each region; gauss_points gives the cells in order.
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return std::pair(points[a].region, a) < std::pair(points[b].region, b);
    });
    const std::vector<double> supports = support_radii(kernel, cloud);
    const std::vector<double> volumes = nodal_volumes(cloud);

    PointTable table = empty_table(cloud);
    std::vector<Point<D>> positions;
    for (const std::size_t k : order) {
      const CellPoint<D>& point = points[k];
      positions.push_back(point.position);
      table.position.push_back(pad(point.position).template head<3>());
      table.volume.push_back(point.weight);
      table.region.push_back(point.region);
    }
    table.owner.resize(points.size());
    const NeighborTable neighbors = neighbor_table(cloud, positions, supports);
    lay_out_rows(table, neighbors);
    table.point_values.assign(table.pairs(), 0.0);
    auto shape_functions = [&](const Point<D>& x, std::span<const Index> row, ShapeFunctions<D>& shape) {
      std::vector<KernelNeighbor<D>> near;
      for (Index i : row) near.push_back({cloud.difference(x, cloud.positions[i]), supports[i], volumes[i]});
      kernel.shape_functions(near, shape);
    };
    parallel_for(points.size(), [&](std::size_t q) {
      ShapeFunctions<D> shape;
      const auto row = neighbors.row(q);
      shape_functions(positions[q], row, shape);
      check_condition(q, table.position[q], row.size(), shape.condition, condition_limit);
      for (std::size_t k = 0; k < row.size(); ++k) {
        const std::size_t e = table.offsets[q] + k;
        for (int d = 0; d < D; ++d) table.entries[e].gradient[d] = shape.gradient[k][d];
        if (cloud.axisymmetric) table.entries[e].gradient[2] = shape.value[k] / positions[q][0];
        table.point_values[e] = shape.value[k];
      }
      table.owner[q] = row[static_cast<std::size_t>(std::max_element(shape.value.begin(), shape.value.end()) - shape.value.begin())];
    });
    const NeighborTable around = neighbor_table(cloud, cloud.positions, supports);
    table.particle_values.offsets.assign(around.offsets.begin(), around.offsets.end());
    table.particle_values.particles.assign(around.indices.begin(), around.indices.end());
    table.particle_values.values.resize(around.indices.size());
    parallel_for(cloud.size(), [&](std::size_t i) {
      ShapeFunctions<D> shape;
      const auto row = around.row(i);
      shape_functions(cloud.positions[i], row, shape);
      check_condition(i, table.particle_position[i].template head<3>(), row.size(), shape.condition, condition_limit);
      std::copy(shape.value.begin(), shape.value.end(),
                table.particle_values.values.begin() + static_cast<std::ptrdiff_t>(around.offsets[i]));
    });
    color_chunks(table, points_per_chunk);
    return table;
  }

};

}  // namespace tactoid
