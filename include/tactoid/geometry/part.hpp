#pragma once

#include <algorithm>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/facets.hpp>

namespace tactoid {

/// The part of a cloud that is made of the cells all of whose particles satisfy a predicate of the reference position, in
/// the order of the cloud, with the part's own facets: an eighth of a ball, say. Throws GeometryError where no cell does, ParameterError for the part of a cloud that one of several processes has.
template <int D, class Predicate>
[[nodiscard]] PointCloud<D> part_where(const PointCloud<D>& cloud, const Predicate& predicate) {
  if (cloud.part) throw ParameterError("part_where: the cloud is one process's part of another; take the part of a whole.");
  PointCloud<D> part;
  part.regions = cloud.regions;
  part.period = cloud.period;
  part.axisymmetric = cloud.axisymmetric;
  std::vector<char> inside(cloud.size(), 0), used(cloud.size(), 0);
  for (std::size_t i = 0; i < cloud.size(); ++i) inside[i] = predicate(cloud.positions[i]) ? 1 : 0;
  for (std::size_t c = 0; c < cloud.cells.size(); ++c) {
    const auto& cell = cloud.cells[c];
    if (!std::all_of(cell.begin(), cell.end(), [&](Index i) { return inside[i]; })) continue;
    for (const Index i : cell) used[i] = 1;
    part.cells.push_back(cell);
    part.cell_regions.push_back(cloud.cell_regions[c]);
  }
  if (part.cells.empty()) throw GeometryError("part_where: no cell of the cloud satisfies the predicate.");
  std::vector<Index> number(cloud.size(), 0);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!used[i]) continue;
    number[i] = static_cast<Index>(part.size());
    part.positions.push_back(cloud.positions[i]);
  }
  for (auto& cell : part.cells)
    for (Index& i : cell) i = number[i];
  part.facets = extract_facets(part);
  return part;
}

}  // namespace tactoid
