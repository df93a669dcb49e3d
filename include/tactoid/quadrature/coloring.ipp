#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/quadrature/coloring.hpp>

namespace tactoid {

TACTOID_INLINE void cut_chunks(PointTable& table, std::size_t points_per_chunk, const CloudPart* part) {
  if (points_per_chunk == 0) points_per_chunk = std::clamp<std::size_t>(table.points() / 64, 64, 2048);
  points_per_chunk = std::max<std::size_t>(8, points_per_chunk / 8 * 8);  // whole blocks of lanes

  table.chunks.clear();
  for (std::size_t q = 0; q < table.points();) {
    std::size_t end = q;
    const auto is_own = [&](std::size_t p) { return part == nullptr || part->is_own(table.owner[p]); };
    const auto is_alike = [&](std::size_t p) { return table.region[p] == table.region[q] && is_own(p) == is_own(q); };
    while (end < table.points() && end - q < points_per_chunk && is_alike(end)) ++end;
    table.chunks.push_back({q, end, table.region[q]});
    q = end;
  }
}

TACTOID_INLINE std::vector<std::size_t> color_chunks(PointTable& table, const TouchedBy& touched) {
  constexpr std::size_t max_colors = 256;
  const std::vector<PointChunk> chunks = table.chunks;
  std::vector<std::bitset<max_colors>> used(table.particles);  // colours of the chunks that touch each particle
  std::vector<std::size_t> color(chunks.size());
  std::vector<std::size_t> count(max_colors, 0);
  std::size_t colors = 0;
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    std::bitset<max_colors> taken;
    const std::span<const Index> particles = touched(c);
    for (const Index i : particles) taken |= used[i];
    std::size_t best = max_colors;
    for (std::size_t k = 0; k < colors; ++k)
      if (!taken[k] && (best == max_colors || count[k] < count[best])) best = k;
    if (best == max_colors && colors < max_colors) best = colors++;
    if (best == max_colors)
      throw GeometryError("The points cannot be coloured with 256 colours: the supports of the kernel are too large.");
    color[c] = best;
    ++count[best];
    for (const Index i : particles) used[i].set(best);
  }
  std::vector<std::size_t> order;
  table.chunks.clear();
  table.color_offsets.assign(1, 0);
  for (std::size_t k = 0; k < colors; ++k) {
    for (std::size_t c = 0; c < chunks.size(); ++c)
      if (color[c] == k) {
        table.chunks.push_back(chunks[c]);
        order.push_back(c);
      }
    table.color_offsets.push_back(table.chunks.size());
  }
  return order;
}

TACTOID_INLINE void color_chunks(PointTable& table, std::size_t points_per_chunk, const CloudPart* part) {
  cut_chunks(table, points_per_chunk, part);
  const std::vector<PointChunk> chunks = table.chunks;
  std::vector<Index> particles;
  color_chunks(table, [&](std::size_t c) -> std::span<const Index> {
    particles.clear();
    for (std::size_t e = table.offsets[chunks[c].begin]; e < table.offsets[chunks[c].end]; ++e) particles.push_back(table.entries[e].particle);
    return particles;
  });
}

}  // namespace tactoid
