#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include <tactoid/core/compiled.hpp>
#include <tactoid/geometry/box.hpp>

namespace tactoid::detail {

TACTOID_INLINE void validate_brick(const char* name, const char* length, int direction, double size, int cells,
                                   bool periodic, double origin) {
  const std::string suffix = direction < 0 ? "" : fmt::format("[{}]", direction);
  require_positive(fmt::format("{}.{}{}", name, length, suffix), size, "m");
  require_finite(fmt::format("{}.origin{}", name, suffix), origin, "m");
  const int least = periodic ? 3 : 1;
  if (cells < least)
    reject(fmt::format("{}.cells{}", name, suffix), cells, "",
           periodic ? "at least 3 in a periodic direction" : "at least 1");
}

/// One direction of a regular grid, or a piece of it.
struct GridAxis {
  double origin = 0.0, size = 0.0;  // of the whole, m
  int cells = 0;                    // of the whole
  bool periodic = false;
  std::vector<Index> nodes;         // that the piece has, by their numbers in the whole
  bool closed = false;              // there is a cell from the last node of the piece to the first

  GridAxis(double from, double length, int count, bool is_periodic)
      : origin(from), size(length), cells(count), periodic(is_periodic), closed(is_periodic) {
    nodes.resize(static_cast<std::size_t>(cells + (periodic ? 0 : 1)));
    std::iota(nodes.begin(), nodes.end(), Index{0});
  }
  [[nodiscard]] double edge() const { return size / cells; }
  [[nodiscard]] double place(std::size_t k) const { return origin + size * (static_cast<double>(nodes[k]) / static_cast<double>(cells)); }
  [[nodiscard]] std::size_t cells_here() const { return nodes.size() - (closed ? 0 : 1); }
};
template <int D>
using GridAxes = std::vector<GridAxis>;  // D of them

template <int D>
[[nodiscard]] GridAxes<D> grid_axes(const Point<D>& size, const std::array<int, static_cast<std::size_t>(D)>& cells, const std::array<bool, static_cast<std::size_t>(D)>& periodic,
                                    const Point<D>& origin) {
  GridAxes<D> axes;
  for (int k = 0; k < D; ++k) axes.emplace_back(origin[k], size[k], cells[static_cast<std::size_t>(k)], periodic[static_cast<std::size_t>(k)]);
  return axes;
}

/// Particles and cells of a grid, row by row; facets are those of what is here.
template <int D>
[[nodiscard]] PointCloud<D> grid(const GridAxes<D>& axes, const std::string& region) {
  PointCloud<D> cloud;
  cloud.regions = {region};
  std::size_t node_count = 1;
  std::size_t cell_count = 1;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    node_count *= axes[k].nodes.size();
    cell_count *= axes[k].cells_here();
    if (axes[k].periodic) cloud.period[static_cast<int>(k)] = axes[k].size;
  }
  cloud.positions.reserve(node_count);
  for (std::size_t n = 0; n < node_count; ++n) {
    Point<D> x;
    std::size_t rest = n;
    for (std::size_t k = 0; k < axes.size(); ++k) {
      x[static_cast<int>(k)] = axes[k].place(rest % axes[k].nodes.size());
      rest /= axes[k].nodes.size();
    }
    cloud.positions.push_back(x);
  }
  cloud.cells.reserve(cell_count);
  for (std::size_t c = 0; c < cell_count; ++c) {
    typename PointCloud<D>::Cell cell;
    for (std::size_t a = 0; a < cell.size(); ++a) {
      std::size_t rest = c;
      std::size_t number = 0;
      std::size_t stride = 1;
      for (std::size_t k = 0; k < axes.size(); ++k) {
        const std::size_t along = rest % axes[k].cells_here() + ((a >> k) & 1u);
        rest /= axes[k].cells_here();
        number += (along % axes[k].nodes.size()) * stride;  // wraps in periodic directions
        stride *= axes[k].nodes.size();
      }
      cell[a] = static_cast<Index>(number);
    }
    cloud.cells.push_back(cell);
  }
  cloud.cell_regions.assign(cell_count, 0);
  cloud.facets = extract_facets(cloud);
  return cloud;
}

template <int D>
PointCloud<D> brick(const Point<D>& size, const std::array<int, static_cast<std::size_t>(D)>& cells,
                    const std::array<bool, static_cast<std::size_t>(D)>& periodic,
                    const Point<D>& origin, const std::string& region) {
  return morton_ordered(grid<D>(grid_axes<D>(size, cells, periodic, origin), region));
}

