#pragma once

#include <algorithm>
#include <bitset>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/quadrature/point_table.hpp>

namespace tactoid {

/// Cuts the points of a table, which must be sorted by region, into chunks of one region and at most `points_per_chunk` points. 0 chooses: large chunks,
/// whose points share most of their particles, where there are enough of them to keep several threads busy. Where the cloud is a part of a whole, points of own particles and others are in different chunks.
void cut_chunks(PointTable& table, std::size_t points_per_chunk, const CloudPart* part = nullptr);

/// The particles that the rows of chunk c, as cut_chunks() numbered them, touch; some of them several times. Valid until the next call.
using TouchedBy = std::function<std::span<const Index>(std::size_t c)>;

/// Colours the chunks of a table so that no two of one colour share a particle, and sorts them by colour. Chunks of one colour may then add to the particles at
/// the same time, and every particle receives its contributions in the order of the colours: the same bits for
/// any number of threads. Among the colours allowed for a chunk the least used one is taken, which keeps the threads evenly loaded. Returns the numbers that the chunks had before.
/// Throws GeometryError where that takes more than 256 colours.
std::vector<std::size_t> color_chunks(PointTable& table, const TouchedBy& touched);

/// Cuts the points of a table into chunks, and colours these by its rows.
void color_chunks(PointTable& table, std::size_t points_per_chunk, const CloudPart* part = nullptr);

/// Calls body(chunk, number of the chunk) for every chunk, colour after colour, on all threads.
template <class Body>
void for_each_chunk(const PointTable& table, const Body& body) {
  for (std::size_t k = 0; k + 1 < table.color_offsets.size(); ++k) {
    const std::size_t first = table.color_offsets[k];
    parallel_for(table.color_offsets[k + 1] - first,
                 [&](std::size_t c) { body(table.chunks[first + c], first + c); });
  }
}

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/quadrature/coloring.ipp>
#endif
