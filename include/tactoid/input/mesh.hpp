#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/text.hpp>
#include <tactoid/geometry/facets.hpp>
#include <tactoid/geometry/order.hpp>
#include <tactoid/geometry/validate.hpp>

namespace tactoid {

/// How a mesh becomes a cloud.
struct MeshOptions {
  double scale = 1.0;  ///< m per unit of length of the file; > 0
  /// Particles nearer to each other than this part of the shortest cell edge are refused as coincident; in [0, 1).
  double coincidence = 1e-6;

  /// Throws ParameterError unless scale > 0 and coincidence is in [0, 1).
  void validate() const {
    require_positive("MeshOptions.scale", scale, "m");
    if (!(coincidence >= 0.0 && coincidence < 1.0)) reject("MeshOptions.coincidence", coincidence, "", "in [0, 1)");
  }
};

/// Cells as a file gives them: their vertices in tensor order (2^D), or those of a simplex (D + 1) of positive volume.
template <int D>
struct MeshCell {
  std::vector<std::size_t> vertices;  ///< numbers of positions
  std::size_t region = 0;             ///< index into the names of the regions
  std::size_t tag = 0;  ///< by which the file names the cell
};

namespace detail {

/// Positions of the vertices of a simplex, in an even permutation that begins with vertex `a`.
template <int D>
  requires(D > 1)
[[nodiscard]] std::array<std::size_t, static_cast<std::size_t>(D) + 1> even_permutation(std::size_t a) {
  if constexpr (D == 2) {
    return {a, (a + 1) % 3, (a + 2) % 3};
  } else {
    constexpr std::array<std::array<std::size_t, 4>, 4> of = {{{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}}};
    return of[a];
  }
}

/// The number of the region of that name, which is added if it is new.
[[nodiscard]] std::size_t region_number(std::vector<std::string>& regions, std::string_view name);

/// Vertices at which a surface of closed loops of vertices (facets; the two ends, where D = 2) is not that of a body:
/// the sides of its facets have not two facets each, or its facets around a vertex are not one ring. Ascending.
template <int D, class Loops>
  requires(D > 1)
[[nodiscard]] std::vector<Index> singular_vertices(const Loops& loops) {
  using Side = std::array<Index, static_cast<std::size_t>(D) - 1>;
  std::vector<std::pair<Side, Index>> sides;     // with the facet
  std::vector<std::pair<Index, Index>> corners;  // vertex, facet
  for (std::size_t f = 0; f < loops.size(); ++f)
    for (std::size_t k = 0; k < loops[f].size(); ++k) {
      const Index a = loops[f][k], b = loops[f][(k + 1) % loops[f].size()];
      corners.emplace_back(a, static_cast<Index>(f));
      if constexpr (D == 2)
        sides.push_back({Side{a}, static_cast<Index>(f)});
      else
        sides.push_back({Side{std::min(a, b), std::max(a, b)}, static_cast<Index>(f)});
    }
  std::sort(sides.begin(), sides.end());
  std::sort(corners.begin(), corners.end());
  std::vector<Index> singular;
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && sides[last].first == sides[first].first) ++last;
    if (last - first != 2) singular.insert(singular.end(), sides[first].first.begin(), sides[first].first.end());
  }
  if constexpr (D == 3) {
    // From a facet at a vertex over the two sides that end there: does the walk meet all facets of the vertex?
    std::vector<Index> near;
    for (std::size_t first = 0, last = 0; first < corners.size(); first = last) {
      while (last < corners.size() && corners[last].first == corners[first].first) ++last;
      const Index v = corners[first].first;
      near.assign(1, corners[first].second);
      for (std::size_t n = 0; n < near.size(); ++n) {
        const auto& loop = loops[near[n]];
        for (std::size_t k = 0; k < loop.size(); ++k) {
          const Index a = loop[k], b = loop[(k + 1) % loop.size()];
          if (a != v && b != v) continue;
          const Side side = {std::min(a, b), std::max(a, b)};
          for (auto at = std::lower_bound(sides.begin(), sides.end(), std::pair(side, Index{0}));
               at != sides.end() && at->first == side; ++at)
            if (std::find(near.begin(), near.end(), at->second) == near.end()) near.push_back(at->second);
        }
      }
      if (near.size() != last - first) singular.push_back(v);
    }
  }
  std::sort(singular.begin(), singular.end());
  singular.erase(std::unique(singular.begin(), singular.end()), singular.end());
  return singular;
}

/// A facet or the side of a cell as a loop of vertices, by its tensor order.
template <std::size_t N>
[[nodiscard]] std::array<Index, N> loop_of(std::array<Index, N> facet) {
  if constexpr (N == 4) std::swap(facet[2], facet[3]);
  return facet;
}

