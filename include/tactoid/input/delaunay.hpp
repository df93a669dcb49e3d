#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/geometry/order.hpp>

namespace tactoid {

namespace detail {

// Determinants of whole numbers are exact: no cloud, however regular, makes the triangulation inconsistent.
__extension__ using WideInteger = __int128;

template <std::size_t N>
[[nodiscard]] WideInteger wide_determinant(const std::array<std::array<WideInteger, N>, N>& m) {
  if constexpr (N == 1) {
    return m[0][0];
  } else {
    WideInteger sum = 0;  // along the last column, which holds the largest numbers
    for (std::size_t row = 0; row < N; ++row) {
      std::array<std::array<WideInteger, N - 1>, N - 1> minor;
      for (std::size_t i = 0, k = 0; i < N; ++i)
        if (i != row) {
          for (std::size_t j = 0; j + 1 < N; ++j) minor[k][j] = m[i][j];
          ++k;
        }
      const WideInteger part = m[row][N - 1] * wide_determinant<N - 1>(minor);
      sum += (row + N) % 2 == 1 ? part : -part;
    }
    return sum;
  }
}

/// The Delaunay triangulation of points, incremental (Bowyer and Watson), in exact arithmetic: coordinates are rounded
/// to 2⁻²² of the largest extent. "Inside the circumscribed ball" is measured by a quadratic form a few per cent off
/// |x|², positive, with different off-diagonals: the points of a lattice, of which eight lie on every sphere, are then
/// cut in the same way everywhere, without flat simplices, and the result depends on the order of the points no more.
template <int D>
class Delaunay {
  static_assert(D == 2 || D == 3, "Clouds are triangulated in 2 and 3 dimensions.");

 public:
  static constexpr std::size_t vertices = static_cast<std::size_t>(D) + 1;
  using Simplex = std::array<Index, vertices>;
  static constexpr Index infinite = ~Index{0};  ///< the vertex beyond the hull

  /// Throws GeometryError for points that coincide after rounding, or that all lie in a plane (on a line).
  explicit Delaunay(const std::vector<Point<D>>& points) {
    round(points);
    const std::vector<Index> order = first_simplex(morton_order<D>(points));
    for (const Index p : order) insert(p);
  }

  /// The quadratic form that takes the place of |x|².
  [[nodiscard]] static Eigen::Matrix<double, D, D> metric();

  /// All simplices, of positive volume (before rounding: nearly).
  [[nodiscard]] std::vector<Simplex> simplices() const;

 private:
  struct Cell {
    Simplex vertex{};
    Simplex across{};  // the cell on the other side of the face opposite to each vertex
    bool alive = true;
    std::uint64_t mark = 0;    // 2 n: in conflict with the point of step n; 2 n + 1: not
    std::uint64_t queued = 0;  // the step whose hole it belongs to
  };
  using Coordinates = std::array<std::int64_t, static_cast<std::size_t>(D)>;

  void round(const std::vector<Point<D>>& points);

  [[nodiscard]] static std::size_t place_of_infinity(const Cell& cell) {
    return static_cast<std::size_t>(std::find(cell.vertex.begin(), cell.vertex.end(), infinite) - cell.vertex.begin());
  }

  /// D! times the volume of a simplex, > 0 for right-handed ones.
  [[nodiscard]] WideInteger orientation(const Simplex& s) const;
  [[nodiscard]] WideInteger orientation(Simplex s, std::size_t place, Index p) const {
    s[place] = p;
    return orientation(s);
  }

  [[nodiscard]] bool in_ball(const Simplex& s, Index p) const;

  /// Whether p takes the cell away: it lies in its ball, or beyond its face where the cell is outside the hull.
  [[nodiscard]] bool in_conflict(Index c, Index p);

  /// Walks from the last cell towards p to one that is in conflict with it.
  [[nodiscard]] Index locate(Index p) const;

  void insert(Index p);

  /// Whether the face of `other` behind which `back` stands is the face of `s` opposite to `place`.
  [[nodiscard]] static bool shares_face(const Cell& other, const Index& back, const Simplex& s, std::size_t place);

  /// A simplex that is not flat, with what is around it; returns the other points, in their order.
  [[nodiscard]] std::vector<Index> first_simplex(std::vector<Index> order);

  /// Whether s[0 … found] are affinely independent.
  [[nodiscard]] bool independent(const Simplex& s, std::size_t found) const;

  [[nodiscard]] Index new_cell();

  std::vector<Coordinates> points_;
  std::vector<Cell> cells_;
  std::vector<Index> free_;
  Index last_ = 0;
  std::uint64_t step_ = 0;
};

}  // namespace detail
}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/input/delaunay.ipp>
#endif
