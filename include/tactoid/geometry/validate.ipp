#pragma once

#include <array>

#include <tactoid/core/compiled.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/geometry/validate.hpp>

namespace tactoid {

template <int D>
std::string describe(const Point<D>& x) {
  std::string text = "(";
  for (int k = 0; k < D; ++k) text += fmt::format("{}{:.6g}", k > 0 ? ", " : "", x[k]);
  return text + ") m";
}

template <int D>
void validate(const PointCloud<D>& cloud) {
  if (cloud.positions.empty()) throw GeometryError("The point cloud has no particles.");
  if (cloud.cells.empty()) throw GeometryError("The point cloud has no cells.");
  if (const CloudPart* part = cloud.part.get())
    if (part->number.size() != cloud.size() || part->owner.size() != cloud.size() || part->spacing.size() != cloud.size() || part->complete.size() != cloud.size())
      throw GeometryError(fmt::format("The cloud has {} particles, but is said to be a part of {} ones.", cloud.size(), part->number.size()));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (!cloud.positions[i].allFinite())
      throw GeometryError(
          fmt::format("Particle {} has a position that is not finite: {}.", i, describe<D>(cloud.positions[i])));
  for (int k = 0; k < D; ++k)
    if (!(cloud.period[k] >= 0.0) || !std::isfinite(cloud.period[k]))
      throw GeometryError(fmt::format(
          "The period {:g} m in direction {} is not allowed: it must be zero (not periodic) or positive.",
          cloud.period[k], k));
  if (cloud.axisymmetric) {
    if (D != 2) throw GeometryError(fmt::format("A cloud of {} dimensions cannot be axisymmetric: only one of 2 is a meridian section.", D));
    if (cloud.period[0] > 0.0) throw GeometryError("An axisymmetric cloud cannot be periodic across its axis.");
    double widest = 0.0;
    for (const Point<D>& X : cloud.positions) widest = std::max(widest, X[0]);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double R = cloud.positions[i][0];
      if (R < 0.0 || (R > 0.0 && R < 1e-9 * widest))
        throw GeometryError(fmt::format("Particle {} at {} of an axisymmetric cloud lies {}.", i, describe<D>(cloud.positions[i]),
                                        R < 0.0 ? "beyond the axis X = 0" : "so near the axis that X = 0 must be meant: write that"));
    }
  }
  if (cloud.cell_regions.size() != cloud.cells.size())
    throw GeometryError(fmt::format("The point cloud has {} cells but {} entries in cell_regions.", cloud.cells.size(),
                                    cloud.cell_regions.size()));
  std::vector<bool> used(cloud.size(), false);
  for (std::size_t c = 0; c < cloud.cells.size(); ++c) {
    const auto& cell = cloud.cells[c];
    if (cloud.cell_regions[c] >= cloud.regions.size())
      throw GeometryError(fmt::format("Cell {} is in region {}, but there are only {} regions.", c,
                                      cloud.cell_regions[c], cloud.regions.size()));
    for (std::size_t a = 0; a < cell.size(); ++a) {
      if (cell[a] >= cloud.size())
        throw GeometryError(
            fmt::format("Cell {} uses particle {}, but there are only {} particles.", c, cell[a], cloud.size()));
      for (std::size_t b = 0; b < a; ++b)
        if (cell[a] == cell[b]) throw GeometryError(fmt::format("Cell {} uses particle {} twice.", c, cell[a]));
      used[cell[a]] = true;
    }
  }
  std::array<CornerSlopes<D>, (1u << D)> slopes;  // at the corners
  for (std::size_t a = 0; a < slopes.size(); ++a) {
    Point<D> xi;
    for (int k = 0; k < D; ++k) xi[k] = ((a >> k) & 1u) != 0 ? 1.0 : 0.0;
    slopes[a] = corner_slopes<D>(xi);
  }
  const auto first_inverted = [&](const Corners<D>& corners) {
    std::size_t a = 0;
    while (a < slopes.size() && cell_jacobian<D>(corners, slopes[a]).determinant() > 0.0) ++a;
    return a;
  };
  std::vector<char> inverted(cloud.cells.size(), 0);
  parallel_for(cloud.cells.size(), [&](std::size_t c) {
    inverted[c] = first_inverted(cell_corners(cloud, cloud.cells[c])) < slopes.size() ? 1 : 0;
  });
  if (const auto c = static_cast<std::size_t>(std::find(inverted.begin(), inverted.end(), 1) - inverted.begin()); c < inverted.size()) {
    const Corners<D> corners = cell_corners(cloud, cloud.cells[c]);
    const std::size_t a = first_inverted(corners);
    throw GeometryError(fmt::format(
        "Cell {} has the Jacobian {:g} at particle {}, {}: it must be positive (inverted or degenerate cell, or "
        "vertices that are not in tensor order).", c, cell_jacobian<D>(corners, slopes[a]).determinant(), cloud.cells[c][a], describe<D>(corners[a])));
  }
  for (std::size_t f = 0; f < cloud.facets.size(); ++f)
    for (const Index i : cloud.facets[f])
      if (i >= cloud.size())
        throw GeometryError(
            fmt::format("Facet {} uses particle {}, but there are only {} particles.", f, i, cloud.size()));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (!used[i] && (!cloud.part || cloud.part->complete[i]))
      throw GeometryError(
          fmt::format("Particle {} at {} belongs to no cell: it has no volume.", i, describe<D>(cloud.positions[i])));
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template std::string describe<1>(const Point<1>& x);
template std::string describe<2>(const Point<2>& x);
template std::string describe<3>(const Point<3>& x);
template void validate<1>(const PointCloud<1>& cloud);
template void validate<2>(const PointCloud<2>& cloud);
template void validate<3>(const PointCloud<3>& cloud);
}  // namespace tactoid
#endif
