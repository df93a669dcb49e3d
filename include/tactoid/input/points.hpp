#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include <tactoid/core/errors.hpp>
#include <tactoid/input/delaunay.hpp>
#include <tactoid/input/mesh.hpp>
#include <tactoid/neighbors/neighbor_search.hpp>

namespace tactoid {

/// How points without cells become a cloud.
struct PointsOptions {
  double scale = 1.0;  ///< m per unit of length of the points; > 0
  /// A tetrahedron (triangle) of the Delaunay triangulation belongs to the body if the radius of its circumscribed ball
  /// is at most this many spacings; > 0. A lattice needs 0.87 (D = 2: 0.71). Larger values close gaps and hollows.
  double alpha = 1.4;
  /// Points nearer to each other than this part of the spacing are refused as coincident; in [0, 1).
  double coincidence = 1e-6;
  /// Where volumes are given: largest difference of their sum from the volume of the cells, over the latter; > 0.
  double volume_tolerance = 0.1;

  /// Throws ParameterError for a value out of its range.
  void validate() const {
    require_positive("PointsOptions.scale", scale, "m");
    require_positive("PointsOptions.alpha", alpha);
    if (!(coincidence >= 0.0 && coincidence < 1.0)) reject("PointsOptions.coincidence", coincidence, "", "in [0, 1)");
    require_positive("PointsOptions.volume_tolerance", volume_tolerance);
  }
};

/// Points as a file gives them: all lists that are not empty have an entry per point.
template <int D>
struct Points {
  std::vector<Point<D>> positions{};         ///< in units of length of the file
  std::vector<double> volumes{};             ///< in its units³ (units²); empty where none are given
  std::vector<std::size_t> point_regions{};  ///< indices into `regions`; empty: all 0
  std::vector<std::string> regions = {"body"};  ///< their names
};

namespace detail {

/// Simplices between points that are a body: Delaunay's without those that are too large (alpha shape), without
/// slivers.
template <int D>
class AlphaShape {
 public:
  static constexpr std::size_t vertices = static_cast<std::size_t>(D) + 1;
  using Simplex = std::array<Index, vertices>;
  /// Of a regular tetrahedron the quality is 0.71, of a regular triangle 0.87. Below this number a simplex is a sliver,
  /// which is replaced where others can fill its place,
  static constexpr double sliver = 0.01;
  /// and below this one it is taken off the surface: its height is less than a thousandth of its edges.
  static constexpr double flat = 1e-3;

  AlphaShape(const std::vector<Point<D>>& points, const std::vector<double>& spacing, double alpha)
      : points_(points), spacing_(spacing), alpha_(alpha), simplices_(Delaunay<D>(points).simplices()) {
    find_neighbors();
    choose();
    peel();
    mend();
    std::vector<Simplex> kept;
    for (std::size_t s = 0; s < simplices_.size(); ++s)
      if (kept_[s]) kept.push_back(simplices_[s]);
    simplices_ = std::move(kept);
    if constexpr (D == 3) replace_slivers();
  }

  [[nodiscard]] const std::vector<Simplex>& simplices() const { return simplices_; }
  /// Points where the surface touches itself all the same.
  [[nodiscard]] const std::vector<Index>& singular() const { return singular_; }

  /// D! times the volume over the cube (square) of the root mean square of the edges.
  [[nodiscard]] double quality(const Simplex& s) const {
    double squares = 0.0;
    for (std::size_t a = 0; a < vertices; ++a)
      for (std::size_t b = 0; b < a; ++b) squares += (points_[s[a]] - points_[s[b]]).squaredNorm();
    return volume(s) / std::pow(squares / (D * (D + 1) / 2), 0.5 * D);
  }
  /// D! times the volume.
  [[nodiscard]] double volume(const Simplex& s) const { return edges(s).determinant(); }

 private:
  static constexpr Index none = ~Index{0};

  [[nodiscard]] Eigen::Matrix<double, D, D> edges(const Simplex& s) const {
    Eigen::Matrix<double, D, D> e;
    for (int k = 0; k < D; ++k) e.col(k) = points_[s[static_cast<std::size_t>(k) + 1]] - points_[s[0]];
    return e;
  }

