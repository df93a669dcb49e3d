#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/neighbors/neighbor_search.hpp>

namespace tactoid {

/// Where a cloud comes from, one thing after the other: a cloud in memory (WholeCloud), or a file (input/cloud_file.hpp). Every call goes through all of them, in the same order.
template <class S, int D>
concept CloudSource = requires(S& source) {
  { source.size() } -> std::convertible_to<std::size_t>;
  { source.regions() } -> std::convertible_to<std::vector<std::string>>;
  { source.period() } -> std::convertible_to<Point<D>>;
  { source.axisymmetric() } -> std::convertible_to<bool>;
  source.for_each_particle([](std::size_t, const Point<D>&, double) {});                // number, position and longest edge, m
  source.for_each_cell([](const typename PointCloud<D>::Cell&, Index) {});              // particles, and region
  source.for_each_facet([](const typename PointCloud<D>::Facet&) {});
};

/// A cloud in memory as a CloudSource.
template <int D>
class WholeCloud {
 public:
  /// `cloud` must outlive it.
  explicit WholeCloud(const PointCloud<D>& cloud) : cloud_(cloud), spacing_(longest_edges(cloud)) {}
  [[nodiscard]] std::size_t size() const { return cloud_.size(); }                           ///< number of particles
  [[nodiscard]] const std::vector<std::string>& regions() const { return cloud_.regions; }   ///< their names
  [[nodiscard]] Point<D> period() const { return cloud_.period; }                            ///< m; 0 where not periodic
  [[nodiscard]] bool axisymmetric() const { return cloud_.axisymmetric; }                    ///< a meridian section
  /// f(number, position, longest edge) for all particles.
  template <class F>
  void for_each_particle(const F& f) const {
    for (std::size_t i = 0; i < cloud_.size(); ++i) f(i, cloud_.positions[i], spacing_[i]);
  }
  /// f(particles, region) for all cells.
  template <class F>
  void for_each_cell(const F& f) const {
    for (std::size_t c = 0; c < cloud_.cells.size(); ++c) f(cloud_.cells[c], cloud_.cell_regions[c]);
  }
  /// f(particles) for all facets.
  template <class F>
  void for_each_facet(const F& f) const {
    for (const auto& facet : cloud_.facets) f(facet);
  }

 private:
  const PointCloud<D>& cloud_;
  std::vector<double> spacing_;
};

/// Places divided among ranks by recursive bisection along the longer direction: in halves, or as near to it as the number of ranks allows.
template <int D>
class Bisection {
 public:
  /// Of particles with the given places and numbers, or a sample of them. At least one for each rank.
  Bisection(std::vector<std::pair<Point<D>, std::size_t>> particles, int ranks);
  /// The rank of the particle with that place and number.
  [[nodiscard]] int owner(const Point<D>& X, std::size_t number) const;

