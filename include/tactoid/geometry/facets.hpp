#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <tactoid/geometry/cell_map.hpp>

namespace tactoid {

/// The boundary of the cells: faces that belong to one cell only, oriented outwards as PointCloud says, in the
/// order of the cells. Faces on periodic planes are shared by the cells of both sides and are no boundary.
/// In one dimension a facet is the end particle.
template <int D>
[[nodiscard]] std::vector<typename PointCloud<D>::Facet> extract_facets(const PointCloud<D>& cloud);

/// The same cloud with those of its facets only all of whose particles satisfy a predicate of the reference position.
template <int D, class Predicate>
[[nodiscard]] PointCloud<D> with_facets_where(PointCloud<D> cloud, const Predicate& predicate) {
  std::erase_if(cloud.facets, [&](const auto& facet) {
    return !std::all_of(facet.begin(), facet.end(), [&](Index i) { return predicate(cloud.positions[i]); });
  });
  return cloud;
}

/// Vector area of a facet: ∫ n dA over the bilinear surface (m²; m for D = 2, in the section, where that is a
/// meridian). Not for D = 1, where a facet has no orientation of its own.
template <int D>
  requires(D > 1)
[[nodiscard]] Point<D> facet_vector_area(const PointCloud<D>& cloud, const typename PointCloud<D>::Facet& facet) {
  const auto x = facet_corners(cloud, facet);
  if constexpr (D == 2) {
    const Point<2> t = x[1] - x[0];
    return {t[1], -t[0]};
  } else {
    return 0.5 * (x[3] - x[0]).cross(x[2] - x[1]);
  }
}

/// Area of a facet, m² (length for D = 2, area of the ring in a meridian section, 1 for D = 1). The bilinear surface is integrated by 3 × 3 Gauss points:
/// exact where it is plane, and for mildly warped facets to many digits.
template <int D>
[[nodiscard]] double facet_area(const PointCloud<D>& cloud, const typename PointCloud<D>::Facet& facet);

/// Area of the whole boundary, m² (length for D = 2, number of ends for D = 1).
template <int D>
[[nodiscard]] double boundary_area(const PointCloud<D>& cloud);

/// Particles that lie on a boundary facet: true per particle.
template <int D>
[[nodiscard]] std::vector<bool> on_boundary(const PointCloud<D>& cloud);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/facets.ipp>
#endif