  /// Radius of the ball through the vertices, over the mean spacing there. The ball is one of the triangulation's own
  /// metric, in which it is empty of other points: slivers would have any radius in another one.
  [[nodiscard]] double relative_radius(const Simplex& s) const {
    const Eigen::Matrix<double, D, D> metric = Delaunay<D>::metric(), e = edges(s);
    Point<D> squares;
    for (int k = 0; k < D; ++k) squares[k] = 0.5 * e.col(k).dot(metric * e.col(k));
    const Point<D> center = Eigen::Matrix<double, D, D>((metric * e).transpose()).partialPivLu().solve(squares);
    const double radius = std::sqrt(center.dot(metric * center));
    return (std::isfinite(radius) ? radius : std::numeric_limits<double>::infinity()) / mean_spacing(s);
  }
  [[nodiscard]] double mean_spacing(const Simplex& s) const {
    double sum = 0.0;
    for (const Index v : s) sum += spacing_[v];
    return sum / static_cast<double>(vertices);
  }

  void find_neighbors() {
    struct Face {
      std::array<Index, vertices - 1> key;
      std::size_t simplex, place;
      bool operator<(const Face& other) const { return key < other.key; }
    };
    std::vector<Face> faces;
    faces.reserve(simplices_.size() * vertices);
    for (std::size_t s = 0; s < simplices_.size(); ++s)
      for (std::size_t i = 0; i < vertices; ++i) {
        Face face{{}, s, i};
        for (std::size_t k = 0, a = 0; k < vertices; ++k)
          if (k != i) face.key[a++] = simplices_[s][k];
        std::sort(face.key.begin(), face.key.end());
        faces.push_back(face);
      }
    std::sort(faces.begin(), faces.end());
    Simplex nobody;
    nobody.fill(none);
    across_.assign(simplices_.size(), nobody);
    for (std::size_t k = 0; k + 1 < faces.size(); ++k) {
      const Face &a = faces[k], &b = faces[k + 1];
      if (a.key != b.key) continue;
      across_[a.simplex][a.place] = static_cast<Index>(b.simplex);
      across_[b.simplex][b.place] = static_cast<Index>(a.simplex);
    }
  }

  void choose() {
    kept_.resize(simplices_.size());
    for (std::size_t s = 0; s < simplices_.size(); ++s) {
      radius_.push_back(relative_radius(simplices_[s]));
      quality_.push_back(quality(simplices_[s]));
      // Round-off decides about the radius of a flat one; its edges tell whether it lies between neighbours.
      kept_[s] = quality_[s] < flat ? longest_edge(simplices_[s]) <= 2.0 * alpha_ * mean_spacing(simplices_[s])
                                    : radius_[s] <= alpha_;
    }
  }
  [[nodiscard]] double longest_edge(const Simplex& s) const {
    double longest = 0.0;
    for (std::size_t a = 0; a < vertices; ++a)
      for (std::size_t b = 0; b < a; ++b) longest = std::max(longest, (points_[s[a]] - points_[s[b]]).norm());
    return longest;
  }
  [[nodiscard]] bool outside(Index s) const { return s == none || !kept_[s]; }

  /// Takes flat simplices off the surface, from outside to inside, as long as their vertices belong to others.
  void peel() {
    std::vector<std::size_t> users(points_.size(), 0), open;
    for (std::size_t s = 0; s < simplices_.size(); ++s) {
      if (!kept_[s]) continue;
      for (const Index v : simplices_[s]) ++users[v];
      if (quality_[s] < flat) open.push_back(s);
    }
    while (!open.empty()) {
      const std::size_t s = open.back();
      open.pop_back();
      const bool at_surface = std::any_of(across_[s].begin(), across_[s].end(), [&](Index t) { return outside(t); });
      const bool needed =
          std::any_of(simplices_[s].begin(), simplices_[s].end(), [&](Index v) { return users[v] == 1; });
      if (!kept_[s] || !at_surface || needed) continue;
      kept_[s] = 0;
      for (const Index v : simplices_[s]) --users[v];
      for (const Index t : across_[s])
        if (!outside(t) && quality_[t] < flat) open.push_back(t);
    }
  }

