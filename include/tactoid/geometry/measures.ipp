#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/geometry/measures.hpp>

namespace tactoid {

template <int D>
std::vector<NodalCell<D>> nodal_cells(const PointCloud<D>& cloud) {
  constexpr std::size_t corners_per_cell = 1u << D;
  // det of degree 2 and X det of degree 3 in each variable: two Gauss points per direction of a corner's part are exact.
  struct Sample {
    double weight;
    CornerFunctions<D> functions;
    CornerSlopes<D> slopes;
  };
  std::array<std::vector<Sample>, corners_per_cell> samples;
  for (std::size_t a = 0; a < corners_per_cell; ++a) {
    Point<D> lower;
    for (int k = 0; k < D; ++k) lower[k] = ((a >> k) & 1u) != 0 ? 0.5 : 0.0;
    for_each_gauss_point<2, D>(lower, 0.5, [&](const Point<D>& xi, double weight) {
      samples[a].push_back({weight, corner_functions<D>(xi), corner_slopes<D>(xi)});
    });
  }
  std::vector<NodalCell<D>> parts(cloud.cells.size() * corners_per_cell);  // centroid: first moment around the particle
  parallel_for(cloud.cells.size(), [&](std::size_t c) {
    const Corners<D> corners = cell_corners(cloud, cloud.cells[c]);
    for (std::size_t a = 0; a < corners_per_cell; ++a) {
      NodalCell<D>& part = parts[c * corners_per_cell + a];
      part.particle = cloud.cells[c][a];
      part.region = cloud.cell_regions[c];
      for (const Sample& sample : samples[a]) {
        const double dv = sample.weight * cell_jacobian<D>(corners, sample.slopes).determinant();
        part.volume += dv;
        part.centroid += dv * (cell_position<D>(corners, sample.functions) - corners[a]);
      }
    }
  });
  // By particle, region and cell: sums in a fixed order.
  std::vector<std::size_t> first(cloud.size() + 1, 0), order(parts.size());
  for (const NodalCell<D>& part : parts) ++first[part.particle + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t p = 0; p < parts.size(); ++p) order[next[parts[p].particle]++] = p;
  parallel_for(cloud.size(), [&](std::size_t i) {
    const auto begin = order.begin() + static_cast<std::ptrdiff_t>(first[i]), end = order.begin() + static_cast<std::ptrdiff_t>(first[i + 1]);
    std::sort(begin, end, [&](std::size_t a, std::size_t b) { return std::pair(parts[a].region, a) < std::pair(parts[b].region, b); });
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

template <int D>
std::vector<double> nodal_volumes(const PointCloud<D>& cloud) {
  std::vector<double> volumes(cloud.size(), 0.0);
  for (const NodalCell<D>& cell : nodal_cells(cloud)) volumes[cell.particle] += cell.volume;
  return volumes;
}

template <int D>
std::vector<Point<D>> boundary_normal_integrals(const PointCloud<D>& cloud) {
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

template <int D>
std::vector<double> longest_edges(const PointCloud<D>& cloud) {
  std::vector<double> longest(cloud.size(), 0.0);
  detail::for_each_edge(cloud, [&](Index a, Index b, double length) {
    longest[a] = std::max(longest[a], length);
    longest[b] = std::max(longest[b], length);
  });
  return longest;
}

template <int D>
std::vector<double> shortest_edges(const PointCloud<D>& cloud) {
  std::vector<double> shortest(cloud.size(), std::numeric_limits<double>::infinity());
  detail::for_each_edge(cloud, [&](Index a, Index b, double length) {
    shortest[a] = std::min(shortest[a], length);
    shortest[b] = std::min(shortest[b], length);
  });
  return shortest;
}

template <int D>
double volume(const PointCloud<D>& cloud) {
  double sum = 0.0;
  for (const CellPoint<D>& point : gauss_points<2>(cloud)) sum += point.weight;
  return sum;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template std::vector<NodalCell<1>> nodal_cells<1>(const PointCloud<1>& cloud);
template std::vector<NodalCell<2>> nodal_cells<2>(const PointCloud<2>& cloud);
template std::vector<NodalCell<3>> nodal_cells<3>(const PointCloud<3>& cloud);
template std::vector<double> nodal_volumes<1>(const PointCloud<1>& cloud);
template std::vector<double> nodal_volumes<2>(const PointCloud<2>& cloud);
template std::vector<double> nodal_volumes<3>(const PointCloud<3>& cloud);
template std::vector<Point<1>> boundary_normal_integrals<1>(const PointCloud<1>& cloud);
template std::vector<Point<2>> boundary_normal_integrals<2>(const PointCloud<2>& cloud);
template std::vector<Point<3>> boundary_normal_integrals<3>(const PointCloud<3>& cloud);
template std::vector<double> longest_edges<1>(const PointCloud<1>& cloud);
template std::vector<double> longest_edges<2>(const PointCloud<2>& cloud);
template std::vector<double> longest_edges<3>(const PointCloud<3>& cloud);
template std::vector<double> shortest_edges<1>(const PointCloud<1>& cloud);
template std::vector<double> shortest_edges<2>(const PointCloud<2>& cloud);
template std::vector<double> shortest_edges<3>(const PointCloud<3>& cloud);
template double volume<1>(const PointCloud<1>& cloud);
template double volume<2>(const PointCloud<2>& cloud);
template double volume<3>(const PointCloud<3>& cloud);
}  // namespace tactoid
#endif
