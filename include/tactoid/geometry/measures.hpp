#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
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
[[nodiscard]] std::vector<NodalCell<D>> nodal_cells(const PointCloud<D>& cloud) {
  constexpr std::size_t corners_per_cell = 1u << D;
  std::vector<NodalCell<D>> parts(cloud.cells.size() * corners_per_cell);  // centroid: first moment around the particle
  parallel_for(cloud.cells.size(), [&](std::size_t c) {
    const Corners<D> corners = cell_corners(cloud, cloud.cells[c]);
    for (std::size_t a = 0; a < corners_per_cell; ++a) {
      NodalCell<D>& part = parts[c * corners_per_cell + a];
      part.particle = cloud.cells[c][a];
      part.region = cloud.cell_regions[c];
      Point<D> lower;
      for (int k = 0; k < D; ++k) lower[k] = ((a >> k) & 1u) != 0 ? 0.5 : 0.0;
      // det of degree 2 and X det of degree 3 in each variable: two points per direction are exact.
      for_each_gauss_point<2, D>(lower, 0.5, [&](const Point<D>& xi, double weight) {
        const double dv = weight * cell_jacobian<D>(corners, xi).determinant();
        part.volume += dv;
        part.centroid += dv * (cell_position<D>(corners, xi) - corners[a]);
      });
    }
  });
  std::vector<std::size_t> order(parts.size());  // by particle, region and cell: sums in a fixed order
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (parts[a].particle != parts[b].particle) return parts[a].particle < parts[b].particle;
    if (parts[a].region != parts[b].region) return parts[a].region < parts[b].region;
    return a < b;
  });
  std::vector<NodalCell<D>> nodal;
  nodal.reserve(cloud.size());
  for (const std::size_t p : order) {
    const NodalCell<D>& part = parts[p];
    if (nodal.empty() || nodal.back().particle != part.particle || nodal.back().region != part.region) {
      nodal.push_back(part);
    } else {
      nodal.back().volume += part.volume;
      nodal.back().centroid += part.centroid;
    }
  }
  for (NodalCell<D>& cell : nodal) {
    cell.centroid = cloud.positions[cell.particle] + cell.centroid / cell.volume;
    cell.volume *= cloud.circumference(cell.centroid);
  }
  return nodal;
}

/// Nodal volume ΔV_I of every particle over all regions, m³ (m², m).
template <int D>
[[nodiscard]] std::vector<double> nodal_volumes(const PointCloud<D>& cloud) {
  std::vector<double> volumes(cloud.size(), 0.0);
  for (const NodalCell<D>& cell : nodal_cells(cloud)) volumes[cell.particle] += cell.volume;
  return volumes;
}

/// b_I = ∮ N_I n dA over the (bi)linear facets, m² (m, 1): zero inside. Exact, and consistent with the cells:
/// Σ_I b_I = 0 and, without periodic directions, Σ_I b_I ⊗ X_I = V 1. (In a meridian section n dA is that of the ring, and the
/// sums are those of ∇·(R …)/R: Σ_I b_I = 2π A e_R with the area A of the section.)
template <int D>
[[nodiscard]] std::vector<Point<D>> boundary_normal_integrals(const PointCloud<D>& cloud) {
  std::vector<Point<D>> integrals(cloud.size(), Point<D>::Zero());
  if constexpr (D == 1) {
    for (const auto& cell : cloud.cells) {  // the two ends of a cell; inside they cancel
      integrals[cell[0]][0] -= 1.0;
      integrals[cell[1]][0] += 1.0;
    }
  } else if constexpr (D == 2) {
    for (const auto& facet : cloud.facets) {
      const Point<2> half = 0.5 * facet_vector_area(cloud, facet);
      const auto x = facet_corners(cloud, facet);
      for (std::size_t a = 0; a < 2; ++a)  // the mean of the circumference, weighted by N_a
        integrals[facet[a]] += half * (2.0 * cloud.circumference(x[a]) + cloud.circumference(x[1 - a])) / 3.0;
    }
  } else {
    for (const auto& facet : cloud.facets) {
      const auto x = facet_corners(cloud, facet);
      // ∂x/∂s × ∂x/∂t has degree 1 and N_I degree 1 in each variable: 2 × 2 points are exact.
      for_each_gauss_point<2, 2>(Point<2>::Zero(), 1.0, [&](const Point<2>& s, double weight) {
        const Point<3> along_s = (1.0 - s[1]) * (x[1] - x[0]) + s[1] * (x[3] - x[2]);
        const Point<3> along_t = (1.0 - s[0]) * (x[2] - x[0]) + s[0] * (x[3] - x[1]);
        const Point<3> area = weight * along_s.cross(along_t);
        for (std::size_t a = 0; a < 4; ++a) integrals[facet[a]] += corner_function<2>(a, s) * area;
      });
    }
  }
  return integrals;
}

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
[[nodiscard]] std::vector<double> longest_edges(const PointCloud<D>& cloud) {
  std::vector<double> longest(cloud.size(), 0.0);
  detail::for_each_edge(cloud, [&](Index a, Index b, double length) {
    longest[a] = std::max(longest[a], length);
    longest[b] = std::max(longest[b], length);
  });
  return longest;
}

/// Shortest cell edge that ends at each particle, m; infinite for a particle without cells.
template <int D>
[[nodiscard]] std::vector<double> shortest_edges(const PointCloud<D>& cloud) {
  std::vector<double> shortest(cloud.size(), std::numeric_limits<double>::infinity());
  detail::for_each_edge(cloud, [&](Index a, Index b, double length) {
    shortest[a] = std::min(shortest[a], length);
    shortest[b] = std::min(shortest[b], length);
  });
  return shortest;
}

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
[[nodiscard]] double volume(const PointCloud<D>& cloud) {
  double sum = 0.0;
  for (const CellPoint<D>& point : gauss_points<2>(cloud)) sum += point.weight;
  return sum;
}

}  // namespace tactoid