/// Whether all nodes of a facet lie on one side of a grid.
template <int D, class Facet, class NodeOf>
[[nodiscard]] bool is_on_one_side(const GridAxes<D>& axes, const Facet& facet, const NodeOf& node) {
  for (std::size_t k = 0; k < axes.size(); ++k)
    for (const std::size_t side : {std::size_t{0}, std::size_t{axes[k].nodes.back()}})
      if (!axes[k].periodic && std::all_of(facet.begin(), facet.end(), [&](Index i) { return node(i)[k] == side; })) return true;
  return false;
}

/// The facets of a grid, oriented outwards, made without its cells; `number` of a node.
template <int D, class Number>
[[nodiscard]] std::vector<typename PointCloud<D>::Facet> grid_sides(const GridAxes<D>& axes, const Number& number) {
  std::vector<typename PointCloud<D>::Facet> facets;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    if (axes[k].periodic) continue;
    for (const bool upper : {false, true}) {
      // A layer of cells on the side has it as one of its sides.
      GridAxes<D> layer = axes;
      const std::size_t n = axes[k].nodes.size();
      layer[k].nodes = {axes[k].nodes[upper ? n - 2 : 0], axes[k].nodes[upper ? n - 1 : 1]};
      const PointCloud<D> cells = grid<D>(layer, "");
      const auto node = [&](Index i) {
        std::array<std::size_t, static_cast<std::size_t>(D)> of_whole{};
        for (std::size_t l = 0; l < layer.size(); ++l) {
          of_whole[l] = layer[l].nodes[i % layer[l].nodes.size()];
          i = static_cast<Index>(i / layer[l].nodes.size());
        }
        return of_whole;
      };
      for (auto facet : cells.facets) {
        const std::size_t side = axes[k].nodes[upper ? n - 1 : 0];
        if (!std::all_of(facet.begin(), facet.end(), [&](Index i) { return node(i)[k] == side; })) continue;
        for (Index& i : facet) i = number(node(i));
        facets.push_back(facet);
      }
    }
  }
  return facets;
}

/// The nodes of a grid divided among ranks: bricks, by recursive bisection along the longest direction.
template <int D>
class GridDivision {
 public:
  using Node = std::array<std::size_t, static_cast<std::size_t>(D)>;
  struct Brick {
    Node first{}, last{};  // [first, last)
  };
  GridDivision(const GridAxes<D>& axes, int ranks) : axes_(axes), ranks_(ranks) {
    for (int rank = 0; rank < ranks; ++rank) (void)brick(rank);
  }
  /// The nodes of a rank. Throws ParameterError where there are none.
  [[nodiscard]] Brick brick(int rank) const {
    return descend([&](std::size_t, std::size_t, int upper) { return rank < upper; }).first;
  }
  /// The rank of a node.
  [[nodiscard]] int owner(const Node& node) const {
    return descend([&](std::size_t along, std::size_t cut, int) { return node[along] < cut; }).second;
  }

 private:
  /// goes_low(direction, where it is cut, first rank above the cut) says on which side to go on.
  template <class GoesLow>
  [[nodiscard]] std::pair<Brick, int> descend(const GoesLow& goes_low) const {
    Brick brick;
    for (std::size_t k = 0; k < axes_.size(); ++k) brick.last[k] = axes_[k].nodes.size();
    int first = 0;
    for (int ranks = ranks_; ranks > 1;) {
      std::size_t along = axes_.size();
      double longest = 0.0;
      for (std::size_t k = 0; k < axes_.size(); ++k) {
        const std::size_t count = brick.last[k] - brick.first[k];
        if (count < 2 || !(static_cast<double>(count) * axes_[k].edge() > longest * (1.0 + 1e-9))) continue;
        longest = static_cast<double>(count) * axes_[k].edge();
        along = k;
      }
      if (along == axes_.size()) throw ParameterError(fmt::format("Part.ranks = {} is not allowed: the grid cannot be divided so often.", ranks_));
      const std::size_t count = brick.last[along] - brick.first[along];
      const int lower = ranks / 2;
      const std::size_t cut = brick.first[along] + std::clamp<std::size_t>((2 * count * static_cast<std::size_t>(lower) / static_cast<std::size_t>(ranks) + 1) / 2, 1, count - 1);
      if (goes_low(along, cut, first + lower)) {
        brick.last[along] = cut;
        ranks = lower;
      } else {
        brick.first[along] = cut;
        first += lower;
        ranks -= lower;
      }
    }
    return {brick, first};
  }

