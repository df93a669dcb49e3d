#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/neighbors/neighbor_search.hpp>

namespace tactoid {

template <int D>
void NeighborSearch<D>::within(const Point<D>& x, double radius, std::vector<Neighbor>& out) const {
  out.clear();
  collect(x, radius, [&](Index i, double distance) { out.push_back({i, distance}); });
  std::sort(out.begin(), out.end(), [](const Neighbor& a, const Neighbor& b) { return a.index < b.index; });
  const auto same = [](const Neighbor& a, const Neighbor& b) { return a.index == b.index; };
  out.erase(std::unique(out.begin(), out.end(), same), out.end());
}

template <int D>
void NeighborSearch<D>::within(const Point<D>& x, double radius, std::vector<Index>& out) const {
  out.clear();
  collect(x, radius, [&](Index i, double) { out.push_back(i); });
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

template <int D>
Index NeighborSearch<D>::nearest(const Point<D>& x) const {
  if (size() == 0) throw GeometryError("Neighbour search: there is no nearest point in an empty set.");
  Nearest result(1);
  search_images(x, result, std::numeric_limits<double>::infinity());
  return result.found.front().second;
}

template <int D>
std::vector<Neighbor> NeighborSearch<D>::nearest(const Point<D>& x, std::size_t count) const {
  std::vector<Neighbor> out;
  if (size() == 0 || count == 0) return out;
  Nearest result(std::min(count, size()));
  search_images(x, result, std::numeric_limits<double>::infinity());
  for (const auto& [square, index] : result.found) out.push_back({index, std::sqrt(square)});
  return out;
}

template <int D>
double NeighborSearch<D>::distance(const Point<D>& a, const Point<D>& b) const {
  Point<D> d = b - a;
  for (int k = 0; k < D; ++k)
    if (period_[k] > 0.0) d[k] -= period_[k] * std::round(d[k] / period_[k]);
  return d.norm();
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template class NeighborSearch<1>;
template class NeighborSearch<2>;
template class NeighborSearch<3>;
}  // namespace tactoid
#endif
