#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>

#include <tactoid/core/compiled.hpp>
#include <tactoid/core/fingerprint.hpp>
#include <tactoid/quadrature/coloring.hpp>
#include <tactoid/quadrature/divided_build.hpp>
#include <tactoid/quadrature/rows.hpp>

namespace tactoid {

TACTOID_INLINE TableOutline DividedBuild::outline(const PointTable& table, const Find& find) const {
  const auto ranks = static_cast<std::size_t>(ranks_.size()), rank = static_cast<std::size_t>(ranks_.rank());
  const std::size_t chunks = table.chunks.size();
  std::vector<std::size_t> first_chunk, first_point;  // of each rank
  for (std::size_t r = 0; r <= ranks; ++r) {
    first_chunk.push_back(chunks * r / ranks);
    first_point.push_back(first_chunk.back() < chunks ? table.chunks[first_chunk.back()].begin : table.points());
  }

  std::vector<Index> pairs(table.points(), 0), counts(chunks, 0), touched;
  together([&] {
    std::vector<Index> points(first_point[rank + 1] - first_point[rank]);
    std::iota(points.begin(), points.end(), static_cast<Index>(first_point[rank]));
    const NeighborTable near = find(points);
    std::vector<std::size_t> seen(table.particles, 0);  // the last chunk, from 1 on, that touches each particle
    for (std::size_t c = first_chunk[rank]; c < first_chunk[rank + 1]; ++c) {
      const std::size_t before = touched.size();
      for (std::size_t q = table.chunks[c].begin; q < table.chunks[c].end; ++q) {
        const auto row = near.row(q - first_point[rank]);
        pairs[q] = static_cast<Index>(padded_row(row.size()));
        for (const Index i : row)
          if (std::exchange(seen[i], c + 1) != c + 1) touched.push_back(i);
      }
      std::sort(touched.begin() + static_cast<std::ptrdiff_t>(before), touched.end());
      counts[c] = static_cast<Index>(touched.size() - before);
    }
  });
  ranks_.gather(pairs, first_point);
  ranks_.gather(counts, first_chunk);
  std::vector<std::size_t> first_touched(1, 0);
  for (std::size_t r = 0; r < ranks; ++r)
    first_touched.push_back(std::accumulate(counts.begin() + static_cast<std::ptrdiff_t>(first_chunk[r]), counts.begin() + static_cast<std::ptrdiff_t>(first_chunk[r + 1]), first_touched.back()));
  std::vector<Index> all(first_touched.back());
  std::copy(touched.begin(), touched.end(), all.begin() + static_cast<std::ptrdiff_t>(first_touched[rank]));
  touched = std::vector<Index>();
  ranks_.gather(all, first_touched);

  TableOutline outline{&table, {}, {}};
  auto next = all.begin();
  for (std::size_t c = 0; c < chunks; ++c) {
    const auto begin = std::exchange(next, next + static_cast<std::ptrdiff_t>(counts[c]));
    outline.touched.emplace_back(begin, next);
    const auto& [first, last, region] = table.chunks[c];
    outline.cost.push_back(std::accumulate(pairs.begin() + static_cast<std::ptrdiff_t>(first), pairs.begin() + static_cast<std::ptrdiff_t>(last), 0.0) +
                           region_cost_[region] * static_cast<double>(last - first));
  }
  return outline;
}

TACTOID_INLINE void DividedBuild::require_same_points(const PointTable& table, std::span<const double> supports) const {
  Fingerprint fingerprint;
  fingerprint.add(std::uint64_t{table.chunks.size()});
  for (const double support : supports) fingerprint.add(support);
  for (std::size_t q = 0; q < table.points(); ++q)
    for (const double number : {table.volume[q], table.position[q][0], table.position[q][1], table.position[q][2]}) fingerprint.add(number);
  ranks_.require_same("body", fingerprint.text());
}

TACTOID_INLINE RowsToMake DividedBuild::divide(PointTable& table, std::span<const double> supports, const Find& find) {
  ranks_.require_same_set_up();
  require_same_points(table, supports);
  TableOutline outline = this->outline(table, find);
  const std::vector<std::size_t> before = color_chunks(table, [&](std::size_t c) -> std::span<const Index> { return outline.touched[c]; });
  TableOutline colored{&table, {}, {}};
  for (const std::size_t c : before) {
    colored.touched.push_back(std::move(outline.touched[c]));
    colored.cost.push_back(outline.cost[c]);
  }
  share_ = ranks_.divide(colored);

  // Of chunks of other ranks, the rows that touch own particles.
  const auto is_own = [&](Index i) { return share_->particle_owner[i] == share_->rank(); };
  std::vector<Index> candidates;
  std::vector<char> of_own_chunk(table.points(), 0);
  for (std::size_t c = 0; c < table.chunks.size(); ++c) {
    const bool own = share_->chunk_owner[c] == share_->rank();
    if (!own && std::none_of(colored.touched[c].begin(), colored.touched[c].end(), is_own)) continue;
    for (std::size_t q = table.chunks[c].begin; q < table.chunks[c].end; ++q) {
      candidates.push_back(static_cast<Index>(q));
      of_own_chunk[q] = own ? 1 : 0;
    }
  }
  std::sort(candidates.begin(), candidates.end());
  NeighborTable near;
  together([&] { near = find(candidates); });
  RowsToMake rows;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const auto row = near.row(k);
    if (of_own_chunk[candidates[k]] || std::any_of(row.begin(), row.end(), is_own)) rows.add(candidates[k], row);
  }
  return rows;
}

TACTOID_INLINE RowsToMake DividedBuild::rows_of(const PointTable& table, const CloudPart& part, const Find& find) const {
  ranks_.require_same("cloud of which it has a part", std::to_string(part.whole));
  const bool fits = part.rank == ranks_.rank() && part.ranks == ranks_.size();
  if (ranks_.largest(fits ? 0 : 1) > 0)
    throw ParameterError("A rank has the part of another one, or of a cloud that was divided among more or fewer ranks than there are.");
  RowsToMake rows;
  together([&] {
    std::vector<Index> points(table.points());
    std::iota(points.begin(), points.end(), Index{0});
    const NeighborTable near = find(points);
    for (const Index q : points) {
      const auto row = near.row(q);
      if (!part.is_own(table.owner[q]) && std::none_of(row.begin(), row.end(), [&](Index i) { return part.is_own(i); })) continue;
      if (!std::all_of(row.begin(), row.end(), [&](Index i) { return part.complete[i] != 0; }))
        throw ParameterError(fmt::format("The row of the point of particle {} needs particles that rank {} has not: make its part of the cloud for a larger support (Part::support).",
                                         part.number[table.owner[q]], part.rank));
      rows.add(q, row);
    }
  });
  return rows;
}

TACTOID_INLINE void DividedBuild::share_part(PointTable& table, std::shared_ptr<const CloudPart> part, std::size_t points_per_chunk) {
  together([&] { color_chunks(table, points_per_chunk, part.get()); });
  share_ = ranks_.share_of(table, std::move(part));
}

}  // namespace tactoid
