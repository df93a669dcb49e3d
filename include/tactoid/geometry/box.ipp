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
using GridAxes = std::vector<GridAxis>;  // one for each dimension

template <int D>
[[nodiscard]] GridAxes grid_axes(const Point<D>& size, const std::array<int, static_cast<std::size_t>(D)>& cells, const std::array<bool, static_cast<std::size_t>(D)>& periodic,
                                    const Point<D>& origin) {
  GridAxes axes;
  for (int k = 0; k < D; ++k) axes.emplace_back(origin[k], size[k], cells[static_cast<std::size_t>(k)], periodic[static_cast<std::size_t>(k)]);
  return axes;
}

/// Particles and cells of a grid, row by row; facets are those of what is here.
template <int D>
[[nodiscard]] PointCloud<D> grid(const GridAxes& axes, const std::string& region) {
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

/// Numbers of the nodes of a grid, row by row.
template <int D>
class GridNumbers {
 public:
  using Node = std::array<std::size_t, static_cast<std::size_t>(D)>;
  /// Of a whole grid, or of a piece: places of nodes are then those in the whole.
  explicit GridNumbers(const GridAxes& axes) : axes_(axes) {}
  [[nodiscard]] double count() const {
    double n = 1.0;
    for (const GridAxis& axis : axes_) n *= static_cast<double>(axis.nodes.size());
    return n;
  }
  [[nodiscard]] Index number(const Node& node) const {
    std::size_t n = 0;
    for (std::size_t k = axes_.size(); k-- > 0;) n = n * axes_[k].nodes.size() + node[k];
    return static_cast<Index>(n);
  }
  [[nodiscard]] Node node(Index number) const {
    Node node;
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      node[k] = axes_[k].nodes[number % axes_[k].nodes.size()];
      number = static_cast<Index>(number / axes_[k].nodes.size());
    }
    return node;
  }
  [[nodiscard]] Point<D> place(const Node& node) const {
    Point<D> X;
    for (std::size_t k = 0; k < axes_.size(); ++k) X[static_cast<int>(k)] = axes_[k].place(node[k]);
    return X;
  }
  /// Whether all of some nodes lie on one side of the whole grid, which is no side where it is periodic.
  template <class Nodes>
  [[nodiscard]] bool on_one_side(const Nodes& nodes) const {
    for (std::size_t k = 0; k < axes_.size(); ++k)
      for (const std::size_t side : {std::size_t{0}, std::size_t{axes_[k].nodes.back()}})
        if (!axes_[k].periodic && std::all_of(nodes.begin(), nodes.end(), [&](const Node& node) { return node[k] == side; })) return true;
    return false;
  }

 private:
  const GridAxes& axes_;
};

