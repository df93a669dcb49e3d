#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <ranges>
#include <utility>
#include <vector>

#include <nanoflann.hpp>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/tensor.hpp>

namespace tactoid {

/// A point that a search has found.
struct Neighbor {
  Index index = 0;        ///< number of the point
  double distance = 0.0;  ///< m
};

/// Points in a k-d tree. Distances are plain distances (m), not squares. Queries are const and may run in several
/// threads at once; results do not depend on the order of the tree. Empty sets and coincident points are fine.
/// In periodic directions distances go the shortest way around.
template <int D>
class NeighborSearch {
 public:
  NeighborSearch() { clear(); }

  /// Builds the tree from a range of vectors, of which the first D components count; see rebuild.
  template <std::ranges::random_access_range Positions>
  explicit NeighborSearch(const Positions& positions, const Point<D>& period = Point<D>::Zero()) : period_(period) {
    rebuild(positions);
  }
  /// Builds a tree of its own.
  NeighborSearch(const NeighborSearch& other) : period_(other.period_) { rebuild(other.data_->points); }
  /// Leaves `other` without a tree: assign to it or let it go.
  NeighborSearch(NeighborSearch&& other) noexcept = default;
  NeighborSearch& operator=(NeighborSearch other) noexcept {  ///< by copy or by move
    period_ = other.period_;
    std::swap(data_, other.data_);
    return *this;
  }
  ~NeighborSearch() = default;

  /// Builds the tree anew. Throws ComputationError for a position that is not finite.
  template <std::ranges::random_access_range Positions>
  void rebuild(const Positions& positions) {
    std::vector<Point<D>> points;
    points.reserve(static_cast<std::size_t>(std::ranges::size(positions)));
    for (const auto& position : positions) {
      points.push_back(position.template head<D>());
      if (!points.back().allFinite())
        throw ComputationError(
            fmt::format("Neighbour search: position number {} is not finite.", points.size() - 1));
    }
    clear();
    data_->points = std::move(points);
    data_->wrapped = data_->points;
    for (Point<D>& p : data_->wrapped) p = wrap(p);
    data_->tree.buildIndex();
  }

  [[nodiscard]] std::size_t size() const { return data_->points.size(); }  ///< number of points

  /// All points with distance < `radius` from `x`, sorted by index. `radius` in m, >= 0, and at most half a period:
  /// throws ParameterError.
  void within(const Point<D>& x, double radius, std::vector<Neighbor>& out) const;

  /// The same without the distances.
  void within(const Point<D>& x, double radius, std::vector<Index>& out) const;

  /// The point nearest to `x`; of equally near ones that with the least index. Throws GeometryError if there is none.
  [[nodiscard]] Index nearest(const Point<D>& x) const;

  /// The `count` points nearest to `x` (all, if there are fewer), sorted by distance, then by index.
  [[nodiscard]] std::vector<Neighbor> nearest(const Point<D>& x, std::size_t count) const;

 private:
  struct Data;
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Data>, Data, D, Index>;

  // The tree refers to its points by address, so both live together on the heap.
  struct Data {
    std::vector<Point<D>> points;   // as given
    std::vector<Point<D>> wrapped;  // in [0, period)
    Tree tree{D, *this, nanoflann::KDTreeSingleIndexAdaptorParams(12)};
    [[nodiscard]] std::size_t kdtree_get_point_count() const { return wrapped.size(); }
    [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t k) const {
      return wrapped[i][static_cast<Eigen::Index>(k)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };

  // Result sets in the form that nanoflann calls.
  template <class Visit>
  struct Ball {
    double square;
    const Visit& visit;
    [[nodiscard]] bool full() const { return true; }
    [[nodiscard]] std::size_t size() const { return 0; }
    [[nodiscard]] double worstDist() const { return square; }
    bool addPoint(double, Index index) const {
      visit(index);
      return true;
    }
  };
  struct Nearest {
    explicit Nearest(std::size_t n) : count(n) { found.reserve(n + 1); }
    std::size_t count;
    std::vector<std::pair<double, Index>> found;  // (squared distance, index), sorted
    [[nodiscard]] bool full() const { return found.size() == count; }
    [[nodiscard]] std::size_t size() const { return found.size(); }
    [[nodiscard]] double worstDist() const {
      constexpr double infinity = std::numeric_limits<double>::infinity();
      return full() ? std::nextafter(found.back().first, infinity) : infinity;  // lets ties in
    }
    bool addPoint(double square, Index index) {
      for (auto it = found.begin(); it != found.end(); ++it) {  // an image of a point that is there already
        if (it->second != index) continue;
        if (it->first <= square) return true;
        found.erase(it);
        break;
      }
      const std::pair<double, Index> entry{square, index};
      found.insert(std::upper_bound(found.begin(), found.end(), entry), entry);
      if (found.size() > count) found.pop_back();
      return true;
    }
  };

  void clear() { data_ = std::make_unique<Data>(); }

  [[nodiscard]] Point<D> wrap(Point<D> x) const {
    for (int k = 0; k < D; ++k)
      if (period_[k] > 0.0) x[k] -= period_[k] * std::floor(x[k] / period_[k]);
    return x;
  }

  // Shortest way around, as PointCloud::difference.
  [[nodiscard]] double distance(const Point<D>& a, const Point<D>& b) const;

  template <class Visit>
  void collect(const Point<D>& x, double radius, const Visit& visit) const {
    if (!(radius >= 0.0)) reject("NeighborSearch.within: radius", radius, "m", "zero or positive");
    for (int k = 0; k < D; ++k)
      if (period_[k] > 0.0 && radius > 0.5 * period_[k])
        reject("NeighborSearch.within: radius", radius, "m",
               fmt::format("at most half the period {:g} m in direction {}", period_[k], k));
    if (size() == 0) return;
    const auto exact = [&](Index i) {
      const double d = distance(x, data_->points[i]);
      if (d < radius) visit(i, d);
    };
    // The tree's squares differ from the plain distance by round-off: search a little further, then decide exactly.
    const double reach = radius * (1.0 + 1e-9);
    Ball<decltype(exact)> result{reach * reach, exact};
    search_images(x, result, reach);
  }

  // Runs a search around x and around those of its periodic images that can be within reach of the points.
  template <class Result>
  void search_images(const Point<D>& x, Result& result, double reach) const {
    const Point<D> inside = wrap(x);
    std::size_t images = 1;
    for (int k = 0; k < D; ++k) images *= period_[k] > 0.0 ? 3 : 1;
    for (std::size_t image = 0; image < images; ++image) {
      Point<D> y = inside;
      bool reachable = true;
      std::size_t rest = image;
      for (int k = 0; k < D; ++k) {
        if (!(period_[k] > 0.0)) continue;
        constexpr std::array<double, 3> shift = {0.0, -1.0, 1.0};
        y[k] += shift[rest % 3] * period_[k];
        rest /= 3;
        // Slack: rounding may put a wrapped coordinate on the period itself.
        const double slack = reach + 1e-9 * period_[k];
        reachable = reachable && y[k] >= -slack && y[k] <= period_[k] + slack;
      }
      if (reachable) data_->tree.findNeighbors(result, y.data(), nanoflann::SearchParams());
    }
  }

  std::unique_ptr<Data> data_;
  Point<D> period_ = Point<D>::Zero();
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/neighbors/neighbor_search.ipp>
#endif
