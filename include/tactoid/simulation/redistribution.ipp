#pragma once

#include <Eigen/SparseCholesky>

#include <tactoid/core/compiled.hpp>
#include <tactoid/kernel/support.hpp>
#include <tactoid/neighbors/neighbor_search.hpp>
#include <tactoid/neighbors/neighbor_table.hpp>
#include <tactoid/simulation/redistribution.hpp>

namespace tactoid::detail {

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

TACTOID_INLINE Field carried(const Eigen::SparseMatrix<double, Eigen::RowMajor>& rows, const Field& field) {
  Field result(static_cast<std::size_t>(rows.rows()), Vector4::Zero());
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(rows, i); it; ++it)
      result[static_cast<std::size_t>(i)] += it.value() * field[static_cast<std::size_t>(it.col())];
  return result;
}

template <int D>
Eigen::SparseMatrix<double, Eigen::RowMajor> carrying_rows(double support, const GradientOfKernel<D>& direct_gradient,
                                                           const PointCloud<D>& from, const std::vector<Point<D>>& to) {
  const NeighborSearch<D> search(from.positions);
  std::vector<Index> nearest(to.size());
  std::vector<Point<D>> middle(to.size());
  for (std::size_t i = 0; i < to.size(); ++i) {
    nearest[i] = i < from.size() && from.positions[i] == to[i] ? static_cast<Index>(i) : search.nearest(to[i]);
    middle[i] = 0.5 * (from.positions[nearest[i]] + to[i]);
  }
  std::vector<double> supports = neighbor_spacings(from);
  for (double& radius : supports) radius *= support;
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
    if (!std::isfinite(direct_gradient(near, gradient)))
      throw GeometryError("The particles cannot be redistributed: too few are near one of their new places.");
    for (std::size_t k = 0; k < near.size(); ++k)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(neighbors.row(i)[k]), gradient[k].dot(step));
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> rows(static_cast<Eigen::Index>(to.size()), static_cast<Eigen::Index>(from.size()));
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

}  // namespace tactoid::detail

namespace tactoid {

TACTOID_INLINE SurfaceTransfer redistribute(PointCloud<2>& now, const PointCloud<2>& first,
                                            const std::vector<char>& held, double volume_wanted,
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

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template void relax_inside<1>(const PointCloud<1>& first, const std::vector<char>& fixed,
                              std::vector<Point<1>>& positions);
template void relax_inside<2>(const PointCloud<2>& first, const std::vector<char>& fixed,
                              std::vector<Point<2>>& positions);
template void relax_inside<3>(const PointCloud<3>& first, const std::vector<char>& fixed,
                              std::vector<Point<3>>& positions);
template Eigen::SparseMatrix<double, Eigen::RowMajor> carrying_rows<1>(double, const GradientOfKernel<1>&, const PointCloud<1>&,
                                                                       const std::vector<Point<1>>&);
template Eigen::SparseMatrix<double, Eigen::RowMajor> carrying_rows<2>(double, const GradientOfKernel<2>&, const PointCloud<2>&,
                                                                       const std::vector<Point<2>>&);
template Eigen::SparseMatrix<double, Eigen::RowMajor> carrying_rows<3>(double, const GradientOfKernel<3>&, const PointCloud<3>&,
                                                                       const std::vector<Point<3>>&);
}  // namespace tactoid::detail
#endif
