#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/neighbors/part_of.hpp>

namespace tactoid {

template <int D>
Bisection<D>::Bisection(std::vector<std::pair<Point<D>, std::size_t>> particles, int ranks) : cuts_(1) {
  (void)cut(particles, 0, ranks);
}

template <int D>
std::size_t Bisection<D>::cut(std::span<std::pair<Point<D>, std::size_t>> particles, int first, int ranks) {
  if (ranks == 1) return 0;
  Point<D> low = particles.front().first, high = low;
  for (const auto& [X, number] : particles) low = low.cwiseMin(X), high = high.cwiseMax(X);
  Cut made;
  (high - low).maxCoeff(&made.along);
  const int lower = ranks / 2;
  const auto below = static_cast<std::size_t>(lower);
  const std::size_t count = std::max(particles.size() * below / static_cast<std::size_t>(ranks), below);
  std::nth_element(particles.begin(), particles.begin() + static_cast<std::ptrdiff_t>(count), particles.end(), [&](const auto& a, const auto& b) {
    return std::pair(a.first[made.along], a.second) < std::pair(b.first[made.along], b.second);
  });
  made.place = particles[count].first[made.along];
  made.number = particles[count].second;
  made.rank = first + lower;
  const std::size_t at = cuts_.size();
  cuts_.push_back(made);
  const std::size_t of_lower = cut(particles.first(count), first, lower), of_upper = cut(particles.subspan(count), first + lower, ranks - lower);
  cuts_[at].lower = of_lower;
  cuts_[at].upper = of_upper;
  return at;
}

template <int D>
int Bisection<D>::owner(const Point<D>& X, std::size_t number) const {
  int rank = 0;
  for (std::size_t at = cuts_.size() > 1 ? 1 : 0; at != 0;) {
    const Cut& cut = cuts_[at];
    const bool above = std::pair(X[cut.along], number) >= std::pair(cut.place, cut.number);
    if (above) rank = cut.rank;
    at = above ? cut.upper : cut.lower;
  }
  return rank;
}

template <int D>
PointCloud<D> part_of(const PointCloud<D>& cloud, const Part& part) {
  if (cloud.part) throw ParameterError("part_of: the cloud is a part already.");
  WholeCloud<D> source(cloud);
  return part_of_source<D>(source, part);
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template class Bisection<1>;
template class Bisection<2>;
template class Bisection<3>;
template PointCloud<1> part_of<1>(const PointCloud<1>&, const Part&);
template PointCloud<2> part_of<2>(const PointCloud<2>&, const Part&);
template PointCloud<3> part_of<3>(const PointCloud<3>&, const Part&);
}  // namespace tactoid
#endif
