#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/input/delaunay.hpp>

namespace tactoid::detail {

template <int D>
Eigen::Matrix<double, D, D> Delaunay<D>::metric() {
  Eigen::Matrix<double, D, D> m = Eigen::Matrix<double, D, D>::Identity();
  m(0, 1) = m(1, 0) = -3.0 / 32.0;
  if constexpr (D == 3) m(1, 2) = m(2, 1) = -2.0 / 32.0, m(0, 2) = m(2, 0) = -1.0 / 32.0;
  return m;
}

template <int D>
std::vector<typename Delaunay<D>::Simplex> Delaunay<D>::simplices() const {
  std::vector<Simplex> finite;
  for (const Cell& cell : cells_)
    if (cell.alive && place_of_infinity(cell) == vertices) finite.push_back(cell.vertex);
  return finite;
}

template <int D>
void Delaunay<D>::round(const std::vector<Point<D>>& points) {
  Point<D> low = points.at(0), high = low;
  for (const Point<D>& X : points) low = low.cwiseMin(X), high = high.cwiseMax(X);
  const double extent = (high - low).maxCoeff();
  const double scale = extent > 0.0 ? static_cast<double>((1 << 22) - 1) / extent : 0.0;
  for (const Point<D>& X : points) {
    Coordinates c;
    for (int k = 0; k < D; ++k) c[static_cast<std::size_t>(k)] = std::llround((X[k] - low[k]) * scale);
    points_.push_back(c);
  }
}

template <int D>
WideInteger Delaunay<D>::orientation(const Simplex& s) const {
  std::array<std::array<WideInteger, static_cast<std::size_t>(D)>, static_cast<std::size_t>(D)> m;
  for (std::size_t i = 0; i + 1 < vertices; ++i)
    for (std::size_t k = 0; k + 1 < vertices; ++k) m[i][k] = points_[s[i + 1]][k] - points_[s[0]][k];
  return wide_determinant(m);
}

template <int D>
bool Delaunay<D>::in_ball(const Simplex& s, Index p) const {
  std::array<std::array<WideInteger, vertices>, vertices> m;
  for (std::size_t i = 0; i < vertices; ++i) {
    for (std::size_t k = 0; k + 1 < vertices; ++k) m[i][k] = points_[s[i]][k] - points_[p][k];
    const auto& d = m[i];
    if constexpr (D == 2)
      m[i][2] = 32 * (d[0] * d[0] + d[1] * d[1]) - 6 * d[0] * d[1];
    else
      m[i][3] = 32 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - 6 * d[0] * d[1] - 4 * d[1] * d[2] - 2 * d[0] * d[2];
  }
  const WideInteger sign = wide_determinant(m);
  return D % 2 == 0 ? sign > 0 : sign < 0;
}

template <int D>
bool Delaunay<D>::in_conflict(Index c, Index p) {
  Cell& cell = cells_[c];
  if (cell.mark / 2 == step_) return cell.mark % 2 == 0;
  bool conflict;
  if (const std::size_t outside = place_of_infinity(cell); outside == vertices) {
    conflict = in_ball(cell.vertex, p);
  } else {
    const WideInteger beyond = orientation(cell.vertex, outside, p);
    conflict = beyond > 0 || (beyond == 0 && in_conflict(cell.across[outside], p));
  }
  cell.mark = 2 * step_ + (conflict ? 0 : 1);
  return conflict;
}

template <int D>
Index Delaunay<D>::locate(Index p) const {
  Index c = last_;
  if (const std::size_t outside = place_of_infinity(cells_[c]); outside != vertices) c = cells_[c].across[outside];
  for (;;) {
    const Cell& cell = cells_[c];
    std::size_t i = 0;
    while (i < vertices && orientation(cell.vertex, i, p) >= 0) ++i;
    if (i == vertices) return c;
    c = cell.across[i];
    if (place_of_infinity(cells_[c]) != vertices) return c;
  }
}

template <int D>
void Delaunay<D>::insert(Index p) {
  ++step_;
  const Index first = locate(p);
  for (const Index v : cells_[first].vertex)
    if (v != infinite && points_[v] == points_[p])
      throw GeometryError(fmt::format("points {} and {} coincide (within 2^-22 of the extent of the cloud).",
                                      std::min(v, p), std::max(v, p)));
  std::vector<Index> conflict = {first};
  cells_[first].mark = 2 * step_;
  cells_[first].queued = step_;
  struct Ridge {
    std::array<Index, vertices - 2> key;
    Index cell;
    std::size_t place;
    bool operator<(const Ridge& other) const { return key < other.key; }
  };
  std::vector<Ridge> ridges;
  for (std::size_t n = 0; n < conflict.size(); ++n)
    for (std::size_t i = 0; i < vertices; ++i) {
      const Index other = cells_[conflict[n]].across[i];
      if (in_conflict(other, p)) {
        if (std::exchange(cells_[other].queued, step_) != step_) conflict.push_back(other);
        continue;
      }
      // A face of the hole: a new cell joins it to p.
      const Index made = new_cell();
      Cell& cell = cells_[made];
      cell.vertex = cells_[conflict[n]].vertex;
      cell.vertex[i] = p;
      cell.across[i] = other;
      for (Index& back : cells_[other].across)
        if (back == conflict[n] && shares_face(cells_[other], back, cell.vertex, i)) back = made;
      for (std::size_t j = 0; j < vertices; ++j) {
        if (j == i) continue;
        Ridge ridge{{}, made, j};
        for (std::size_t k = 0, a = 0; k < vertices; ++k)
          if (k != i && k != j) ridge.key[a++] = cell.vertex[k];
        std::sort(ridge.key.begin(), ridge.key.end());
        ridges.push_back(ridge);
      }
      last_ = made;
    }
  std::sort(ridges.begin(), ridges.end());
  for (std::size_t k = 0; k + 1 < ridges.size(); k += 2) {
    cells_[ridges[k].cell].across[ridges[k].place] = ridges[k + 1].cell;
    cells_[ridges[k + 1].cell].across[ridges[k + 1].place] = ridges[k].cell;
  }
  for (const Index c : conflict) {
    cells_[c].alive = false;
    free_.push_back(c);
  }
}

template <int D>
bool Delaunay<D>::shares_face(const Cell& other, const Index& back, const Simplex& s, std::size_t place) {
  const auto opposite = static_cast<std::size_t>(&back - other.across.data());
  for (std::size_t k = 0; k < vertices; ++k)
    if (k != opposite && (std::find(s.begin(), s.end(), other.vertex[k]) == s.end() || other.vertex[k] == s[place]))
      return false;
  return true;
}

template <int D>
std::vector<Index> Delaunay<D>::first_simplex(std::vector<Index> order) {
  Simplex s;
  s.fill(order.front());
  std::size_t found = 1;
  for (std::size_t n = 1; n < order.size() && found < vertices; ++n) {
    s[found] = order[n];
    if (!independent(s, found)) continue;
    ++found;
    order.erase(order.begin() + static_cast<std::ptrdiff_t>(n--));
  }
  if (found < vertices) throw GeometryError(fmt::format("all points lie {}.", D == 3 ? "in a plane" : "on a line"));
  order.erase(order.begin());
  if (orientation(s) < 0) std::swap(s[0], s[1]);
  // One cell inside and one beyond each face; cell i + 1 is beyond the face opposite to vertex i.
  for (std::size_t c = 0; c <= vertices; ++c) (void)new_cell();
  cells_[0].vertex = s;
  for (std::size_t i = 0; i < vertices; ++i) {
    cells_[0].across[i] = static_cast<Index>(i + 1);
    Cell& outer = cells_[i + 1];
    // Turned over: seen from beyond, the face has the other orientation.
    const std::size_t a = (i + 1) % vertices, b = (i + 2) % vertices;
    outer.vertex = s;
    outer.vertex[i] = infinite;
    std::swap(outer.vertex[a], outer.vertex[b]);
    for (std::size_t j = 0; j < vertices; ++j) outer.across[j] = static_cast<Index>(j + 1);
    std::swap(outer.across[a], outer.across[b]);
    outer.across[i] = 0;
  }
  last_ = 0;
  return order;
}

template <int D>
bool Delaunay<D>::independent(const Simplex& s, std::size_t found) const {
  const Coordinates &a = points_[s[0]], &b = points_[s[1]];
  if (found == 1) return a != b;
  if (found == static_cast<std::size_t>(D)) return orientation(s) != 0;
  const Coordinates& c = points_[s[2]];
  for (std::size_t k = 0; k + 1 < vertices; ++k) {
    const std::size_t l = (k + 1) % (vertices - 1);
    if ((b[k] - a[k]) * (c[l] - a[l]) != (b[l] - a[l]) * (c[k] - a[k])) return true;
  }
  return false;
}

template <int D>
Index Delaunay<D>::new_cell() {
  if (free_.empty()) {
    cells_.emplace_back();
    return static_cast<Index>(cells_.size() - 1);
  }
  const Index c = free_.back();
  free_.pop_back();
  cells_[c] = Cell{};
  return c;
}

}  // namespace tactoid::detail

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template class Delaunay<2>;
template class Delaunay<3>;
}  // namespace tactoid::detail
#endif
