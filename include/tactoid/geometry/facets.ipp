#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/geometry/facets.hpp>

namespace tactoid {

template <int D>
std::vector<typename PointCloud<D>::Facet> extract_facets(const PointCloud<D>& cloud) {
  using Facet = typename PointCloud<D>::Facet;
  struct Side {
    Facet key;  // sorted
    Facet facet;
    std::size_t order;
  };
  std::vector<Side> sides;
  sides.reserve(cloud.cells.size() * 2 * static_cast<std::size_t>(D));
  for (const auto& cell : cloud.cells) {
    for (int k = 0; k < D; ++k) {
      for (unsigned upper = 0; upper < 2; ++upper) {
        // Corners of the side in the order of the remaining axes. The outward normal of (axes ascending) is
        // +e_k for even parity: e_y × e_z = e_x, e_x × e_z = −e_y, e_x × e_y = e_z; in two dimensions the
        // tangent turned by −90° is e_y → e_x, e_x → −e_y.
        Facet facet;
        std::size_t a = 0;
        for (std::size_t corner = 0; corner < cell.size(); ++corner)
          if (((corner >> k) & 1u) == upper) facet[a++] = cell[corner];
        const bool even = k % 2 == 0;
        if constexpr (D > 1) {
          if (even != (upper == 1))
            for (std::size_t b = 0; b < facet.size(); b += 2) std::swap(facet[b], facet[b + 1]);
        }
        Facet key = facet;
        std::sort(key.begin(), key.end());
        sides.push_back({key, facet, sides.size()});
      }
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.key != b.key ? a.key < b.key : a.order < b.order; });
  std::vector<Side> single;
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t last = first + 1;
    while (last < sides.size() && sides[last].key == sides[first].key) ++last;
    if (last - first == 1) single.push_back(sides[first]);
    first = last;
  }
  std::sort(single.begin(), single.end(), [](const Side& a, const Side& b) { return a.order < b.order; });
  std::vector<Facet> facets;
  facets.reserve(single.size());
  for (const Side& side : single) facets.push_back(side.facet);
  return facets;
}

template <int D>
double facet_area(const PointCloud<D>& cloud, const typename PointCloud<D>::Facet& facet) {
  if constexpr (D == 1) {
    return 1.0;
  } else if constexpr (D == 2) {
    const auto x = facet_corners(cloud, facet);
    return facet_vector_area(cloud, facet).norm() * 0.5 * (cloud.circumference(x[0]) + cloud.circumference(x[1]));
  } else {
    const auto x = facet_corners(cloud, facet);
    double area = 0.0;
    for_each_gauss_point<3, 2>(Point<2>::Zero(), 1.0, [&](const Point<2>& s, double weight) {
      const Point<3> along_s = (1.0 - s[1]) * (x[1] - x[0]) + s[1] * (x[3] - x[2]);
      const Point<3> along_t = (1.0 - s[0]) * (x[2] - x[0]) + s[0] * (x[3] - x[1]);
      area += weight * along_s.cross(along_t).norm();
    });
    return area;
  }
}

template <int D>
double boundary_area(const PointCloud<D>& cloud) {
  double area = 0.0;
  for (const auto& facet : cloud.facets) area += facet_area(cloud, facet);
  return area;
}

template <int D>
std::vector<bool> on_boundary(const PointCloud<D>& cloud) {
  std::vector<bool> boundary(cloud.size(), false);
  for (const auto& facet : cloud.facets)
    for (const Index i : facet) boundary[i] = true;
  return boundary;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template std::vector<typename PointCloud<1>::Facet> extract_facets<1>(const PointCloud<1>& cloud);
template std::vector<typename PointCloud<2>::Facet> extract_facets<2>(const PointCloud<2>& cloud);
template std::vector<typename PointCloud<3>::Facet> extract_facets<3>(const PointCloud<3>& cloud);
template double facet_area<1>(const PointCloud<1>& cloud, const typename PointCloud<1>::Facet& facet);
template double facet_area<2>(const PointCloud<2>& cloud, const typename PointCloud<2>::Facet& facet);
template double facet_area<3>(const PointCloud<3>& cloud, const typename PointCloud<3>::Facet& facet);
template double boundary_area<1>(const PointCloud<1>& cloud);
template double boundary_area<2>(const PointCloud<2>& cloud);
template double boundary_area<3>(const PointCloud<3>& cloud);
template std::vector<bool> on_boundary<1>(const PointCloud<1>& cloud);
template std::vector<bool> on_boundary<2>(const PointCloud<2>& cloud);
template std::vector<bool> on_boundary<3>(const PointCloud<3>& cloud);
}  // namespace tactoid
#endif
