#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/input/mesh.hpp>
#include <tactoid/neighbors/neighbor_search.hpp>
#include <tactoid/geometry/measures.hpp>

namespace tactoid::detail {

TACTOID_INLINE std::size_t region_number(std::vector<std::string>& regions, std::string_view name) {
  const auto found = std::find(regions.begin(), regions.end(), name);
  if (found != regions.end()) return static_cast<std::size_t>(found - regions.begin());
  regions.emplace_back(name);
  return regions.size() - 1;
}

template <int D>
PointCloud<D> cloud_of_mesh(std::vector<Point<D>> positions, const std::vector<std::size_t>& tags,
                            std::vector<MeshCell<D>> cells, std::vector<std::string> regions, const MeshOptions& options,
                            std::string_view where, [[maybe_unused]] std::span<const std::size_t> region_of) {
  options.validate();
  constexpr std::size_t corners = std::size_t{1} << D, simplex = static_cast<std::size_t>(D) + 1;
  const auto refuse = [&](std::string_view what) { throw GeometryError(fmt::format("{}: {}", where, what)); };
  if (cells.empty()) refuse(fmt::format("there are no cells of {} dimensions; points without cells are read from a table (read_csv).", D));
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
    for (int k = 0; k < D; ++k)
      edges.col(k) = positions[cell.vertices[static_cast<std::size_t>(k) + 1]] - positions[cell.vertices[0]];
    if (!(edges.determinant() > 0.0))
      refuse(fmt::format("cell {} at {} is inverted or flat (its volume is {:g} of a unit cell).", cell.tag,
     describe<D>(positions[cell.vertices[0]]), edges.determinant()));
  }
  if (any_simplex && any_tensor)
    refuse("simplices stand beside hexahedra or quadrilaterals: they do not fit together; use one kind.");
  if constexpr (D > 1)
    if (any_simplex) split_simplices<D>(positions, cells, region_of);

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
    tag_of_cell.push_back(cell.tag);
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
  if constexpr (D > 1) check_surface(cloud, tag_of_cell, where);
  cloud = morton_ordered(cloud);
  validate(cloud);
  return cloud;
}

}  // namespace tactoid::detail

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template PointCloud<1> cloud_of_mesh<1>(std::vector<Point<1>> positions, const std::vector<std::size_t>& tags,
                                        std::vector<MeshCell<1>> cells, std::vector<std::string> regions,
                                        const MeshOptions& options, std::string_view where,
                                        std::span<const std::size_t> region_of);
template PointCloud<2> cloud_of_mesh<2>(std::vector<Point<2>> positions, const std::vector<std::size_t>& tags,
                                        std::vector<MeshCell<2>> cells, std::vector<std::string> regions,
                                        const MeshOptions& options, std::string_view where,
                                        std::span<const std::size_t> region_of);
template PointCloud<3> cloud_of_mesh<3>(std::vector<Point<3>> positions, const std::vector<std::size_t>& tags,
                                        std::vector<MeshCell<3>> cells, std::vector<std::string> regions,
                                        const MeshOptions& options, std::string_view where,
                                        std::span<const std::size_t> region_of);
}  // namespace tactoid::detail
#endif