/// Every triangle becomes three quadrilaterals, every tetrahedron four hexahedra, with new particles in the middle of
/// edges, faces and cells. Neighbours share them: a mesh that fits together still does. Where `region_of` is not empty,
/// the part of a cell at a vertex is in that vertex's region.
template <int D>
  requires(D > 1)
void split_simplices(std::vector<Point<D>>& positions, std::vector<MeshCell<D>>& cells,
                     std::span<const std::size_t> region_of = {}) {
  std::map<std::vector<std::size_t>, std::size_t> centers;  // of the sorted vertices of an edge, a face, a cell
  const auto center = [&](std::vector<std::size_t> vertices) {
    std::sort(vertices.begin(), vertices.end());
    const auto [place, is_new] = centers.try_emplace(vertices, positions.size());
    if (is_new) {
      Point<D> middle = Point<D>::Zero();
      for (const std::size_t v : vertices) middle += positions[v];
      positions.push_back(middle / static_cast<double>(vertices.size()));
    }
    return place->second;
  };
  std::vector<MeshCell<D>> split;
  for (const MeshCell<D>& cell : cells)
    for (std::size_t a = 0; a <= static_cast<std::size_t>(D); ++a) {
      const auto p = even_permutation<D>(a);
      MeshCell<D> part{.vertices = {}, .region = region_of.empty() ? cell.region : region_of[cell.vertices[a]], .tag = cell.tag};
      // Corner (i, j, k) of the part is the middle of vertex a and of those of the vertices p₁, p₂, p₃ whose bit is set.
      for (std::size_t corner = 0; corner < (std::size_t{1} << D); ++corner) {
        std::vector<std::size_t> of = {cell.vertices[a]};
        for (std::size_t k = 0; k < static_cast<std::size_t>(D); ++k)
          if ((corner >> k & 1u) != 0) of.push_back(cell.vertices[p[k + 1]]);
        part.vertices.push_back(of.size() == 1 ? of.front() : center(std::move(of)));
      }
      split.push_back(std::move(part));
    }
  cells = std::move(split);
}

/// Refuses cells that overlap or whose surface is none of a body: a side belongs to one cell, or to two that stand on
/// both sides of it; facets meet in pairs along edges, and in one ring around a vertex.
template <int D>
  requires(D > 1)
void check_surface(const PointCloud<D>& cloud, const std::vector<std::size_t>& tags,
                   std::string_view where) {
  using Facet = typename PointCloud<D>::Facet;
  struct Side {
    Facet key;  // the loop from its least vertex, in the direction of its lesser neighbour
    bool turned;
    std::size_t cell;
    bool operator<(const Side& other) const { return std::tie(key, cell) < std::tie(other.key, other.cell); }
  };
  std::vector<Side> sides;
  PointCloud<D> one;
  for (std::size_t c = 0; c < cloud.cells.size(); ++c) {
    one.cells = {cloud.cells[c]};
    for (const Facet& facet : extract_facets(one)) {
      Side side{loop_of(facet), false, c};
      std::rotate(side.key.begin(), std::min_element(side.key.begin(), side.key.end()), side.key.end());
      if constexpr (D == 2)
        side.turned = side.key[0] != facet[0];
      else if (side.key[3] < side.key[1])
        side.turned = true, std::swap(side.key[1], side.key[3]);
      sides.push_back(side);
    }
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && sides[last].key == sides[first].key) ++last;
    if (last - first > 2 || (last - first == 2 && sides[first].turned == sides[first + 1].turned))
      throw GeometryError(fmt::format("{}: cells {} and {} overlap: they stand on the same side of a face at {}.",
                                      where, tags[sides[last - 2].cell], tags[sides[last - 1].cell],
                                      describe<D>(cloud.positions[sides[first].key[0]])));
  }
  std::vector<Facet> loops;
  for (const Facet& facet : cloud.facets) loops.push_back(loop_of(facet));
  if (const std::vector<Index> singular = singular_vertices<D>(loops); !singular.empty())
    throw GeometryError(fmt::format(
        "{}: the surface is not that of a body at {}: parts of it touch there in a point or along an edge only, or "
        "cells do not fit together.",
        where, describe<D>(cloud.positions[singular.front()])));
}

/// The cloud of a mesh: only vertices that cells use become particles. `where` names the file in messages; `tags` are
/// the file's numbers of the positions; `region_of` (if not empty) are regions of the vertices of simplices, see
/// split_simplices.
template <int D>
[[nodiscard]] PointCloud<D> cloud_of_mesh(std::vector<Point<D>> positions, const std::vector<std::size_t>& tags,
                                          std::vector<MeshCell<D>> cells, std::vector<std::string> regions,
                                          const MeshOptions& options, std::string_view where,
                                          [[maybe_unused]] std::span<const std::size_t> region_of = {});

}  // namespace detail
}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/input/mesh.ipp>
#endif