  const GridAxes<D>& axes_;
  int ranks_;
};

template <int D>
PointCloud<D> brick_part(const Point<D>& size, const std::array<int, static_cast<std::size_t>(D)>& cells, const std::array<bool, static_cast<std::size_t>(D)>& periodic,
                         const Point<D>& origin, const std::string& region, const Part& part) {
  part.validate();
  using Division = GridDivision<D>;
  using Node = typename Division::Node;
  const GridAxes<D> whole = grid_axes<D>(size, cells, periodic, origin);
  const Division division(whole, part.ranks);
  const auto own = division.brick(part.rank);

  // The piece that is here: own nodes, two supports around them, and one more for the cells.
  double spacing = 0.0, count = 1.0;
  for (const GridAxis& axis : whole) spacing = std::max(spacing, axis.edge()), count *= static_cast<double>(axis.nodes.size());
  if (count > static_cast<double>(std::numeric_limits<Index>::max())) throw ParameterError(fmt::format("The grid has {:g} particles; {} are the most that can be numbered.", count, std::numeric_limits<Index>::max()));
  GridAxes<D> here = whole;
  std::vector<std::vector<char>> complete(here.size());  // per direction and node: it has the cells on both sides
  for (std::size_t k = 0; k < here.size(); ++k) {
    const auto beyond = static_cast<std::int64_t>(std::ceil(2.0 * part.support * spacing * (1.0 + 1e-9) / whole[k].edge())) + 1;
    const auto n = static_cast<std::int64_t>(whole[k].nodes.size());
    std::int64_t first = static_cast<std::int64_t>(own.first[k]) - beyond, last = static_cast<std::int64_t>(own.last[k]) + beyond;
    GridAxis& axis = here[k];
    if (axis.periodic ? last - first < n : true) {
      if (!axis.periodic) first = std::max<std::int64_t>(first, 0), last = std::min(last, n);
      axis.nodes.clear();
      for (std::int64_t i = first; i < last; ++i) axis.nodes.push_back(static_cast<Index>((i + n) % n));
      axis.closed = false;
    }
    complete[k].assign(axis.nodes.size(), 1);
    if (axis.closed) continue;
    const auto cut = [&](Index i, Index side) { return axis.periodic || i != side; };
    if (cut(axis.nodes.front(), 0)) complete[k].front() = 0;
    if (cut(axis.nodes.back(), whole[k].nodes.back())) complete[k].back() = 0;
  }
  PointCloud<D> piece = grid<D>(here, region);

  CloudPart made(part, static_cast<std::size_t>(count));
  const auto number = [&](const Node& node) {
    std::size_t n = 0;
    for (std::size_t k = whole.size(); k-- > 0;) n = n * whole[k].nodes.size() + node[k];
    return static_cast<Index>(n);
  };
  const auto node = [&](Index n) {
    Node of_whole;
    for (std::size_t k = 0; k < whole.size(); ++k) {
      of_whole[k] = n % whole[k].nodes.size();
      n = static_cast<Index>(n / whole[k].nodes.size());
    }
    return of_whole;
  };
  const auto is_on_side = [&](const Node& of_whole) {
    for (std::size_t k = 0; k < whole.size(); ++k)
      if (!whole[k].periodic && (of_whole[k] == 0 || of_whole[k] == whole[k].nodes.back())) return true;
    return false;
  };

  // The piece in numbers of the whole.
  std::vector<Index> in_whole(piece.size());
  std::vector<char> is_complete(piece.size(), 1);
  std::array<std::vector<Index>, 4> groups;  // of numbers in the whole: on the surface of the whole, own, complete, beyond
  for (Index i = 0; i < piece.size(); ++i) {
    Node of_whole;
    std::size_t rest = i;
    bool is_own = true;
    for (std::size_t k = 0; k < here.size(); ++k) {
      const std::size_t along = rest % here[k].nodes.size();
      rest /= here[k].nodes.size();
      of_whole[k] = here[k].nodes[along];
      is_own = is_own && of_whole[k] >= own.first[k] && of_whole[k] < own.last[k];
      if (!complete[k][along]) is_complete[i] = 0;
    }
    in_whole[i] = number(of_whole);
    if (!part.surface || !is_on_side(of_whole)) groups[is_own ? 1 : is_complete[i] ? 2 : 3].push_back(in_whole[i]);
  }
  std::vector<typename PointCloud<D>::Facet> facets = part.surface ? grid_sides<D>(whole, number) : piece.facets;
  if (part.surface) {
    for (const auto& facet : facets) groups[0].insert(groups[0].end(), facet.begin(), facet.end());
    std::sort(groups[0].begin(), groups[0].end());
    groups[0].erase(std::unique(groups[0].begin(), groups[0].end()), groups[0].end());
  } else {  // the sides on which the piece is cut are no facets
    for (auto& facet : facets)
      for (Index& i : facet) i = in_whole[i];
    std::erase_if(facets, [&](const auto& facet) { return !is_on_one_side<D>(whole, facet, node); });
  }

  // Particles group by group, each along a curve.
  PointCloud<D> result;
  result.regions = piece.regions;
  result.period = piece.period;
  std::vector<std::pair<Index, Index>> places;  // number in the whole, place in the result
  std::vector<std::pair<Index, char>> completes;
  for (Index i = 0; i < piece.size(); ++i) completes.emplace_back(in_whole[i], is_complete[i]);
  std::sort(completes.begin(), completes.end());
  for (const std::vector<Index>& group : groups) {
    std::vector<Point<D>> positions;
    for (const Index n : group) {
      const Node of_whole = node(n);
      Point<D> x;
      for (std::size_t k = 0; k < whole.size(); ++k) x[static_cast<int>(k)] = whole[k].place(of_whole[k]);
      positions.push_back(x);
    }
    for (const Index k : morton_order<D>(positions)) {
      const Index n = group[k];
      const auto at = std::lower_bound(completes.begin(), completes.end(), std::pair(n, char{0}));
      places.emplace_back(n, static_cast<Index>(result.positions.size()));
      result.positions.push_back(positions[k]);
      made.add(n, division.owner(node(n)), spacing, at != completes.end() && at->first == n && at->second != 0);
    }
  }
  std::sort(places.begin(), places.end());
  const auto renumbered = [&](auto entity) {
    for (Index& i : entity) i = std::lower_bound(places.begin(), places.end(), std::pair(i, Index{0}))->second;
    return entity;
  };
  for (auto cell : piece.cells) {
    for (Index& i : cell) i = in_whole[i];
    result.cells.push_back(renumbered(cell));
  }
  result.cell_regions = std::move(piece.cell_regions);
  for (const auto& facet : facets) result.facets.push_back(renumbered(facet));
  result.part = std::make_shared<const CloudPart>(std::move(made));
  return result;
}

}  // namespace tactoid::detail

