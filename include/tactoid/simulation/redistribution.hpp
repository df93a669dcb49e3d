#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <tactoid/contact/surface.hpp>
#include <tactoid/contact/surface_transfer.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/integrator/reference_update.hpp>
#include <tactoid/kernel/kernel.hpp>
#include <tactoid/kernel/support.hpp>
#include <tactoid/neighbors/neighbor_search.hpp>
#include <tactoid/neighbors/neighbor_table.hpp>

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
void relax_inside(const PointCloud<D>& first, const std::vector<char>& fixed, std::vector<Point<D>>& positions) {
  const std::size_t n = first.size();
  const auto is_held = [&](std::size_t i, int c) { return fixed[i] != 0 || (c == 0 && first.on_axis(first.positions[i])); };
  for (int c = 0; c < D; ++c) {
    std::vector<Eigen::Index> unknown(n, -1);
    Eigen::Index count = 0;
    for (std::size_t i = 0; i < n; ++i)
      if (!is_held(i, c)) unknown[i] = count++;
    if (count == 0) continue;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    for_each_edge(first, [&](Index a, Index b, double length) {
      const double w = 1.0 / (length * length);
      for (const auto& [i, j] : {std::pair(a, b), std::pair(b, a)}) {
        if (unknown[i] < 0) continue;
        entries.emplace_back(unknown[i], unknown[i], w);
        if (unknown[j] < 0) right[unknown[i]] += w * (positions[j][c] - first.positions[j][c]);
        else entries.emplace_back(unknown[i], unknown[j], -w);
      }
    });
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    if (solver.info() != Eigen::Success) throw GeometryError("The particles cannot be redistributed: some hang together with nothing that stays.");
    const Eigen::VectorXd u = solver.solve(right);
    for (std::size_t i = 0; i < n; ++i)
      if (unknown[i] >= 0) positions[i][c] = first.positions[i][c] + u[unknown[i]];
  }
}

/// Rows that take values at the positions of a cloud to values at other positions, exact for affine fields: the value of the nearest
/// particle and the kernel's gradient halfway to it. A place that is a particle's has its value.
template <Kernel K>
[[nodiscard]] Eigen::SparseMatrix<double, Eigen::RowMajor> carrying_rows(const K& kernel, const PointCloud<K::dimension>& from,
                                                                         const std::vector<Point<K::dimension>>& to) {
  constexpr int D = K::dimension;
  const NeighborSearch<D> search(from.positions);
  std::vector<Index> nearest(to.size());
  std::vector<Point<D>> middle(to.size());
  for (std::size_t i = 0; i < to.size(); ++i) {
    nearest[i] = i < from.size() && from.positions[i] == to[i] ? static_cast<Index>(i) : search.nearest(to[i]);
    middle[i] = 0.5 * (from.positions[nearest[i]] + to[i]);
  }
  std::vector<double> supports = neighbor_spacings(from);
  for (double& support : supports) support *= kernel.support;
  const NeighborTable neighbors = neighbor_table(from, middle, supports);
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<KernelNeighbor<D>> near;
  std::vector<Point<D>> gradient;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const Point<D> step = to[i] - from.positions[nearest[i]];
    entries.emplace_back(static_cast<int>(i), static_cast<int>(nearest[i]), 1.0);
    if (step.isZero(0.0)) continue;
    near.clear();
    for (const Index k : neighbors.row(i)) near.push_back({Point<D>(from.positions[k] - middle[i]), supports[k], 1.0});
    if (!std::isfinite(kernel.direct_gradient(near, gradient)))
      throw GeometryError("The particles cannot be redistributed: too few are near one of their new places.");
    for (std::size_t k = 0; k < near.size(); ++k)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(neighbors.row(i)[k]), gradient[k].dot(step));
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> rows(static_cast<Eigen::Index>(to.size()), static_cast<Eigen::Index>(from.size()));
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

/// rows · field.
[[nodiscard]] inline Field carried(const Eigen::SparseMatrix<double, Eigen::RowMajor>& rows, const Field& field) {
  Field result(static_cast<std::size_t>(rows.rows()), Vector4::Zero());
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(rows, i); it; ++it)
      result[static_cast<std::size_t>(i)] += it.value() * field[static_cast<std::size_t>(it.col())];
  return result;
}

}  // namespace detail

/// Moves the particles of a plane or a meridian section that are not `held`: those on the surface along it, towards the relative spacing that they
/// have in `first`; then all of the surface along its normals, by as much everywhere that the cells have the volume `volume_wanted` (m³; plane: m²) to
/// round-off; then those inside to where a smooth displacement takes them (slide_along, relax_inside). Changes the positions of `now`. Throws GeometryError where cells would be inverted, or the surface would have to move by more than a tenth
/// of a facet.
[[nodiscard]] inline SurfaceTransfer redistribute(PointCloud<2>& now, const PointCloud<2>& first, const std::vector<char>& held, double volume_wanted,
                                                  const Redistribution& parameters) {
  const FacetSurface<2> surface(first);
  std::vector<SurfaceTransfer::Slide> slides;
  std::vector<char> fixed = held;
  std::vector<Point<2>> moved = now.positions;
  for (const FacetCurve& curve : facet_curves(surface)) slides.push_back(detail::slide_along(curve, now, first.positions, held, parameters, moved));
  PointCloud<2> next = now;
  next.positions = moved;
  // Unit normals at the nodes.
  std::vector<Point<2>> normal(now.size(), Point<2>::Zero());
  double facet_size = std::numeric_limits<double>::infinity();
  for (const auto& facet : surface.facets) {
    const Point<2> t = next.positions[facet[1]] - next.positions[facet[0]];
    facet_size = std::min(facet_size, t.norm());
    for (const Index i : facet) normal[i] += Point<2>(t[1], -t[0]);
  }
  for (const Index i : surface.nodes) {
    if (first.on_axis(first.positions[i])) normal[i][0] = 0.0;
    if (held[i] || normal[i].isZero(0.0)) normal[i].setZero();
    else normal[i].normalize();
    fixed[i] = 1;
  }
  double offset = 0.0;
  for (int iteration = 0; iteration < 6; ++iteration) {
    const std::vector<Point<2>> b = boundary_normal_integrals(next);
    double slope = 0.0;
    for (const Index i : surface.nodes) slope += b[i].dot(normal[i]);
    if (!(slope > 0.0)) break;
    const double step = (volume_wanted - volume(next)) / slope;
    offset += step;
    for (const Index i : surface.nodes) next.positions[i] += step * normal[i];
    if (std::abs(step) < 1e-16 * std::abs(offset)) break;
  }
  if (!(std::abs(offset) < 0.1 * facet_size))
    throw GeometryError(fmt::format("The particles cannot be redistributed: the surface would have to move by {:.3g} m to enclose the volume of the points.", offset));
  detail::relax_inside(first, fixed, next.positions);
  for (const auto& cell : next.cells) {
    const Corners<2> corners = cell_corners(next, cell);
    for (const double s : {0.0, 1.0})
      for (const double t : {0.0, 1.0})
        if (!(cell_jacobian<2>(corners, Point<2>(s, t)).determinant() > 0.0))
          throw GeometryError(fmt::format("The particles cannot be redistributed: a cell at ({:.4g}, {:.4g}) m would be inverted.", corners[0][0], corners[0][1]));
  }
  now.positions = std::move(next.positions);
  return SurfaceTransfer(std::move(slides));
}

}  // namespace tactoid
