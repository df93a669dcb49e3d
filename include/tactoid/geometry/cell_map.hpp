#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid {

/// Corners of a background cell: 2^D points in tensor order.
template <int D>
using Corners = std::array<Point<D>, (1u << D)>;

/// Reference positions of a cell's corners, m. In periodic directions they stand around the first one.
template <int D>
[[nodiscard]] Corners<D> cell_corners(const PointCloud<D>& cloud, const typename PointCloud<D>::Cell& cell) {
  Corners<D> corners;
  const Point<D>& first = cloud.positions[cell[0]];
  for (std::size_t a = 0; a < corners.size(); ++a)
    corners[a] = first + cloud.difference(first, cloud.positions[cell[a]]);
  return corners;
}

/// Reference positions of a facet's corners, m. In periodic directions they stand around the first one.
template <int D>
[[nodiscard]] std::array<Point<D>, (1u << (D - 1))> facet_corners(const PointCloud<D>& cloud,
                                                                 const typename PointCloud<D>::Facet& facet) {
  std::array<Point<D>, (1u << (D - 1))> corners;
  const Point<D>& first = cloud.positions[facet[0]];
  for (std::size_t a = 0; a < corners.size(); ++a)
    corners[a] = first + cloud.difference(first, cloud.positions[facet[a]]);
  return corners;
}

/// Multilinear shape function of corner `a` of the unit cube at `xi`: Π_k (ξ_k or 1 − ξ_k).
template <int D>
[[nodiscard]] double corner_function(std::size_t a, const Point<D>& xi) {
  double n = 1.0;
  for (int k = 0; k < D; ++k) n *= ((a >> k) & 1u) != 0 ? xi[k] : 1.0 - xi[k];
  return n;
}

/// Values N_a of the multilinear shape functions of the corners: the same in all cells.
template <int D>
using CornerFunctions = std::array<double, (1u << D)>;

/// Values of all corners at `xi`.
template <int D>
[[nodiscard]] CornerFunctions<D> corner_functions(const Point<D>& xi) {
  CornerFunctions<D> functions;
  for (std::size_t a = 0; a < functions.size(); ++a) functions[a] = corner_function<D>(a, xi);
  return functions;
}

/// Multilinear map of the unit cube onto the cell, X(ξ) = Σ_a N_a(ξ) X_a, m, where the values are known.
template <int D>
[[nodiscard]] Point<D> cell_position(const Corners<D>& corners, const CornerFunctions<D>& functions) {
  Point<D> x = Point<D>::Zero();
  for (std::size_t a = 0; a < corners.size(); ++a) x += functions[a] * corners[a];
  return x;
}

/// The same at `xi`.
template <int D>
[[nodiscard]] Point<D> cell_position(const Corners<D>& corners, const Point<D>& xi) {
  return cell_position<D>(corners, corner_functions<D>(xi));
}

/// Slopes ∂N_a/∂ξ_k of the multilinear shape functions of the corners: the same in all cells.
template <int D>
using CornerSlopes = std::array<Point<D>, (1u << D)>;

/// Slopes of all corners at `xi`.
template <int D>
[[nodiscard]] CornerSlopes<D> corner_slopes(const Point<D>& xi) {
  CornerSlopes<D> slopes;
  for (std::size_t a = 0; a < slopes.size(); ++a)
    for (int k = 0; k < D; ++k) {
      slopes[a][k] = ((a >> k) & 1u) != 0 ? 1.0 : -1.0;
      for (int l = 0; l < D; ++l)
        if (l != k) slopes[a][k] *= ((a >> l) & 1u) != 0 ? xi[l] : 1.0 - xi[l];
    }
  return slopes;
}

/// Jacobian matrix ∂X_i/∂ξ_k of the multilinear map, m, where the slopes are known.
template <int D>
[[nodiscard]] Eigen::Matrix<double, D, D> cell_jacobian(const Corners<D>& corners, const CornerSlopes<D>& slopes) {
  Eigen::Matrix<double, D, D> jacobian = Eigen::Matrix<double, D, D>::Zero();
  for (std::size_t a = 0; a < corners.size(); ++a)
    for (int k = 0; k < D; ++k) jacobian.col(k) += slopes[a][k] * corners[a];
  return jacobian;
}

/// The same at `xi`.
template <int D>
[[nodiscard]] Eigen::Matrix<double, D, D> cell_jacobian(const Corners<D>& corners, const Point<D>& xi) {
  return cell_jacobian<D>(corners, corner_slopes<D>(xi));
}

/// Gauss–Legendre points and weights on [0, 1]; exact for polynomials of degree 2 N − 1.
template <int N>
struct GaussRule {
  static_assert(N >= 1 && N <= 3, "Gauss rules have 1, 2 or 3 points per direction.");
  std::array<double, static_cast<std::size_t>(N)> points{};   ///< ascending, in (0, 1)
  std::array<double, static_cast<std::size_t>(N)> weights{};  ///< they sum to 1
};

/// The rule with N = 1, 2 or 3 points.
template <int N>
[[nodiscard]] GaussRule<N> gauss_rule() {
  if constexpr (N == 1) {
    return {{0.5}, {1.0}};
  } else if constexpr (N == 2) {
    const double d = 0.5 / std::sqrt(3.0);
    return {{0.5 - d, 0.5 + d}, {0.5, 0.5}};
  } else {
    const double d = 0.5 * std::sqrt(0.6);
    return {{0.5 - d, 0.5, 0.5 + d}, {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0}};
  }
}

/// Calls visit(ξ, weight) for the N^D points of the product rule on the box [lower, lower + width]^D.
template <int N, int D, class Visit>
void for_each_gauss_point(const Point<D>& lower, double width, const Visit& visit) {
  const GaussRule<N> rule = gauss_rule<N>();
  int count = 1;
  for (int k = 0; k < D; ++k) count *= N;
  for (int q = 0; q < count; ++q) {
    Point<D> xi;
    double weight = 1.0;
    for (int k = 0, rest = q; k < D; ++k, rest /= N) {
      const auto i = static_cast<std::size_t>(rest % N);
      xi[k] = lower[k] + width * rule.points[i];
      weight *= width * rule.weights[i];
    }
    visit(xi, weight);
  }
}

}  // namespace tactoid
