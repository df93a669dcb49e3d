#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/text.hpp>
#include <tactoid/geometry/facets.hpp>
#include <tactoid/geometry/order.hpp>
#include <tactoid/geometry/validate.hpp>
#include <tactoid/neighbors/neighbor_search.hpp>

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

/// Every triangle becomes three quadrilaterals, every tetrahedron four hexahedra, with new particles in the middle of
/// edges, faces and cells. Neighbours share them: a mesh that fits together still does.
template <int D>
  requires(D > 1)
void split_simplices(std::vector<Point<D>>& positions, std::vector<MeshCell<D>>& cells) {
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
      MeshCell<D> part{.vertices = {}, .region = cell.region, .tag = cell.tag};
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

/// The cloud of a mesh: only vertices that cells use become particles. `where` names the file in messages; `tags` are the
/// file's numbers of the positions.
template <int D>
[[nodiscard]] PointCloud<D> cloud_of_mesh(std::vector<Point<D>> positions, const std::vector<std::size_t>& tags,
                                          std::vector<MeshCell<D>> cells, std::vector<std::string> regions,
                                          const MeshOptions& options, std::string_view where) {
  options.validate();
  constexpr std::size_t corners = std::size_t{1} << D, simplex = static_cast<std::size_t>(D) + 1;
  const auto refuse = [&](std::string_view what) { throw GeometryError(fmt::format("{}: {}", where, what)); };
  if (cells.empty()) refuse(fmt::format("there are no cells of {} dimensions.", D));
  for (Point<D>& X : positions) X *= options.scale;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (!positions[i].allFinite()) refuse(fmt::format("node {} has a position that is not finite.", tags[i]));

  std::map<std::vector<std::size_t>, std::size_t> seen;
  bool any_simplex = false, any_tensor = false;
  for (const MeshCell<D>& cell : cells) {
    (cell.vertices.size() == simplex && simplex != corners ? any_simplex : any_tensor) = true;
    std::vector<std::size_t> key = cell.vertices;
    std::sort(key.begin(), key.end());
    if (std::adjacent_find(key.begin(), key.end()) != key.end())
      refuse(fmt::format("cell {} uses a node twice.", cell.tag));
    const auto [other, is_new] = seen.try_emplace(std::move(key), cell.tag);
    if (!is_new) refuse(fmt::format("cells {} and {} have the same nodes.", other->second, cell.tag));
    if (cell.vertices.size() != simplex) continue;
    Eigen::Matrix<double, D, D> edges;
    for (int k = 0; k < D; ++k) edges.col(k) = positions[cell.vertices[static_cast<std::size_t>(k) + 1]] - positions[cell.vertices[0]];
    if (!(edges.determinant() > 0.0))
      refuse(fmt::format("cell {} at {} is inverted or flat (its volume is {:g} of a unit cell).", cell.tag,
                         describe<D>(positions[cell.vertices[0]]), edges.determinant()));
  }
  if (any_simplex && any_tensor)
    refuse("simplices stand beside hexahedra or quadrilaterals: they do not fit together; use one kind.");
  if constexpr (D > 1)
    if (any_simplex) split_simplices<D>(positions, cells);

  PointCloud<D> cloud;
  cloud.regions = std::move(regions);
  std::vector<Index> number(positions.size(), ~Index{0});
  std::vector<std::size_t> tag_of_cell;
  for (const MeshCell<D>& cell : cells) {
    typename PointCloud<D>::Cell c;
    for (std::size_t a = 0; a < corners; ++a) {
      Index& i = number[cell.vertices[a]];
      if (i == ~Index{0}) {
        i = static_cast<Index>(cloud.size());
        cloud.positions.push_back(positions[cell.vertices[a]]);
      }
      c[a] = i;
    }
    cloud.cells.push_back(c);
    cloud.cell_regions.push_back(static_cast<Index>(cell.region));
    const Corners<D> x = cell_corners(cloud, c);
    for (std::size_t a = 0; a < corners; ++a) {
      Point<D> xi;
      for (int k = 0; k < D; ++k) xi[k] = (a >> k & 1u) != 0 ? 1.0 : 0.0;
      if (!(cell_jacobian<D>(x, xi).determinant() > 0.0))
        refuse(fmt::format("cell {} is inverted or degenerate at {}.", cell.tag, describe<D>(x[a])));
    }
  }

  const std::vector<double> shortest = shortest_edges(cloud);
  const double near = options.coincidence * *std::min_element(shortest.begin(), shortest.end());
  const NeighborSearch<D> search(cloud.positions);
  std::vector<Index> around;
  for (std::size_t i = 0; near > 0.0 && i < cloud.size(); ++i) {
    search.within(cloud.positions[i], near, around);
    if (around.size() > 1)
      refuse(fmt::format("two nodes coincide at {}: the mesh does not hold together there.", describe<D>(cloud.positions[i])));
  }
  cloud.facets = extract_facets(cloud);
  cloud = morton_ordered(cloud);
  validate(cloud);
  return cloud;
}

}  // namespace detail
}  // namespace tactoid
