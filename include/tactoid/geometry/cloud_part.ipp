#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/geometry/cloud_part.hpp>

namespace tactoid {

TACTOID_INLINE void Part::validate() const {
  if (ranks < 1) reject("Part.ranks", ranks, "", "at least 1");
  if (rank < 0 || rank >= ranks) reject("Part.rank", rank, "", fmt::format("in [0, {})", ranks));
  require_positive("Part.support", support);
}

template <int D>
PointCloud<D> detail::kept_of(const PointCloud<D>& cloud, const std::vector<Index>& kept) {
  PointCloud<D> result;
  result.regions = cloud.regions;
  result.period = cloud.period;
  result.axisymmetric = cloud.axisymmetric;
  constexpr Index none = std::numeric_limits<Index>::max();
  std::vector<Index> place(cloud.size(), none);
  result.positions.reserve(kept.size());
  for (const Index i : kept) {
    place[i] = static_cast<Index>(result.positions.size());
    result.positions.push_back(cloud.positions[i]);
  }
  const auto renumber = [&](auto entity, auto& list) {
    for (Index& i : entity) {
      i = place[i];
      if (i == none) return false;
    }
    list.push_back(entity);
    return true;
  };
  for (std::size_t c = 0; c < cloud.cells.size(); ++c)
    if (renumber(cloud.cells[c], result.cells)) result.cell_regions.push_back(cloud.cell_regions[c]);
  for (const auto& facet : cloud.facets) (void)renumber(facet, result.facets);
  return result;
}

template <int D>
PointCloud<D> part_of(const PointCloud<D>& cloud, const Part& part) {
  part.validate();
  if (cloud.part) throw ParameterError("part_of: the cloud is a part already.");
  if (cloud.size() < static_cast<std::size_t>(part.ranks))
    throw ParameterError(fmt::format("part_of: {} particles cannot be divided among {} ranks.", cloud.size(), part.ranks));

  // Owners, by bisection of the list of particles.
  std::vector<int> owner(cloud.size(), 0);
  std::vector<Index> order(cloud.size());
  for (Index i = 0; i < order.size(); ++i) order[i] = i;
  const auto divide = [&](const auto& self, std::size_t begin, std::size_t end, int first, int ranks) -> void {
    if (ranks == 1) {
      for (std::size_t k = begin; k < end; ++k) owner[order[k]] = first;
      return;
    }
    Point<D> low = cloud.positions[order[begin]], high = low;
    for (std::size_t k = begin; k < end; ++k) low = low.cwiseMin(cloud.positions[order[k]]), high = high.cwiseMax(cloud.positions[order[k]]);
    int along = 0;
    (high - low).maxCoeff(&along);
    const int lower = ranks / 2;
    const std::size_t middle = begin + std::max<std::size_t>((end - begin) * static_cast<std::size_t>(lower) / static_cast<std::size_t>(ranks), static_cast<std::size_t>(lower));
    const auto at = [&](std::size_t k) { return order.begin() + static_cast<std::ptrdiff_t>(k); };
    std::nth_element(at(begin), at(middle), at(end), [&](Index a, Index b) {
      return std::pair(cloud.positions[a][along], a) < std::pair(cloud.positions[b][along], b);
    });
    self(self, begin, middle, first, lower);
    self(self, middle, end, first + lower, ranks - lower);
  };
  divide(divide, 0, order.size(), 0, part.ranks);

  // What rows of this rank may touch, by the box of its own particles.
  const std::vector<double> spacing = longest_edges(cloud);
  const double reach = detail::reach_of_part(part, *std::max_element(spacing.begin(), spacing.end()));
  Point<D> low = Point<D>::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (owner[i] == part.rank) low = low.cwiseMin(cloud.positions[i]), high = high.cwiseMax(cloud.positions[i]);
  const Point<D> middle = 0.5 * (low + high), half = 0.5 * (high - low);
  const auto within = [&](Index i) {
    return ((cloud.difference(middle, cloud.positions[i]).cwiseAbs() - half).array() <= reach).all();
  };
  std::vector<char> kind(cloud.size(), 0);  // 1: own, 2: complete, 3: beyond; 0: not here, but for its being on a facet
  for (Index i = 0; i < cloud.size(); ++i) kind[i] = owner[i] == part.rank ? 1 : within(i) ? 2 : 0;
  for (const auto& cell : cloud.cells)
    if (std::any_of(cell.begin(), cell.end(), [&](Index i) { return kind[i] == 1 || kind[i] == 2; }))
      for (const Index i : cell)
        if (kind[i] == 0) kind[i] = 3;

  CloudPart made{.rank = part.rank, .ranks = part.ranks, .whole = cloud.size(), .surface = part.surface, .number = {}, .owner = {}, .complete = {}, .own = {}};
  const auto take = [&](const auto& which) {
    for (Index i = 0; i < cloud.size(); ++i)
      if (which(i)) made.add(i, owner[i], kind[i] == 1 || kind[i] == 2);
  };
  std::vector<bool> first(cloud.size(), false);
  if (part.surface) first = on_boundary(cloud);
  take([&](Index i) { return first[i]; });
  for (const int k : {1, 2, 3}) take([&](Index i) { return !first[i] && kind[i] == k; });
  PointCloud<D> result = detail::kept_of(cloud, made.number);
  result.part = std::make_shared<const CloudPart>(std::move(made));
  return result;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template PointCloud<1> part_of<1>(const PointCloud<1>&, const Part&);
template PointCloud<2> part_of<2>(const PointCloud<2>&, const Part&);
template PointCloud<3> part_of<3>(const PointCloud<3>&, const Part&);
namespace detail {
template PointCloud<1> kept_of<1>(const PointCloud<1>&, const std::vector<Index>&);
template PointCloud<2> kept_of<2>(const PointCloud<2>&, const std::vector<Index>&);
template PointCloud<3> kept_of<3>(const PointCloud<3>&, const std::vector<Index>&);
}  // namespace detail
}  // namespace tactoid
#endif
