#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include <tactoid/core/parallel.hpp>
#include <tactoid/geometry/cell_map.hpp>
#include <tactoid/geometry/facets.hpp>

namespace tactoid {

/// The part of a region that belongs to one particle: the eighths (quarters, halves) in parametric space of the
/// adjacent cells of that region.
template <int D>
struct NodalCell {
  Index particle = 0;                         ///< to which it belongs
  Index region = 0;                           ///< index into PointCloud::regions
  double volume = 0.0;                        ///< m³ (m², m)
  Point<D> centroid = Point<D>::Zero();       ///< m; near the particle in periodic directions
};

/// Nodal cells of all particles, one per (particle, region), sorted by particle and region. Volumes and centroids
/// are exact integrals of the multilinear cells: the volumes sum to the volume of the polyhedron. In a meridian section the
/// volume is that of the ring, 2π ∫ R dA, and the centroid that of the part of the section.
template <int D>
[[nodiscard]] std::vector<NodalCell<D>> nodal_cells(const PointCloud<D>& cloud);

/// Nodal volume ΔV_I of every particle over all regions, m³ (m², m).
template <int D>
[[nodiscard]] std::vector<double> nodal_volumes(const PointCloud<D>& cloud);

/// b_I = ∮ N_I n dA over the (bi)linear facets, m² (m, 1): zero inside. Exact, and consistent with the cells:
/// Σ_I b_I = 0 and, without periodic directions, Σ_I b_I ⊗ X_I = V 1. (In a meridian section n dA is that of the ring, and the
/// sums are those of ∇·(R …)/R: Σ_I b_I = 2π A e_R with the area A of the section.)
template <int D>
[[nodiscard]] std::vector<Point<D>> boundary_normal_integrals(const PointCloud<D>& cloud);

namespace detail {

/// Calls visit(particle, particle, length) for the edges of all cells.
template <int D, class Visit>
void for_each_edge(const PointCloud<D>& cloud, const Visit& visit) {
  for (const auto& cell : cloud.cells)
    for (std::size_t a = 0; a < cell.size(); ++a)
      for (int k = 0; k < D; ++k)
        if (((a >> k) & 1u) == 0) {
          const std::size_t b = a | (std::size_t{1} << k);
          visit(cell[a], cell[b], cloud.difference(cloud.positions[cell[a]], cloud.positions[cell[b]]).norm());
        }
}

}  // namespace detail

/// Longest cell edge that ends at each particle, m: the local spacing that supports are measured in.
template <int D>
[[nodiscard]] std::vector<double> longest_edges(const PointCloud<D>& cloud);

/// Shortest cell edge that ends at each particle, m; infinite for a particle without cells.
template <int D>
[[nodiscard]] std::vector<double> shortest_edges(const PointCloud<D>& cloud);

/// A Gauss point of a background cell.
template <int D>
struct CellPoint {
  Point<D> position = Point<D>::Zero();  ///< m
  double weight = 0.0;                   ///< reference volume, m³ (m², m)
  Index cell = 0;                        ///< number of the cell
  Index region = 0;                      ///< of the cell, an index into PointCloud::regions
};

/// Gauss points of all cells, N per direction, cell by cell. N = 2 and 3 sum to the exact volume for D = 3; in
/// two dimensions N = 1 does too.
template <int N, int D>
[[nodiscard]] std::vector<CellPoint<D>> gauss_points(const PointCloud<D>& cloud) {
  std::vector<CellPoint<D>> points;
  for (std::size_t c = 0; c < cloud.cells.size(); ++c) {
    const Corners<D> corners = cell_corners(cloud, cloud.cells[c]);
    for_each_gauss_point<N, D>(Point<D>::Zero(), 1.0, [&](const Point<D>& xi, double weight) {
      const Point<D> X = cell_position<D>(corners, xi);
      points.push_back({X, weight * cell_jacobian<D>(corners, xi).determinant() * cloud.circumference(X),
                        static_cast<Index>(c), cloud.cell_regions[c]});
    });
  }
  return points;
}

/// Volume of the cells, m³ (m², m), exact for multilinear cells.
template <int D>
[[nodiscard]] double volume(const PointCloud<D>& cloud);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/measures.ipp>
#endif