  /// Where the surface touches itself in an edge or a point, the smallest of the simplices that were left out there
  /// come back, one per place and round, up to twice the radius that is allowed elsewhere.
  void mend() {
    for (int round = 0; round < 50; ++round) {
      std::vector<std::array<Index, vertices - 1>> faces;
      for (std::size_t s = 0; s < simplices_.size(); ++s)
        for (std::size_t i = 0; kept_[s] && i < vertices; ++i)
          if (outside(across_[s][i])) {
            std::array<Index, vertices - 1> face;
            for (std::size_t k = 0, a = 0; k < vertices; ++k)
              if (k != i) face[a++] = simplices_[s][k];
            faces.push_back(face);
          }
      singular_ = singular_vertices<D>(faces);
      if (singular_.empty()) return;
      std::vector<std::pair<double, std::size_t>> best(points_.size(), {2.0 * alpha_, none});
      std::vector<char> wanted(points_.size(), 0);
      for (const Index v : singular_) wanted[v] = 1;
      for (std::size_t s = 0; s < simplices_.size(); ++s)
        for (const Index v : simplices_[s])
          if (!kept_[s] && wanted[v] && quality_[s] >= flat) best[v] = std::min(best[v], {radius_[s], s});
      bool changed = false;
      for (const Index v : singular_)
        if (best[v].second != none) kept_[best[v].second] = changed = true;
      if (!changed) return;
    }
  }

  // Replacing slivers: of the ways to fill the place of the tetrahedra around an edge, or of two that share a face,
  // with others between the same points, the one whose worst tetrahedron is best. (L. Freitag, C. Ollivier-Gooch, Int.
  // J. Numer. Meth. Engng 1997, 40, 3979.)
  struct Change {
    double quality = -std::numeric_limits<double>::infinity();
    std::vector<std::size_t> gone;
    std::vector<Simplex> made;
  };

  void replace_slivers() {
    users_.assign(points_.size(), {});
    alive_.assign(simplices_.size(), 1);
    std::vector<std::size_t> open;
    for (std::size_t s = 0; s < simplices_.size(); ++s) {
      for (const Index v : simplices_[s]) users_[v].push_back(s);
      if (quality(simplices_[s]) < sliver) open.push_back(s);
    }
    // Every change makes the worst of its tetrahedra better: there is an end, and it is not far where slivers are few.
    const std::size_t enough = 50 * open.size();
    for (std::size_t n = 0; n < open.size() && n < enough; ++n) {
      if (!alive_[open[n]]) continue;
      Change best;
      for (std::size_t a = 0; a < 4; ++a) {
        swap_face(open[n], a, best);
        for (std::size_t b = 0; b < a; ++b) remove_edge(simplices_[open[n]][a], simplices_[open[n]][b], best);
      }
      if (best.made.empty()) continue;
      for (const std::size_t s : best.gone) {
        alive_[s] = 0;
        for (const Index v : simplices_[s]) std::erase(users_[v], s);
      }
      for (const Simplex& s : best.made) {
        for (const Index v : s) users_[v].push_back(simplices_.size());
        if (quality(s) < sliver) open.push_back(simplices_.size());
        simplices_.push_back(s);
        alive_.push_back(1);
      }
    }
    std::size_t count = 0;
    for (std::size_t s = 0; s < simplices_.size(); ++s)
      if (alive_[s]) simplices_[count++] = simplices_[s];
    simplices_.resize(count);
  }

  void propose(Change change, Change& best) const {
    double before = std::numeric_limits<double>::infinity();
    for (const std::size_t s : change.gone) before = std::min(before, quality(simplices_[s]));
    if (change.quality > before + 1e-4 && change.quality > best.quality) best = std::move(change);
  }

  /// The two tetrahedra on both sides of a face become three around the edge between their apices.
  void swap_face(std::size_t s, std::size_t place, Change& best) const {
    const auto p = even_permutation<3>(place);
    const Simplex& v = simplices_[s];
    // Seen from the apex the loop is clockwise: a, b, c around the edge from the apex to the one across are positive.
    const Index apex = v[p[0]], a = v[p[1]], b = v[p[2]], c = v[p[3]];
    for (const std::size_t t : users_[a]) {
      const Simplex& w = simplices_[t];
      if (t == s || std::find(w.begin(), w.end(), b) == w.end() || std::find(w.begin(), w.end(), c) == w.end())
        continue;
      const Index other = *std::find_if(w.begin(), w.end(), [&](Index x) { return x != a && x != b && x != c; });
      Change change{std::numeric_limits<double>::infinity(),
                    {s, t},
                    {{apex, other, a, b}, {apex, other, b, c}, {apex, other, c, a}}};
      for (const Simplex& made : change.made) change.quality = std::min(change.quality, quality(made));
      propose(std::move(change), best);
    }
  }

