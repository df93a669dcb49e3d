#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <tactoid/contact/closest_point.hpp>
#include <tactoid/contact/surface.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/core/ranks.hpp>

namespace tactoid {

/// Follows the closest points of many query points on a deforming surface.
///
/// A step re-projects each query point on the facet of the last step and, if the closest point lies on the facet's
/// rim or a neighbour bends toward the query point, walks over the neighbouring facets down to the minimum of the
/// distance. A global search (k-d tree of the facets' midpoints) replaces the walk at the start, and again whenever
/// query points and surface together have moved further than `search_after` mean facet sizes (of the first one) since the last one: where
/// two parts of the surface that are no neighbours are equally near, the change from one to the other is late by at
/// most that much. Queries are independent: the same bits for any number of threads. No allocation between global
/// searches in one process.
template <int D>
class ClosestPointTracker {
 public:
  double search_after = 0.25;  ///< global search after this much motion, mean facet sizes

  /// Global search for all query points (m) on the surface with its nodes at `x` (m). Query points further away than
  /// `reach` (m) plus the motion until the next global search need not be followed until then.
  void search(const FacetSurface<D>& surface, std::span<const Vector4> queries, std::span<const Vector4> x,
              double reach = std::numeric_limits<double>::infinity()) {
    search(surface, queries, x, reach, nullptr);
  }

  /// Closest points at the present positions. Query points whose gap cannot have come below `reach` (m) since the
  /// last global search are not followed: they keep the gap of that search, which is larger than `reach`. Collective with
  /// `ranks`, all of which must give the same: each follows a share of the points, where there are enough of them.
  void update(const FacetSurface<D>& surface, std::span<const Vector4> queries, std::span<const Vector4> x,
              double reach = std::numeric_limits<double>::infinity(), Ranks* ranks = nullptr);

  /// The same for `own` query points alone, where each of the processes has others; what is kept of the others falls behind. Collective.
  void update_own(const FacetSurface<D>& surface, std::span<const Vector4> queries, std::span<const Vector4> x, double reach, Ranks& ranks, const std::vector<Index>& own);
  /// Tells what update_own() left of `own` query points to all processes. Collective.
  void tell_own(Ranks& ranks, const std::vector<Index>& own);

  /// Local minimum of the distance from q (m) over a facet and its neighbours, from facet `f` downhill.
  static ClosestPoint<D> walk(const FacetSurface<D>& surface, Index f, std::span<const Vector4> x, const Vector3& q);

  /// One entry per query point.
  [[nodiscard]] std::span<const ClosestPoint<D>> closest() const { return closest_; }

  /// Where each query point is on the surface, and where everything was at the last global search.
  template <class Archive>
  void state(Archive& archive) {
    const std::size_t n = closest_.size();
    std::vector<Index> facet(n);
    std::vector<char> on_rim(n);
    std::vector<Place> place(n);
    for (std::size_t i = 0; i < n; ++i) {
      const ClosestPoint<D>& c = closest_[i];
      facet[i] = c.facet;
      on_rim[i] = c.on_rim ? 1 : 0;
      place[i] = place_of(c);
    }
    archive("facet", facet);
    archive("on_rim", on_rim);
    archive("place", place);
    archive("asleep", asleep_);
    archive("queries_then", queries_then_);
    archive("nodes_then", nodes_then_);
    archive("facet_size", facet_size_);
    archive("reach", reach_);
    if constexpr (!Archive::restoring) return;
    closest_.resize(facet.size());
    for (std::size_t i = 0; i < closest_.size(); ++i) {
      ClosestPoint<D>& c = closest_[i];
      c.facet = facet[i];
      c.on_rim = on_rim[i] != 0;
      put(place[i], c);
    }
    find_awake();
  }

 private:
  using Place = Eigen::Matrix<double, D + 6, 1>;  // local, point, normal, gap
  [[nodiscard]] static Place place_of(const ClosestPoint<D>& c) {
    Place place;
    place << Eigen::Map<const Eigen::Matrix<double, D - 1, 1>>(c.local.data()), c.point, c.normal, c.gap;
    return place;
  }
  static void put(const Place& place, ClosestPoint<D>& c) {
    for (std::size_t k = 0; k < c.local.size(); ++k) c.local[k] = place[static_cast<Eigen::Index>(k)];
    c.point = place.template segment<3>(D - 1);
    c.normal = place.template segment<3>(D + 2);
    c.gap = place[D + 5];
  }
  /// What processes tell each other of a closest point.
  static constexpr std::size_t packed_size = D + 8;
  static void pack(const ClosestPoint<D>& c, double* out) {
    out[0] = c.facet;
    out[1] = c.on_rim ? 1.0 : 0.0;
    Eigen::Map<Place>(out + 2) = place_of(c);
  }
  static void unpack(const double* in, ClosestPoint<D>& c) {
    c.facet = static_cast<Index>(in[0]);
    c.on_rim = in[1] != 0.0;
    put(Eigen::Map<const Place>(in + 2), c);
  }
  /// The global search for some query points; null: for all.
  void search(const FacetSurface<D>& surface, std::span<const Vector4> queries, std::span<const Vector4> x, double reach, const std::vector<Index>* some);
  /// Points that must be followed until the next global search.
  void find_awake();
  /// Follows some of them: numbers [begin, end) of awake_.
  void follow(const FacetSurface<D>& surface, std::span<const Vector4> queries, std::span<const Vector4> x, std::size_t begin, std::size_t end);

  /// A facet lies in a flat cylinder around its middle.
  struct Extent {
    Vector3 middle, normal;
    double radius, thickness;
    /// Lower bound of the squared distance from q.
    [[nodiscard]] double least_square(const Vector3& q) const;
  };

  /// Whether the facet behind side `k` can be nearer to q than the point p inside facet `f`: it must bend toward q
  /// so much that it reaches into the sphere around q through p. A plane that leaves the tangent plane of p at the
  /// distance δ with the slope m does so only if δ < |q − p| m/2; a quarter more is kept in hand for warped facets.
  static bool rises_toward(const FacetSurface<D>& surface, Index f, std::size_t k, const FacetProjection<D>& p,
                           std::span<const Vector4> x, const Vector3& q);

  /// Bound of how far a query point (one of `some`; null: any) and the surface can have moved against each other since the last search.
  double motion(const FacetSurface<D>& surface, std::span<const Vector4> queries, std::span<const Vector4> x, const std::vector<Index>* some = nullptr) const;

  std::vector<ClosestPoint<D>> closest_;
  std::vector<char> asleep_;         // too far away to matter before the next global search
  std::vector<Index> awake_;         // the others
  Field queries_then_, nodes_then_;  // where everything was at the last global search
  double facet_size_ = 0.0;
  double reach_ = 0.0;  // of the last global search
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/tracking.ipp>
#endif
