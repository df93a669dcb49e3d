// Interpolation of a smooth function on jittered clouds with true shape functions: errors in L2 and in the H1 seminorm,
// integrated by 3ᴰ Gauss points per cell with the analytic gradients of the shape functions. Orders of a basis that is
// complete to degree p: p + 1 and p (Liu, Li and Belytschko, Comput. Methods Appl. Mech. Eng. 1997, 143, 113).
// Neighbour tables against brute force stand in tests/neighbors_test.cpp: random, gridded, coincident, empty sets.
#include <cmath>
#include <string>

#include <tactoid/geometry/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/verify/convergence.hpp>

#include "studies.hpp"

namespace tactoid::verification {
namespace kernel_study {
namespace {

constexpr double wave = 2.5;

/// Π_k sin(wave X_k + k + ½) and its gradient.
template <int D>
std::pair<double, Point<D>> exact(const Point<D>& X) {
  double f = 1.0;
  Point<D> slope = Point<D>::Constant(wave);
  for (int k = 0; k < D; ++k) {
    const double phase = wave * X[k] + k + 0.5;
    f *= std::sin(phase);
    for (int l = 0; l < D; ++l) slope[l] *= l == k ? std::cos(phase) : std::sin(phase);
  }
  return {f, slope};
}

template <int D>
PointCloud<D> jittered_cloud(int n) {
  if constexpr (D == 1)
    return jitter(bar({.length = 1.0, .cells = n}), 0.2);
  else if constexpr (D == 2)
    return jitter(rectangle({.size = {1.0, 1.0}, .cells = {n, n}}), 0.2);
  else
    return jitter(box({.size = {1.0, 1.0, 1.0}, .cells = {n, n, n}}), 0.2);
}

struct Errors {
  double value = 0.0, slope = 0.0;  ///< relative: L2, H1 seminorm
};

template <class K>
Errors interpolation_errors(const K& kernel, int cells) {
  constexpr int D = K::dimension;
  const PointCloud<D> cloud = jittered_cloud<D>(cells);
  std::vector<double> nodal;
  for (const Point<D>& X : cloud.positions) nodal.push_back(exact<D>(X).first);
  const std::vector<CellPoint<D>> all = gauss_points<3>(cloud);
  double error = 0.0, size = 0.0, slope_error = 0.0, slope_size = 0.0;
  constexpr std::size_t part = 20000;  // points per table: bounds the memory
  for (std::size_t begin = 0; begin < all.size(); begin += part) {
    const std::size_t end = std::min(all.size(), begin + part);
    std::vector<Point<D>> points;
    for (std::size_t q = begin; q < end; ++q) points.push_back(all[q].position);
    const auto shape = shape_functions(kernel, cloud, points);
    for (std::size_t q = 0; q < points.size(); ++q) {
      const auto [f, slope] = exact<D>(points[q]);
      double value = 0.0;
      Point<D> gradient = Point<D>::Zero();
      for (std::size_t e = shape.offsets[q]; e < shape.offsets[q + 1]; ++e) {
        value += shape.values[e] * nodal[shape.indices[e]];
        gradient += nodal[shape.indices[e]] * shape.gradients[e];
      }
      const double V = all[begin + q].weight;
      error += V * (value - f) * (value - f);
      size += V * f * f;
      slope_error += V * (gradient - slope).squaredNorm();
      slope_size += V * slope.squaredNorm();
    }
  }
  return {std::sqrt(error / size), std::sqrt(slope_error / slope_size)};
}

template <class K>
void converge(Report& report, const char* name, const std::vector<int>& cells) {
  const K kernel{};
  HistoryWriter table =
      report.table(fmt::format("{}_{}D_order_{}", name, K::dimension, K::order), {"spacing [m]", "L2", "H1"});
  std::vector<double> h, value, slope;
  for (const int n : cells) {
    const Errors errors = interpolation_errors(kernel, n);
    h.push_back(1.0 / n);
    value.push_back(errors.value);
    slope.push_back(errors.slope);
    table.write(std::array{h.back(), errors.value, errors.slope});
  }
  const std::string title =
      fmt::format("{}, {}D, {} basis", name, K::dimension, K::order == 1 ? "linear" : "quadratic");
  const std::string source = fmt::format("order {} + 1 and {} of a basis complete to degree {}; {} to {} cells",
                                         K::order, K::order, K::order, cells.front(), cells.back());
  const bool linear = K::order == 1;
  report.at_least(title + ": rate in L2", convergence_rates(h, value).fitted, linear ? 1.9 : 2.8, source);
  report.at_least(title + ": rate in H1", convergence_rates(h, slope).fitted, linear ? 0.95 : 1.9, source);
  report.note(title + ": error in L2 at the finest", value.back(), std::nan(""), "over the norm of the function");
}

}  // namespace
}  // namespace kernel_study

void kernel(Report& report, Level level) {
  using namespace kernel_study;
  const bool full = level == Level::full;
  const std::vector<int> line = full ? std::vector{20, 40, 80, 160, 320} : std::vector{20, 40, 80, 160};
  const std::vector<int> plane = full ? std::vector{16, 32, 64, 128} : std::vector{12, 24, 48};
  // Particles on the boundary are not jittered: coarse clouds in three dimensions are less so than fine ones.
  const std::vector<int> space = full ? std::vector{8, 12, 18, 27} : std::vector{8, 12, 16};
  const std::vector<int> space_linear = full ? std::vector{16, 24, 36, 48} : std::vector{16, 24, 36};
  converge<Rkpm<1, 1>>(report, "RKPM", line);
  converge<Rkpm<1, 2>>(report, "RKPM", line);
  converge<Rkpm<2, 1>>(report, "RKPM", plane);
  converge<Rkpm<2, 2>>(report, "RKPM", plane);
  converge<Rkpm<3, 1>>(report, "RKPM", space_linear);
  converge<Rkpm<3, 2>>(report, "RKPM", space);
  converge<Mls<1, 1>>(report, "MLS", line);
  converge<Mls<1, 2>>(report, "MLS", line);
  converge<Mls<2, 1>>(report, "MLS", plane);
  converge<Mls<2, 2>>(report, "MLS", plane);
  converge<Mls<3, 1>>(report, "MLS", space_linear);
  converge<Mls<3, 2>>(report, "MLS", space);
}

}  // namespace tactoid::verification