  /// The tetrahedra around an edge inside the body become those over and under a triangulation of their ring.
  void remove_edge(Index a, Index b, Change& best) const {
    Change change;
    std::vector<std::pair<Index, Index>> links;  // the opposite edges, turning about a → b
    for (const std::size_t s : users_[a]) {
      const Simplex& v = simplices_[s];
      if (std::find(v.begin(), v.end(), b) == v.end()) continue;
      auto p = even_permutation<3>(static_cast<std::size_t>(std::find(v.begin(), v.end(), a) - v.begin()));
      while (v[p[1]] != b) std::rotate(p.begin() + 1, p.begin() + 2, p.end());
      change.gone.push_back(s);
      links.emplace_back(v[p[2]], v[p[3]]);
    }
    const std::size_t n = links.size();
    if (n < 3 || n > 9) return;
    std::vector<Index> ring = {links[0].first};
    while (ring.size() <= n) {
      const auto next =
          std::find_if(links.begin(), links.end(), [&](const auto& link) { return link.first == ring.back(); });
      if (next == links.end()) return;  // an edge of the surface
      ring.push_back(next->second);
      if (ring.back() == ring.front()) break;
    }
    if (ring.size() != n + 1) return;
    // best_of[i][j]: the best worst quality over the part of the ring from i to j, with the tip of the triangle on i–j.
    std::vector<std::vector<std::pair<double, std::size_t>>> best_of(
        n, std::vector<std::pair<double, std::size_t>>(n, {std::numeric_limits<double>::infinity(), 0}));
    for (std::size_t length = 2; length < n; ++length)
      for (std::size_t i = 0; i + length < n; ++i) {
        const std::size_t j = i + length;
        best_of[i][j].first = -std::numeric_limits<double>::infinity();
        for (std::size_t k = i + 1; k < j; ++k) {
          const double worst =
              std::min({quality({ring[i], ring[k], ring[j], b}), quality({ring[k], ring[i], ring[j], a}),
                        best_of[i][k].first, best_of[k][j].first});
          if (worst > best_of[i][j].first) best_of[i][j] = {worst, k};
        }
      }
    change.quality = best_of[0][n - 1].first;
    std::vector<std::pair<std::size_t, std::size_t>> parts = {{0, n - 1}};
    while (!parts.empty()) {
      const auto [i, j] = parts.back();
      parts.pop_back();
      if (j - i < 2) continue;
      const std::size_t k = best_of[i][j].second;
      change.made.push_back({ring[i], ring[k], ring[j], b});
      change.made.push_back({ring[k], ring[i], ring[j], a});
      parts.emplace_back(i, k), parts.emplace_back(k, j);
    }
    propose(std::move(change), best);
  }

