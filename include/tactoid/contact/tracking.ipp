#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/tracking.hpp>
#include <tactoid/neighbors/neighbor_search.hpp>

namespace tactoid {

template <int D>
void ClosestPointTracker<D>::search(const FacetSurface<D>& surface, std::span<const Vector4> queries, std::span<const Vector4> x,
                                    double reach, const std::vector<Index>* some) {
  const std::size_t count = surface.facets.size();
  std::vector<Point<D>> middle(count);
  std::vector<Extent> extent(count);
  double largest = 0.0, sum = 0.0;
  for (Index f = 0; f < count; ++f) {
    const auto& corners = surface.facets[f];
    Vector4 m = Vector4::Zero();
    for (const Index n : corners) m += x[n];
    m /= static_cast<double>(corners.size());
    double r2 = 0.0;
    for (const Index n : corners) r2 = std::max(r2, (x[n] - m).squaredNorm());
    middle[f] = m.template head<D>();
    const Vector3 normal = surface.normal(f, FacetSurface<D>::make_local(0.5, 0.5), x);
    extent[f] = {m.template head<3>(), normal, std::sqrt(r2), 0.0};
    for (const Index n : corners)
      extent[f].thickness = std::max(extent[f].thickness, std::abs(normal.dot((x[n] - m).template head<3>())));
    largest = std::max(largest, extent[f].radius);
    sum += extent[f].radius;
  }
  // That of the first search, for good: an implicit step may try a state in which facets are huge.
  if (!(facet_size_ > 0.0) && std::isfinite(sum)) facet_size_ = 2.0 * sum / static_cast<double>(count);
  reach_ = reach;
  closest_.resize(queries.size());
  asleep_.assign(queries.size(), 0);
  queries_then_.assign(queries.begin(), queries.end());
  nodes_then_.resize(surface.nodes.size());
  for (std::size_t k = 0; k < surface.nodes.size(); ++k) nodes_then_[k] = x[surface.nodes[k]];
  if (!std::isfinite(sum)) {  // a motion that broke down: the gaps say so
    for (auto& c : closest_) c = {}, c.gap = std::numeric_limits<double>::quiet_NaN();
    find_awake();
    return;
  }
  const NeighborSearch<D> tree{middle};
  parallel_for(some != nullptr ? some->size() : queries.size(), [&](std::size_t k) {
    const std::size_t i = some != nullptr ? (*some)[k] : k;
    const Vector3 q = queries[i].template head<3>();
    const Point<D> p = queries[i].template head<D>();
    if (!q.allFinite()) {
      closest_[i] = {};
      closest_[i].gap = std::numeric_limits<double>::quiet_NaN();
      return;
    }
    Index best = static_cast<Index>(tree.nearest(p));
    FacetProjection<D> projection = project_on_facet(surface, best, x, q);
    thread_local std::vector<Index> candidates;
    tree.within(p, (std::sqrt(projection.squared_distance) + largest) * (1.0 + 1e-12), candidates);
    for (const Index f : candidates) {
      if (f == best || extent[f].least_square(q) > projection.squared_distance * (1.0 + 1e-12)) continue;
      const FacetProjection<D> other = project_on_facet(surface, f, x, q);
      const bool nearer = other.squared_distance < projection.squared_distance;
      if (nearer || (other.squared_distance == projection.squared_distance && f < best)) {
        projection = other;
        best = f;
      }
    }
    closest_[i] = complete(surface, best, projection, x, q);
    asleep_[i] = closest_[i].gap > reach + search_after * facet_size_;
  });
  find_awake();
}

template <int D>
void ClosestPointTracker<D>::find_awake() {
  awake_.clear();
  for (Index i = 0; i < asleep_.size(); ++i)
    if (!asleep_[i]) awake_.push_back(i);
}

template <int D>
void ClosestPointTracker<D>::follow(const FacetSurface<D>& surface, std::span<const Vector4> queries, std::span<const Vector4> x,
                                    std::size_t begin, std::size_t end) {
  parallel_for(end - begin, [&](std::size_t k) {
    const Index i = awake_[begin + k];
    closest_[i] = walk(surface, closest_[i].facet, x, queries[i].template head<3>());
  });
}

template <int D>
void ClosestPointTracker<D>::update(const FacetSurface<D>& surface, std::span<const Vector4> queries, std::span<const Vector4> x,
                                    double reach, Ranks* ranks) {
  const double allowed = search_after * facet_size_;
  if (closest_.size() != queries.size() || reach > reach_ || !(motion(surface, queries, x) <= allowed)) {
    search(surface, queries, x, reach);
    return;
  }
  constexpr std::size_t few = 64;  // are followed sooner than told
  if (ranks == nullptr || awake_.size() < few * static_cast<std::size_t>(ranks->size())) return follow(surface, queries, x, 0, awake_.size());

  const auto size = static_cast<std::size_t>(ranks->size()), rank = static_cast<std::size_t>(ranks->rank());
  constexpr std::size_t width = packed_size;
  std::vector<std::size_t> first(size + 1);
  for (std::size_t r = 0; r <= size; ++r) first[r] = awake_.size() * r / size;
  follow(surface, queries, x, first[rank], first[rank + 1]);
  std::vector<double> values(awake_.size() * width);
  for (std::size_t k = first[rank]; k < first[rank + 1]; ++k) pack(closest_[awake_[k]], values.data() + k * width);
  for (std::size_t& f : first) f *= width;
  ranks->gather(values, first);
  for (std::size_t k = 0; k < awake_.size(); ++k) unpack(values.data() + k * width, closest_[awake_[k]]);
}

template <int D>
void ClosestPointTracker<D>::update_own(const FacetSurface<D>& surface, std::span<const Vector4> queries, std::span<const Vector4> x, double reach,
                                        Ranks& ranks, const std::vector<Index>& own) {
  // Nobody knows all motions: the processes search together, as one would.
  const bool moved = closest_.size() != queries.size() || reach > reach_ || !(motion(surface, queries, x, &own) <= search_after * facet_size_);
  if (ranks.largest(moved ? 1 : 0) > 0) return search(surface, queries, x, reach, &own);
  parallel_for(own.size(), [&](std::size_t k) {
    const Index i = own[k];
    if (!asleep_[i]) closest_[i] = walk(surface, closest_[i].facet, x, queries[i].template head<3>());
  });
}

template <int D>
void ClosestPointTracker<D>::tell_own(Ranks& ranks, const std::vector<Index>& own) {
  constexpr std::size_t width = 5 + packed_size;  // number, sleep, where the query point was, closest point
  std::vector<double> list(own.size() * width);
  for (std::size_t k = 0; k < own.size(); ++k) {
    const Index i = own[k];
    double* v = list.data() + k * width;
    v[0] = i;
    v[1] = asleep_[i] ? 1.0 : 0.0;
    Eigen::Map<Vector3>(v + 2) = queries_then_[i].template head<3>();
    pack(closest_[i], v + 5);
  }
  for (const std::vector<double>& told : ranks.exchange(std::vector(static_cast<std::size_t>(ranks.size()), list)))
    for (std::size_t k = 0; k < told.size(); k += width) {
      const double* v = told.data() + k;
      const auto i = static_cast<Index>(v[0]);
      asleep_[i] = v[1] != 0.0;
      queries_then_[i].template head<3>() = Eigen::Map<const Vector3>(v + 2);
      unpack(v + 5, closest_[i]);
    }
  find_awake();
}

template <int D>
ClosestPoint<D> ClosestPointTracker<D>::walk(const FacetSurface<D>& surface, Index f, std::span<const Vector4> x,
                                             const Vector3& q) {
  FacetProjection<D> here = project_on_facet(surface, f, x, q);
  for (;;) {
    Index next = f;
    FacetProjection<D> there = here;
    const auto look_at = [&](Index g) {
      if (g == f || g == no_facet) return;
      const FacetProjection<D> other = project_on_facet(surface, g, x, q);
      if (other.squared_distance < there.squared_distance) {
        there = other;
        next = g;
      }
    };
    const auto& corners = surface.facets[f];
    if (here.interior()) {
      for (std::size_t k = 0; k < FacetSurface<D>::sides; ++k)
        if (rises_toward(surface, f, k, here, x, q)) look_at(surface.neighbors_of(f)[k]);
    } else if (here.corner >= 0) {
      for (const Index g : surface.facets_of(corners[static_cast<std::size_t>(here.corner)])) look_at(g);
    } else {
      for (const std::size_t end : surface.side_corners(static_cast<std::size_t>(here.side)))
        for (const Index g : surface.facets_of(corners[end])) look_at(g);
    }
    if (next == f) break;
    f = next;
    here = there;
  }
  return complete(surface, f, here, x, q);
}

template <int D>
double ClosestPointTracker<D>::Extent::least_square(const Vector3& q) const {
  const Vector3 r = q - middle;
  const double height = r.dot(normal), side = std::sqrt(std::max(r.squaredNorm() - height * height, 0.0));
  const double above = std::max(std::abs(height) - thickness, 0.0), beside = std::max(side - radius, 0.0);
  return above * above + beside * beside;
}

template <int D>
bool ClosestPointTracker<D>::rises_toward(const FacetSurface<D>& surface, Index f, std::size_t k, const FacetProjection<D>& p,
                                          std::span<const Vector4> x, const Vector3& q) {
  const Index g = surface.neighbors_of(f)[k];
  if (g == no_facet) return false;
  const Vector3 up = q - p.point;  // normal to the facet
  const auto [a, b] = surface.side_corners(k);
  const Index na = surface.facets[f][a], nb = surface.facets[f][b];
  const Vector3 edge_start = x[na].template head<3>();
  Vector3 edge = Vector3::UnitZ();
  if constexpr (D == 3) edge = x[nb].template head<3>() - edge_start;
  for (const Index n : surface.facets[g]) {
    if (n == na || n == nb) continue;
    const Vector3 corner = x[n].template head<3>();
    const double height = up.dot(corner - p.point);  // |q − p| × height
    if (height <= 1e-9 * up.squaredNorm()) continue;
    const double delta = (edge_start - p.point).cross(edge).squaredNorm();  // δ²|e|²
    const double length = (corner - edge_start).cross(edge).squaredNorm();  // L²|e|²
    const double e2 = edge.squaredNorm();
    if (delta * length < 0.4 * height * height * e2 * e2) return true;
  }
  return false;
}

template <int D>
double ClosestPointTracker<D>::motion(const FacetSurface<D>& surface, std::span<const Vector4> queries,
                                      std::span<const Vector4> x, const std::vector<Index>* some) const {
  double of_queries = 0.0, of_nodes = 0.0;
  for (std::size_t k = 0; k < (some != nullptr ? some->size() : queries.size()); ++k) {
    const std::size_t i = some != nullptr ? (*some)[k] : k;
    of_queries = std::max(of_queries, (queries[i] - queries_then_[i]).squaredNorm());
  }
  for (std::size_t k = 0; k < surface.nodes.size(); ++k)
    of_nodes = std::max(of_nodes, (x[surface.nodes[k]] - nodes_then_[k]).squaredNorm());
  return std::sqrt(of_queries) + std::sqrt(of_nodes);
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template class ClosestPointTracker<2>;
template class ClosestPointTracker<3>;
}  // namespace tactoid
#endif