/// The facets of a whole grid, oriented outwards, made without its cells.
template <int D>
[[nodiscard]] std::vector<typename PointCloud<D>::Facet> grid_sides(const GridAxes& axes) {
  const GridNumbers<D> whole(axes);
  std::vector<typename PointCloud<D>::Facet> facets;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    if (axes[k].periodic) continue;
    for (const bool upper : {false, true}) {
      // A layer of cells on the side has it as one of its sides.
      GridAxes layer = axes;
      const std::size_t n = axes[k].nodes.size();
      layer[k].nodes = {axes[k].nodes[upper ? n - 2 : 0], axes[k].nodes[upper ? n - 1 : 1]};
      const GridNumbers<D> of_layer(layer);
      const std::size_t side = axes[k].nodes[upper ? n - 1 : 0];
      for (auto facet : grid<D>(layer, "").facets) {
        if (!std::all_of(facet.begin(), facet.end(), [&](Index i) { return of_layer.node(i)[k] == side; })) continue;
        for (Index& i : facet) i = whole.number(of_layer.node(i));
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
  using Node = typename GridNumbers<D>::Node;
  struct Brick {
    Node first{}, last{};  // [first, last)
  };
  GridDivision(const GridAxes& axes, int ranks) : axes_(axes), ranks_(ranks) {
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

  const GridAxes& axes_;
  int ranks_;
};

/// One direction of the piece of a grid that a part needs: own nodes, `reach` around them (m), and one more for the cells. `complete` becomes 1 for nodes that have the cells on both sides.
[[nodiscard]] inline GridAxis piece_of(const GridAxis& whole, std::size_t own_first, std::size_t own_last, double reach, std::vector<char>& complete) {
  GridAxis piece = whole;
  const auto beyond = static_cast<std::int64_t>(std::ceil(reach / whole.edge())) + 1, n = static_cast<std::int64_t>(whole.nodes.size());
  std::int64_t first = static_cast<std::int64_t>(own_first) - beyond, last = static_cast<std::int64_t>(own_last) + beyond;
  if (!whole.periodic) first = std::max<std::int64_t>(first, 0), last = std::min(last, n);
  if (!whole.periodic || last - first < n) {
    piece.nodes.clear();
    for (std::int64_t i = first; i < last; ++i) piece.nodes.push_back(static_cast<Index>((i + n) % n));
    piece.closed = false;
  }
  complete.assign(piece.nodes.size(), 1);
  if (piece.closed) return piece;
  if (whole.periodic || piece.nodes.front() != 0) complete.front() = 0;
  if (whole.periodic || piece.nodes.back() != whole.nodes.back()) complete.back() = 0;
  return piece;
}

template <int D>
PointCloud<D> brick_part(const Point<D>& size, const std::array<int, static_cast<std::size_t>(D)>& cells, const std::array<bool, static_cast<std::size_t>(D)>& periodic,
                         const Point<D>& origin, const std::string& region, const Part& part) {
  part.validate();
  using Node = typename GridNumbers<D>::Node;
  const GridAxes axes = grid_axes<D>(size, cells, periodic, origin);
  const GridNumbers<D> whole(axes);
  if (whole.count() > static_cast<double>(std::numeric_limits<Index>::max()))
    throw ParameterError(fmt::format("The grid has {:g} particles; {} are the most that can be numbered.", whole.count(), std::numeric_limits<Index>::max()));
  const GridDivision<D> division(axes, part.ranks);
  const auto own = division.brick(part.rank);
  double spacing = 0.0;
  for (const GridAxis& axis : axes) spacing = std::max(spacing, axis.edge());
  GridAxes piece_axes;
  std::vector<std::vector<char>> complete(axes.size());  // per direction and node
  for (std::size_t k = 0; k < axes.size(); ++k) piece_axes.push_back(piece_of(axes[k], own.first[k], own.last[k], 2.0 * part.support * spacing * (1.0 + 1e-9), complete[k]));
  PointCloud<D> piece = grid<D>(piece_axes, region);

  // From now on in numbers of the whole, in groups: on its surface, own, complete, beyond.
  struct Particle {
    Index number, place;
    bool complete;
    bool operator<(const Particle& other) const { return number < other.number; }
  };
  const GridNumbers<D> of_piece(piece_axes);
  std::vector<Index> in_whole(piece.size());
  std::vector<Particle> particles;
  std::array<std::vector<Index>, 4> groups;
  for (Index i = 0; i < piece.size(); ++i) {
    const Node node = of_piece.node(i);
    bool is_own = true, is_complete = true;
    for (std::size_t k = 0, rest = i; k < axes.size(); rest /= piece_axes[k].nodes.size(), ++k) {
      is_own = is_own && node[k] >= own.first[k] && node[k] < own.last[k];
      is_complete = is_complete && complete[k][rest % piece_axes[k].nodes.size()];
    }
    in_whole[i] = whole.number(node);
    particles.push_back({in_whole[i], 0, is_complete});
    if (!part.surface || !whole.on_one_side(std::array<Node, 1>{node})) groups[is_own ? 1 : is_complete ? 2 : 3].push_back(in_whole[i]);
  }
  const auto into_whole = [&](auto& list) {
    for (auto& entity : list)
      for (Index& i : entity) i = in_whole[i];
  };
  into_whole(piece.cells);
  into_whole(piece.facets);
  if (part.surface) {
    piece.facets = grid_sides<D>(axes);
    for (const auto& facet : piece.facets) groups[0].insert(groups[0].end(), facet.begin(), facet.end());
    std::sort(groups[0].begin(), groups[0].end());
    groups[0].erase(std::unique(groups[0].begin(), groups[0].end()), groups[0].end());
    const std::size_t here = particles.size();
    std::sort(particles.begin(), particles.end());
    for (const Index n : groups[0])
      if (!std::binary_search(particles.begin(), particles.begin() + static_cast<std::ptrdiff_t>(here), Particle{n, 0, false})) particles.push_back({n, 0, false});
  } else {  // the sides on which the piece is cut are no facets
    std::erase_if(piece.facets, [&](const auto& facet) {
      std::array<Node, std::tuple_size_v<typename PointCloud<D>::Facet>> nodes;
      std::transform(facet.begin(), facet.end(), nodes.begin(), [&](Index i) { return whole.node(i); });
      return !whole.on_one_side(nodes);
    });
  }
  std::sort(particles.begin(), particles.end());
  const auto particle = [&](Index number) -> Particle& { return *std::lower_bound(particles.begin(), particles.end(), Particle{number, 0, false}); };

  // Each group along a curve.
  CloudPart made(part, static_cast<std::size_t>(whole.count()));
  piece.positions.clear();
  for (const std::vector<Index>& group : groups) {
    std::vector<Point<D>> places;
    for (const Index n : group) places.push_back(whole.place(whole.node(n)));
    for (const Index k : morton_order<D>(places)) {
      Particle& p = particle(group[k]);
      p.place = static_cast<Index>(piece.positions.size());
      piece.positions.push_back(places[k]);
      made.add(p.number, division.owner(whole.node(p.number)), spacing, p.complete);
    }
  }
  const auto renumber = [&](auto& list) {
    for (auto& entity : list)
      for (Index& i : entity) i = particle(i).place;
  };
  renumber(piece.cells);
  renumber(piece.facets);
  piece.part = std::make_shared<const CloudPart>(std::move(made));
  return piece;
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