  const std::vector<Point<D>>& points_;
  const std::vector<double>& spacing_;
  double alpha_;
  std::vector<Simplex> simplices_, across_;
  std::vector<char> kept_, alive_;
  std::vector<double> radius_, quality_;
  std::vector<std::vector<std::size_t>> users_;
  std::vector<Index> singular_;
};

/// cloud_of_points with words for messages: `name(i)` is "point 3" or "the point of line 5".
template <int D, class Name>
[[nodiscard]] PointCloud<D> cloud_of_points(Points<D> points, const PointsOptions& options, std::string_view where,
                                            const Name& name) {
  options.validate();
  const auto refuse = [&](std::string_view what) { throw GeometryError(fmt::format("{}: {}", where, what)); };
  const std::size_t count = points.positions.size();
  if (count <= static_cast<std::size_t>(D))
    refuse(fmt::format("there {} {} point{}: a body of {} dimensions needs {} at least.", count == 1 ? "is" : "are",
                       count, count == 1 ? "" : "s", D, D + 1));
  if (!points.volumes.empty() && points.volumes.size() != count)
    refuse(fmt::format("there are {} points, but {} volumes.", count, points.volumes.size()));
  if (!points.point_regions.empty() && points.point_regions.size() != count)
    refuse(fmt::format("there are {} points, but {} regions of points.", count, points.point_regions.size()));
  for (std::size_t i = 0; i < count; ++i) {
    if (!points.positions[i].allFinite()) refuse(fmt::format("{} has a position that is not finite.", name(i)));
    if (!points.volumes.empty() && !(points.volumes[i] > 0.0 && std::isfinite(points.volumes[i])))
      refuse(fmt::format("{} has the volume {:g}: it must be positive and finite.", name(i), points.volumes[i]));
    if (!points.point_regions.empty() && points.point_regions[i] >= points.regions.size())
      refuse(fmt::format("{} is in region {}, but there are only {} regions.", name(i), points.point_regions[i],
                         points.regions.size()));
    points.positions[i] *= options.scale;
  }

  // The spacing around a point: of the volumes, or the mean distance to the 2 D nearest points, which are the
  // neighbours in a lattice.
  Point<D> low = points.positions[0], high = low;
  for (const Point<D>& X : points.positions) low = low.cwiseMin(X), high = high.cwiseMax(X);
  const double resolved = 1e-6 * (high - low).maxCoeff();
  const NeighborSearch<D> search(points.positions);
  std::vector<double> spacing(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<Neighbor> near = search.nearest(points.positions[i], 1 + 2 * static_cast<std::size_t>(D));
    double sum = 0.0;
    for (const Neighbor& n : near) sum += n.distance;
    spacing[i] = points.volumes.empty() ? sum / static_cast<double>(near.size() - 1)
                                        : options.scale * std::pow(points.volumes[i], 1.0 / D);
    const Index other = near[0].index == i ? near[1].index : near[0].index;
    const double distance = (points.positions[i] - points.positions[other]).norm();
    if (distance <= std::max(options.coincidence * spacing[i], resolved))
      refuse(fmt::format(
          "{} and {} coincide at {}: points must be farther apart than a millionth of the extent of the body.",
          name(std::min<std::size_t>(i, other)), name(std::max<std::size_t>(i, other)),
          describe<D>(points.positions[i])));
  }

  std::vector<MeshCell<D>> cells;
  std::vector<char> used(count, 0);
  std::vector<Index> singular;
  double volume = 0.0;
  try {
    const AlphaShape<D> shape(points.positions, spacing, options.alpha);
    for (const auto& simplex : shape.simplices()) {
      cells.push_back({.vertices = {simplex.begin(), simplex.end()}, .region = 0, .tag = cells.size()});
      for (const Index v : simplex) used[v] = 1;
      volume += shape.volume(simplex) / (D == 2 ? 2.0 : 6.0);
    }
    singular = shape.singular();
  } catch (const GeometryError& error) {
    refuse(error.what());
  }
  if (cells.empty())
    refuse("the points enclose no volume: they lie too nearly in a plane or on a line, or too far apart.");
  if (const auto lost = std::find(used.begin(), used.end(), 0); lost != used.end()) {
    const auto i = static_cast<std::size_t>(lost - used.begin());
    refuse(fmt::format("{} at {} is too far from the others to belong to the body: raise alpha = {:g} or leave it out.",
                       name(i), describe<D>(points.positions[i]), options.alpha));
  }
  if (!singular.empty())
    refuse(fmt::format(
        "the surface touches itself at {}, {}: with another alpha than {:g} more or less is left out there.",
        name(singular[0]), describe<D>(points.positions[singular[0]]), options.alpha));
  if (!points.volumes.empty()) {
    double sum = 0.0;
    for (const double V : points.volumes) sum += V;
    sum *= std::pow(options.scale, D);
    if (std::abs(sum - volume) > options.volume_tolerance * volume)
      refuse(
          fmt::format("the volumes of the points sum to {:.4g} m^{}, the body between them has {:.4g}: points must lie "
                      "on its surface, too; alpha = {:g} closes gaps (volume_tolerance = {:g}).",
                      sum, D, volume, options.alpha, options.volume_tolerance));
  }
  std::vector<std::size_t> tags(count);
  std::iota(tags.begin(), tags.end(), std::size_t{0});
  return cloud_of_mesh<D>(std::move(points.positions), tags, std::move(cells), std::move(points.regions),
                          {.scale = 1.0, .coincidence = options.coincidence}, where, points.point_regions);
}

}  // namespace detail

/// A cloud with cells from points alone. The points of the body, those of its surface among them, are joined by
/// Delaunay's triangulation; what is larger than the spacing of the points allows is left out (an alpha shape: hollows
/// and concave sides appear, edges of concave sides are rounded by about one spacing). The triangles and tetrahedra
/// become cells as those of a mesh do, see read_gmsh: all points are particles, with others in the middle of edges,
/// faces and simplices, about six (D = 2) or 27 (D = 3) per point. The part of a simplex that is next to a point is in
/// that point's region. Volumes, where they are given, tell the spacing, and their sum is compared with the volume of
/// the cells. Throws ParameterError for the options; GeometryError for points that are no body: too few, not finite,
/// coincident, in a plane, too far from the others, volumes that do not agree, or a surface that touches itself.
template <int D>
  requires(D > 1)
[[nodiscard]] PointCloud<D> cloud_of_points(Points<D> points, const PointsOptions& options = {}) {
  return detail::cloud_of_points<D>(std::move(points), options, "cloud_of_points",
                                    [](std::size_t i) { return fmt::format("point {}", i); });
}

}  // namespace tactoid
