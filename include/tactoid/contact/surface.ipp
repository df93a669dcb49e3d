#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/surface.hpp>

namespace tactoid {

template <int D>
FacetSurface<D>::FacetSurface(const PointCloud<D>& cloud)
    : facets(cloud.facets), axisymmetric(cloud.axisymmetric) {
  std::erase_if(facets, [&](const Facet& facet) {
    return std::all_of(facet.begin(), facet.end(), [&](Index i) { return i < cloud.size() && cloud.on_axis(cloud.positions[i]); });
  });
  if (facets.empty())
    throw GeometryError("The cloud has no surface facets: contact and surface terms need PointCloud.facets.");
  if ((cloud.period.array() > 0.0).any())
    throw GeometryError("Contact and surface terms do not support clouds with periodic directions.");
  build_rings(cloud);
  nodal_area.assign(cloud.size(), 0.0);
  Field reference(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) reference[i] = pad(cloud.positions[i]);
  const double g = 0.5 / std::sqrt(3.0);
  for (Index f = 0; f < facets.size(); ++f)
    for (const double s : {0.5 - g, 0.5 + g})
      for (const double t : {0.5 - g, 0.5 + g}) {
        const Local local = make_local(s, t);
        const double area = 0.25 * tangents(f, local, reference).area_vector().norm();
        const Shape shape_values = shape(local);
        for (std::size_t a = 0; a < corners; ++a) nodal_area[facets[f][a]] += area * shape_values[a];
      }
}

template <int D>
Vector4 FacetSurface<D>::interpolate(Index facet, const Local& local, std::span<const Vector4> values) const {
  const Shape n = shape(local);
  Vector4 v = n[0] * values[facets[facet][0]];
  for (std::size_t a = 1; a < corners; ++a) v += n[a] * values[facets[facet][a]];
  return v;
}

template <int D>
typename FacetSurface<D>::Shape FacetSurface<D>::circumference_slopes(const Local& local) const {
  Shape slopes{};
  if (!axisymmetric) return slopes;
  slopes = shape(local);
  for (double& slope : slopes) slope *= 2.0 * std::numbers::pi;
  return slopes;
}

template <int D>
void FacetSurface<D>::build_rings(const PointCloud<D>& cloud) {
  const std::size_t particles = cloud.size();
  ring_start.assign(particles + 1, 0);
  for (const Facet& f : facets)
    for (const Index n : f) {
      if (n >= particles)
        throw GeometryError("A surface facet names particle " + std::to_string(n) + ", but the cloud has only " +
                            std::to_string(particles) + ".");
      ++ring_start[n + 1];
    }
  for (std::size_t i = 0; i < particles; ++i) {
    if (ring_start[i + 1] > 0) nodes.push_back(static_cast<Index>(i));
    ring_start[i + 1] += ring_start[i];
  }
  ring.resize(ring_start.back());
  std::vector<Index> next(ring_start.begin(), ring_start.end() - 1);
  for (Index f = 0; f < facets.size(); ++f)
    for (const Index n : facets[f]) ring[next[n]++] = f;
  closed = true;
  side_neighbors.resize(facets.size());
  for (Index f = 0; f < facets.size(); ++f)
    for (std::size_t k = 0; k < sides; ++k) {
      const auto [a, b] = side_corners(k);
      side_neighbors[f][k] = across(f, facets[f][a], facets[f][b]);
      closed = closed && (side_neighbors[f][k] != no_facet || cloud.on_axis(cloud.positions[facets[f][a]]));
    }
}

template <int D>
FacetQuadrature<D>::FacetQuadrature(const FacetSurface<D>& surface, std::span<const Vector4> reference,
                                    int per_direction) {
  const auto [x, w] = rule(per_direction);
  const std::size_t n = static_cast<std::size_t>(per_direction);
  for (std::size_t j = 0; j < (D == 2 ? 1 : n); ++j)
    for (std::size_t i = 0; i < n; ++i) {
      const Local local = FacetSurface<D>::make_local(x[i], x[j]);
      points.push_back({local, FacetSurface<D>::shape(local), w[i] * (D == 2 ? 1.0 : w[j])});
    }
  area.resize(surface.facets.size() * points.size());
  for (Index f = 0; f < surface.facets.size(); ++f)
    for (std::size_t q = 0; q < points.size(); ++q)
      area[f * points.size() + q] =
          points[q].weight * surface.tangents(f, points[q].local, reference).area_vector().norm();
}

template <int D>
typename FacetQuadrature<D>::Rule FacetQuadrature<D>::rule(int n) {
  switch (n) {
    case 1:
      return {{0.5}, {1.0}};
    case 2: {
      const double a = 0.5 / std::sqrt(3.0);
      return {{0.5 - a, 0.5 + a}, {0.5, 0.5}};
    }
    case 3: {
      const double a = 0.5 * std::sqrt(0.6);
      return {{0.5 - a, 0.5, 0.5 + a}, {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0}};
    }
    case 4: {
      const double r = 2.0 * std::sqrt(1.2), a = 0.5 * std::sqrt((3.0 - r) / 7.0),
                   b = 0.5 * std::sqrt((3.0 + r) / 7.0);
      const double s = std::sqrt(30.0), wa = (18.0 + s) / 72.0, wb = (18.0 - s) / 72.0;
      return {{0.5 - b, 0.5 - a, 0.5 + a, 0.5 + b}, {wb, wa, wa, wb}};
    }
    default:
      reject("points_per_direction", n, "", "1, 2, 3 or 4");
  }
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template class FacetSurface<2>;
template class FacetSurface<3>;
template class FacetQuadrature<2>;
template class FacetQuadrature<3>;
}  // namespace tactoid
#endif