 private:
  struct Cut {
    int along = 0;
    double place = 0.0;      // of the first particle above
    std::size_t number = 0;  // of that
    int rank = 0;            // the first one above
    std::size_t lower = 0, upper = 0;  // cuts of the two sides; 0: that is one rank
  };
  std::size_t cut(std::span<std::pair<Point<D>, std::size_t>> particles, int first, int ranks);
  std::vector<Cut> cuts_;  // behind one that is none
};

namespace detail {

/// From so many particles on, a division is that of a sample.
inline constexpr std::size_t sampled_particles = std::size_t{1} << 20;

}  // namespace detail

/// One rank's part of what comes from a source, divided by Bisection; particles keep the numbers that they have there. Takes the memory of the part, a quarter of a byte per particle of the
/// whole, and a sample of a million places at most. Throws ParameterError, also where there are more ranks than particles to divide, and what the source throws.
template <int D, CloudSource<D> Source>
[[nodiscard]] PointCloud<D> part_of_source(Source& source, const Part& part) {
  part.validate();
  const auto refuse = [&] { throw ParameterError(fmt::format("part_of: {} particles cannot be divided among {} ranks.", source.size(), part.ranks)); };
  if (source.size() < static_cast<std::size_t>(part.ranks)) refuse();

  const std::size_t step = std::max<std::size_t>(1, source.size() / std::max(detail::sampled_particles, 64 * static_cast<std::size_t>(part.ranks)));
  std::vector<std::pair<Point<D>, std::size_t>> sample;
  source.for_each_particle([&](std::size_t i, const Point<D>& X, double) {
    if (i % step == 0) sample.emplace_back(X, i);
  });
  const Bisection<D> division(std::move(sample), part.ranks);

  // Own particles, and a box around them.
  std::vector<std::size_t> owned(static_cast<std::size_t>(part.ranks), 0);
  std::vector<Point<D>> places;
  std::vector<double> supports;
  source.for_each_particle([&](std::size_t i, const Point<D>& X, double spacing) {
    const int owner = division.owner(X, i);
    ++owned[static_cast<std::size_t>(owner)];
    if (owner == part.rank) places.push_back(X), supports.push_back(part.support * spacing);
  });
  if (std::find(owned.begin(), owned.end(), std::size_t{0}) != owned.end()) refuse();
  Point<D> low = places.front(), high = low;
  for (const Point<D>& X : places) low = low.cwiseMin(X), high = high.cwiseMax(X);
  const Point<D> middle = 0.5 * (low + high), half = 0.5 * (high - low);
  const double largest = *std::max_element(supports.begin(), supports.end());
  PointCloud<D> result;
  result.regions = source.regions();
  result.period = source.period();
  result.axisymmetric = source.axisymmetric();

  // The row of a point that touches an own particle I may touch K where |X_K − X_I| is less than the sum of their supports: K must have all its cells.
  const NeighborSearch<D> own(places, result.period);
  std::vector<Neighbor> around;
  const auto is_touched = [&](const Point<D>& X, double support) {
    constexpr double wider = 1.0 + 1e-9;
    const double most = (largest + support) * wider;
    if (((result.difference(middle, X).cwiseAbs() - half).array() > most).any()) return false;
    for (int k = 0; k < D; ++k)
      if (result.period[k] > 0.0 && 2.0 * most >= result.period[k]) return true;
    const Index nearest = own.nearest(X);
    const double distance = result.difference(X, places[nearest]).norm();
    if (distance <= (supports[nearest] + support) * wider) return true;
    if (distance > most) return false;
    own.within(X, most, around);
    return std::any_of(around.begin(), around.end(), [&](const Neighbor& n) { return n.distance <= (supports[n.index] + support) * wider; });
  };
  std::vector<bool> complete(source.size(), false), here(source.size(), false);
  source.for_each_particle([&](std::size_t i, const Point<D>& X, double spacing) {
    complete[i] = here[i] = division.owner(X, i) == part.rank || is_touched(X, part.support * spacing);
  });
  const auto touches_complete = [&](const auto& particles) { return std::any_of(particles.begin(), particles.end(), [&](Index i) { return complete[i]; }); };
  source.for_each_cell([&](const auto& cell, Index) {
    if (touches_complete(cell))
      for (const Index i : cell) here[i] = true;
  });
  std::vector<Index> surface;  // ascending
  if (part.surface) {
    source.for_each_facet([&](const auto& facet) { surface.insert(surface.end(), facet.begin(), facet.end()); });
    std::sort(surface.begin(), surface.end());
    surface.erase(std::unique(surface.begin(), surface.end()), surface.end());
    for (const Index i : surface) here[i] = true;
  }

  // On the surface, own, complete, beyond: each group in the order of the whole.
  struct Kept {
    Index number, place;
    int group, owner;
    double spacing;
    Point<D> X;
  };
  std::vector<Kept> kept;
  source.for_each_particle([&](std::size_t i, const Point<D>& X, double spacing) {
    if (!here[i]) return;
    const int owner = division.owner(X, i);
    const int group = std::binary_search(surface.begin(), surface.end(), i) ? 0 : owner == part.rank ? 1 : complete[i] ? 2 : 3;
    kept.push_back({static_cast<Index>(i), 0, group, owner, spacing, X});
  });
  CloudPart made(part, source.size());
  for (int group = 0; group < 4; ++group)
    for (Kept& k : kept)
      if (k.group == group) {
        k.place = static_cast<Index>(result.positions.size());
        result.positions.push_back(k.X);
        made.add(k.number, k.owner, k.spacing, complete[k.number]);
      }
  const auto renumbered = [&](auto particles) {
    for (Index& i : particles) i = std::lower_bound(kept.begin(), kept.end(), i, [](const Kept& k, Index number) { return k.number < number; })->place;
    return particles;
  };
  source.for_each_cell([&](const auto& cell, Index region) {
    if (!touches_complete(cell)) return;
    result.cells.push_back(renumbered(cell));
    result.cell_regions.push_back(region);
  });
  source.for_each_facet([&](const auto& facet) {
    if (std::all_of(facet.begin(), facet.end(), [&](Index i) { return here[i]; })) result.facets.push_back(renumbered(facet));
  });
  result.part = std::make_shared<const CloudPart>(std::move(made));
  return result;
}

/// One rank's part of a cloud that it has as a whole; the whole may be released before a body is made of the part. Otherwise as part_of_source().
template <int D>
[[nodiscard]] PointCloud<D> part_of(const PointCloud<D>& cloud, const Part& part);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/neighbors/part_of.ipp>
#endif
