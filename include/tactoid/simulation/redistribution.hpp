#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include <tactoid/contact/surface.hpp>
#include <tactoid/contact/surface_transfer.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/integrator/reference_update.hpp>
#include <tactoid/kernel/kernel.hpp>

namespace tactoid {

/// What became of a body whose particles were redistributed (Body::update_reference).
struct RedistributedParticles {
  Eigen::SparseMatrix<double, Eigen::RowMajor> rows;  ///< from values at the particles as they were to values where they are now
  SurfaceTransfer surface;                            ///< what becomes of amounts on facets
};

namespace detail {

/// Positions of the nodes of a curve that slide towards the relative spacing that they had first, and their places on the curve as
/// it is: the cubic spline through the nodes with slopes of parabolas, which meets an axis at a right angle. Where it turns by more than
/// Redistribution::corner, and at nodes that are held, it has an edge, at which there is a node afterwards too. The first node of a closed curve stays.
template <int D>
  requires(D == 2)
SurfaceTransfer::Slide slide_along(const FacetCurve& curve, const PointCloud<D>& now, const std::vector<Point<D>>& first,
                                   const std::vector<char>& held, const Redistribution& parameters, std::vector<Point<D>>& positions) {
  const std::size_t n = curve.facets.size();
  SurfaceTransfer::Slide slide{curve, {}, {}, {}};
  std::vector<double> arc(n + 1, 0.0), first_arc(n + 1, 0.0);
  std::vector<Point<D>> x(n + 1);
  for (std::size_t k = 0; k <= n; ++k) {
    x[k] = now.positions[curve.nodes[k]];
    slide.radii.push_back(now.axisymmetric ? x[k][0] : 1.0);
    slide.places.push_back(static_cast<double>(k));
  }
  for (std::size_t k = 0; k < n; ++k) {
    slide.lengths.push_back((x[k + 1] - x[k]).norm());
    arc[k + 1] = arc[k] + slide.lengths[k];
    first_arc[k + 1] = first_arc[k] + (first[curve.nodes[k + 1]] - first[curve.nodes[k]]).norm();
  }
  const auto direction = [&](std::size_t k) -> Point<D> { return (x[k + 1] - x[k]) / slide.lengths[k]; };
  // Corners stay, and the curve has another slope on each side of them.
  std::vector<char> corner(n + 1, 0);
  for (std::size_t k = curve.closed ? 0 : 1; k < n; ++k) {
    const double along = direction(k == 0 ? n - 1 : k - 1).dot(direction(k));
    if (held[curve.nodes[k]] || along < std::cos(parameters.corner)) corner[k] = 1;
  }
  if (curve.closed) corner[n] = corner[0];
  std::vector<Point<D>> slope(n + 1);
  for (std::size_t k = 0; k <= n; ++k) {
    const bool end = k == 0 || k == n;
    if (end && !curve.closed) {
      slope[k] = direction(k == 0 ? 0 : n - 1);
      if (now.on_axis(first[curve.nodes[k]])) slope[k][1] = 0.0;
      continue;
    }
    const std::size_t before = k == 0 ? n - 1 : k - 1, after = k == n ? 0 : k;
    slope[k] = (slide.lengths[after] * direction(before) + slide.lengths[before] * direction(after)) / (slide.lengths[before] + slide.lengths[after]);
  }
  // The edges divide the curve. Each is at the place of a particle, before and after: the same one, unless another would divide the particles
  // better by more than one.
  std::vector<std::size_t> edges{0}, labels{0};
  for (std::size_t k = 1; k < n; ++k) {
    if (!corner[k]) continue;
    const double goal = first_arc[n] * arc[k] / arc[n];
    std::size_t label = k;
    if (!held[curve.nodes[k]]) {
      const auto after = static_cast<std::size_t>(std::lower_bound(first_arc.begin(), first_arc.end(), goal) - first_arc.begin());
      const double best = static_cast<double>(after) - (first_arc[after] - goal) / (first_arc[after] - first_arc[after - 1]);
      if (std::abs(best - static_cast<double>(k)) > 1.0) label = static_cast<std::size_t>(std::lround(best));
    }
    edges.push_back(k);
    labels.push_back(label);
  }
  edges.push_back(n);
  labels.push_back(n);
  for (std::size_t e = 1; e < labels.size(); ++e)
    if (labels[e] <= labels[e - 1]) labels = edges;  // too close for all of them to move
  const auto place = [&](std::size_t k, double s) {  // at the arc length s
    std::size_t facet = static_cast<std::size_t>(std::upper_bound(arc.begin(), arc.end(), s) - arc.begin());
    facet = std::clamp<std::size_t>(facet, 1, n) - 1;
    const double L = slide.lengths[facet], t = (s - arc[facet]) / L;
    const Point<D> leaving = corner[facet] ? direction(facet) : slope[facet], arriving = corner[facet + 1] ? direction(facet) : slope[facet + 1];
    slide.places[k] = static_cast<double>(facet) + t;
    positions[curve.nodes[k]] = (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t) * x[facet] + t * (1.0 - t) * (1.0 - t) * L * leaving +
                                t * t * (3.0 - 2.0 * t) * x[facet + 1] - t * t * (1.0 - t) * L * arriving;
  };
  for (std::size_t e = 0; e + 1 < labels.size(); ++e) {
    const std::size_t a = labels[e], b = labels[e + 1];
    const double from = arc[edges[e]], to = arc[edges[e + 1]];
    const bool stay = a == edges[e] && b == edges[e + 1];  // else they all move at once
    for (std::size_t k = a + 1; k < b; ++k) {
      const double goal = from + (to - from) * (first_arc[k] - first_arc[a]) / (first_arc[b] - first_arc[a]);
      place(k, stay ? arc[k] + parameters.share * (goal - arc[k]) : goal);
    }
    if (b < n) {
      slide.places[b] = static_cast<double>(edges[e + 1]);
      positions[curve.nodes[b]] = x[edges[e + 1]];
    }
  }
  return slide;
}

/// Moves the particles that are not `fixed` to where the displacement from their first positions is the mean of that of their neighbours along
/// the edges of the cells, weighted by 1/length² of the first edges: what has not been deformed stays. Particles on an axis stay there.
template <int D>
void relax_inside(const PointCloud<D>& first, const std::vector<char>& fixed, std::vector<Point<D>>& positions);

/// Value-based gradients at a point, from the particles around it; returns the condition number of the moment matrix.
template <int D>
using GradientOfKernel = std::function<double(std::span<const KernelNeighbor<D>>, std::vector<Point<D>>&)>;

/// Rows that take values at the positions of a cloud to values at other positions, exact for affine fields: the value of the nearest
/// particle and the kernel's gradient halfway to it. A place that is a particle's has its value. `support` is that of the kernel.
template <int D>
[[nodiscard]] Eigen::SparseMatrix<double, Eigen::RowMajor> carrying_rows(double support, const GradientOfKernel<D>& direct_gradient,
                                                                         const PointCloud<D>& from, const std::vector<Point<D>>& to);
template <Kernel K>
[[nodiscard]] Eigen::SparseMatrix<double, Eigen::RowMajor> carrying_rows(const K& kernel, const PointCloud<K::dimension>& from,
                                                                         const std::vector<Point<K::dimension>>& to) {
  constexpr int D = K::dimension;
  return carrying_rows<D>(kernel.support, [&](std::span<const KernelNeighbor<D>> near, std::vector<Point<D>>& gradient) {
    return kernel.direct_gradient(near, gradient);
  }, from, to);
}

/// rows · field.
[[nodiscard]] Field carried(const Eigen::SparseMatrix<double, Eigen::RowMajor>& rows, const Field& field);

}  // namespace detail

/// Moves the particles of a plane or a meridian section that are not `held`: those on the surface along it, towards the relative spacing that they
/// have in `first`; then all of the surface along its normals, by as much everywhere that the cells have the volume `volume_wanted` (m³; plane: m²) to
/// round-off; then those inside to where a smooth displacement takes them (slide_along, relax_inside). Changes the positions of `now`. Throws GeometryError where cells would be inverted, or the surface would have to move by more than a tenth
/// of a facet.
[[nodiscard]] SurfaceTransfer redistribute(PointCloud<2>& now, const PointCloud<2>& first, const std::vector<char>& held, double volume_wanted,
                                           const Redistribution& parameters);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/simulation/redistribution.ipp>
#endif
