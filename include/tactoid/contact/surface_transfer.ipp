#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/surface_transfer.hpp>

namespace tactoid {

TACTOID_INLINE std::vector<FacetCurve> facet_curves(const FacetSurface<2>& surface) {
  std::vector<FacetCurve> curves;
  std::vector<char> taken(surface.facets.size(), 0);
  for (Index seed = 0; seed < surface.facets.size(); ++seed) {
    if (taken[seed]) continue;
    Index first = seed;
    FacetCurve curve;
    for (Index f = surface.side_neighbors[seed][0]; f != no_facet && f != seed; f = surface.side_neighbors[f][0]) first = f;
    curve.closed = surface.side_neighbors[first][0] != no_facet;  // went around, up to the neighbour of the seed
    if (curve.closed) first = seed;
    for (Index f = first; f != no_facet && !taken[f]; f = surface.side_neighbors[f][1]) {
      taken[f] = 1;
      curve.facets.push_back(f);
      curve.nodes.push_back(surface.facets[f][0]);
    }
    curve.nodes.push_back(surface.facets[curve.facets.back()][1]);
    curves.push_back(std::move(curve));
  }
  return curves;
}

TACTOID_INLINE std::vector<double> SurfaceTransfer::carry(const std::vector<double>& weights,
                                                          const std::vector<double>& amounts) const {
  std::vector<double> carried(amounts.size(), 0.0);
  for_each_share(weights, [&](std::size_t to, std::size_t from, double share) { carried[to] += share * amounts[from]; });
  return carried;
}

TACTOID_INLINE double SurfaceTransfer::area(const Slide& slide, std::size_t k, double s) {
  const double a = slide.radii[k], b = slide.radii[k + 1];
  return slide.lengths[k] * s * (2.0 * a + (b - a) * s);
}

}  // namespace tactoid