namespace tactoid {

TACTOID_INLINE void Bar::validate() const { detail::validate_brick("Bar", "length", -1, length, cells, periodic, origin); }

TACTOID_INLINE void Rectangle::validate() const {
  for (int k = 0; k < 2; ++k) {
    const auto i = static_cast<std::size_t>(k);
    detail::validate_brick("Rectangle", "size", k, size[k], cells[i], periodic[i], origin[k]);
  }
}

TACTOID_INLINE void Box::validate() const {
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    detail::validate_brick("Box", "size", k, size[k], cells[i], periodic[i], origin[k]);
  }
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template PointCloud<1> brick<1>(const Point<1>& size, const std::array<int, static_cast<std::size_t>(1)>& cells,
                                const std::array<bool, static_cast<std::size_t>(1)>& periodic, const Point<1>& origin,
                                const std::string& region);
template PointCloud<2> brick<2>(const Point<2>& size, const std::array<int, static_cast<std::size_t>(2)>& cells,
                                const std::array<bool, static_cast<std::size_t>(2)>& periodic, const Point<2>& origin,
                                const std::string& region);
template PointCloud<3> brick<3>(const Point<3>& size, const std::array<int, static_cast<std::size_t>(3)>& cells,
                                const std::array<bool, static_cast<std::size_t>(3)>& periodic, const Point<3>& origin,
                                const std::string& region);
template PointCloud<2> brick_part<2>(const Point<2>&, const std::array<int, static_cast<std::size_t>(2)>&, const std::array<bool, static_cast<std::size_t>(2)>&, const Point<2>&, const std::string&,
                                     const Part&);
template PointCloud<3> brick_part<3>(const Point<3>&, const std::array<int, static_cast<std::size_t>(3)>&, const std::array<bool, static_cast<std::size_t>(3)>&, const Point<3>&, const std::string&,
                                     const Part&);
}  // namespace tactoid::detail
#endif
