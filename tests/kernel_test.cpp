#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <tactoid/geometry/all.hpp>
#include <tactoid/kernel/all.hpp>

#include "relative.hpp"

namespace kernel_test {

using namespace tactoid;

// What a kernel must be, and near misses.
static_assert(Kernel<Rkpm<1>> && Kernel<Rkpm<2, 2>> && Kernel<Rkpm<3, 1, QuinticBSpline>>);
static_assert(Kernel<Mls<1, 2, WendlandC2>> && Kernel<Mls<2>> && Kernel<Mls<3>>);
static_assert(Window<CubicBSpline> && Window<QuinticBSpline> && Window<WendlandC2>);

namespace {

struct NoOrder : Rkpm<3> {
 private:
  using Rkpm<3>::order;
};
struct NoSupport : Rkpm<3> {
 private:
  using Rkpm<3>::support;
};
struct NoWindow : Rkpm<3> {
 private:
  using Rkpm<3>::Window;
};
struct TextSupport : Rkpm<3> {
  std::string support;
};
struct OtherDimension : Rkpm<3> {
  static constexpr int dimension = 2;
};
struct NotConst : Rkpm<3> {
  void shape_functions(std::span<const KernelNeighbor<3>>, ShapeFunctions<3>&) {}
};
struct NoCondition : Rkpm<3> {
  void direct_gradient(std::span<const KernelNeighbor<3>>, std::vector<Point<3>>&) const {}
};
struct ValueOnly {
  static double value(double q) { return 1.0 - q; }
};
struct FloatSlope {
  static double value(double q) { return 1.0 - q; }
  static float slope(double) { return -1.0f; }
};

static_assert(!Kernel<int> && !Kernel<CubicBSpline>);
static_assert(!Kernel<NoOrder>);
static_assert(!Kernel<NoSupport>);
static_assert(!Kernel<NoWindow>);
static_assert(!Kernel<TextSupport>);
static_assert(!Kernel<OtherDimension>);
static_assert(!Kernel<NotConst>);
static_assert(!Kernel<NoCondition>);
static_assert(!Window<ValueOnly> && !Window<FloatSlope> && !Window<Rkpm<3>>);

template <int D>
std::vector<Point<D>> sample_points(const PointCloud<D>& cloud, std::size_t stride) {
  std::vector<Point<D>> points;
  const auto cells = nodal_cells(cloud);
  for (std::size_t i = 0; i < cells.size(); i += stride) points.push_back(cells[i].centroid);
  for (std::size_t i = 0; i < cloud.size(); i += stride) points.push_back(cloud.positions[i]);
  const auto gauss = gauss_points<2>(cloud);
  for (std::size_t i = 0; i < gauss.size(); i += 3 * stride) points.push_back(gauss[i].position);
  return points;
}

// Largest relative errors of reproducing all monomials of the order (in coordinates that do not move with the point)
// and of their gradients, by shape functions and by the value-based operator.
struct Errors {
  double value = 0.0, gradient = 0.0, direct = 0.0;
};

template <class K, int D = K::dimension>
Errors reproduction(const K& kernel, const PointCloud<D>& cloud, std::size_t stride = 1) {
  const auto points = sample_points(cloud, stride);
  const auto shape = shape_functions(kernel, cloud, points);
  const auto direct = direct_gradients(kernel, cloud, points);
  double length = 0.0;
  for (const auto& x : cloud.positions) length = std::max(length, x.norm());
  Errors worst;
  constexpr int size = K::basis_size;
  for (std::size_t q = 0; q < points.size(); ++q) {
    Eigen::Matrix<double, size, 1> value = Eigen::Matrix<double, size, 1>::Zero();
    Eigen::Matrix<double, size, D> gradient = Eigen::Matrix<double, size, D>::Zero();
    Eigen::Matrix<double, size, D> exact = gradient, by_value = gradient;
    const Point<D> x = points[q] / length;
    for (int k = 0; k < D; ++k) exact(1 + k, k) = 1.0;
    if constexpr (K::order == 2) {
      int row = 1 + D;
      for (int k = 0; k < D; ++k)
        for (int l = k; l < D; ++l, ++row) {
          exact(row, k) += x[l];
          exact(row, l) += x[k];
        }
    }
    for (std::size_t e = shape.offsets[q]; e < shape.offsets[q + 1]; ++e) {
      const auto p = monomials<D, K::order>(cloud.positions[shape.indices[e]] / length);
      value += shape.values[e] * p;
      gradient += length * p * shape.gradients[e].transpose();
      by_value += length * p * direct.gradients[e].transpose();
    }
    worst.value = std::max(worst.value, (value - monomials<D, K::order>(x)).cwiseAbs().maxCoeff());
    worst.gradient = std::max(worst.gradient, (gradient - exact).cwiseAbs().maxCoeff());
    worst.direct = std::max(worst.direct, (by_value - exact).cwiseAbs().maxCoeff());
  }
  return worst;
}

template <class K>
void check_reproduction(const K& kernel, const PointCloud<K::dimension>& cloud, std::size_t stride = 1) {
  const Errors errors = reproduction(kernel, cloud, stride);
  CAPTURE(K::dimension);
  CAPTURE(K::order);
  CAPTURE(cloud.size());
  CHECK(errors.value < 1e-11);
  CHECK(errors.gradient < 1e-11);
  CHECK(errors.direct < 1e-11);
}

template <class Window>
void check_window(double at_zero) {
  CHECK(Window::value(0.0) == test::relative(at_zero).epsilon(1e-15));
  CHECK(Window::slope(0.0) == 0.0);
  for (const double q : {1.0, 1.5, 7.0}) {
    CHECK(Window::value(q) == 0.0);
    CHECK(Window::slope(q) == 0.0);
  }
  for (double q = 0.005; q < 1.0; q += 0.01) {
    const double h = 1e-5;
    CHECK(Window::value(q) > 0.0);
    CHECK(Window::slope(q) < 0.0);
    CHECK(std::abs(Window::slope(q) - (Window::value(q + h) - Window::value(q - h)) / (2 * h)) < 1e-8);
  }
}

}  // namespace

TEST_CASE("windows: values, slopes, partition of unity of the splines") {
  check_window<CubicBSpline>(2.0 / 3.0);
  check_window<QuinticBSpline>(11.0 / 20.0);
  check_window<WendlandC2>(1.0);
  CHECK(WendlandC2::value(0.5) == 3.0 / 16.0);
  for (double x = 0.0; x < 1.0; x += 0.0625) {
    double cubic = 0.0, quintic = 0.0;
    for (int i = -4; i <= 4; ++i) {
      cubic += CubicBSpline::value(std::abs(x - i) / 2.0);
      quintic += QuinticBSpline::value(std::abs(x - i) / 3.0);
    }
    CHECK(cubic == test::relative(1.0).epsilon(1e-14));
    CHECK(quintic == test::relative(1.0).epsilon(1e-14));
  }
}

TEST_CASE("reproduction of polynomials and their gradients: one dimension") {
  const auto regular = bar({.length = 2e-6, .cells = 20});
  for (const auto& cloud : {regular, jitter(regular, 0.4, 3)}) {
    check_reproduction(Rkpm<1>{}, cloud);
    check_reproduction(Mls<1>{}, cloud);
    check_reproduction(Rkpm<1, 2>{}, cloud);
    check_reproduction(Mls<1, 2>{}, cloud);
    check_reproduction(Rkpm<1, 1, QuinticBSpline>{}, cloud);
    check_reproduction(Rkpm<1, 2, WendlandC2>{}, cloud);
  }
}

TEST_CASE("reproduction of polynomials and their gradients: two dimensions") {
  const auto regular = rectangle({.size = {2e-6, 1e-6}, .cells = {12, 8}});
  const auto grid = circle({.radius = 3.0, .core_cells = 6, .rings = 5});
  for (const auto& cloud : {regular, jitter(regular, 0.3, 3), grid, jitter(grid, 0.2, 4)}) {
    check_reproduction(Rkpm<2>{}, cloud);
    check_reproduction(Mls<2>{}, cloud);
    check_reproduction(Rkpm<2, 2>{}, cloud);
    check_reproduction(Mls<2, 2>{}, cloud);
    check_reproduction(Mls<2, 1, WendlandC2>{}, cloud);
    check_reproduction(Rkpm<2, 2, QuinticBSpline>{.support = 3.0}, cloud);
  }
}

TEST_CASE("reproduction of polynomials and their gradients: three dimensions") {
  const auto regular = box({.size = {2.0, 1.0, 1.0}, .cells = {10, 6, 5}});
  const auto grid = disc({.radius = 3e-6, .height = 1e-6, .core_cells = 6, .rings = 5, .layers = 5});
  const auto cell = ball({.radius = 5e-6, .core_radius = 3.09e-6});
  for (const auto& cloud : {regular, jitter(regular, 0.3, 3), grid, jitter(grid, 0.2, 4), cell}) {
    check_reproduction(Rkpm<3>{}, cloud, 3);
    check_reproduction(Mls<3>{}, cloud, 3);
    check_reproduction(Rkpm<3, 2>{}, cloud, 29);
    check_reproduction(Mls<3, 2>{}, cloud, 29);
    check_reproduction(Rkpm<3, 1, WendlandC2>{}, cloud, 29);
    check_reproduction(Mls<3, 1, QuinticBSpline>{.support = 2.2}, cloud, 29);
  }
}

TEST_CASE("periodic clouds reproduce offsets") {
  const auto cloud = box({.size = {2.0, 2.0, 1.0}, .cells = {8, 8, 4}, .periodic = {true, true, false}});
  const auto points = sample_points(cloud, 5);
  const auto shape = shape_functions(Rkpm<3>{}, cloud, points);
  for (std::size_t q = 0; q < points.size(); ++q) {
    Point<3> offset = Point<3>::Zero();
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (std::size_t e = shape.offsets[q]; e < shape.offsets[q + 1]; ++e) {
      const Point<3> d = cloud.difference(points[q], cloud.positions[shape.indices[e]]);
      offset += shape.values[e] * d;
      gradient += shape.gradients[e] * d.transpose();
    }
    CHECK(offset.norm() < 1e-13);
    CHECK((gradient - Eigen::Matrix3d::Identity()).norm() < 1e-11);
  }
}

TEST_CASE("inside a regular line the linear shape functions are the B-splines themselves") {
  const auto cloud = bar({.length = 20.0, .cells = 20});
  std::vector<Point<1>> points;
  for (double x = 5.0; x < 15.0; x += 0.37) points.push_back(Point<1>(x));
  const auto check = [&](const auto& kernel) {
    const auto shape = shape_functions(kernel, cloud, points);
    for (std::size_t q = 0; q < points.size(); ++q) {
      CHECK(shape.offsets[q + 1] - shape.offsets[q] >= 3);
      for (std::size_t e = shape.offsets[q]; e < shape.offsets[q + 1]; ++e) {
        const double d = points[q][0] - cloud.positions[shape.indices[e]][0];
        const double slope = CubicBSpline::slope(std::abs(d) / 2.0) / 2.0 * (d > 0.0 ? 1.0 : -1.0);
        CHECK(shape.values[e] == test::relative(CubicBSpline::value(std::abs(d) / 2.0)).epsilon(1e-12));
        CHECK(std::abs(shape.gradients[e][0] - slope) < 1e-12);
      }
    }
  };
  check(Rkpm<1>{.support = 2.0});
  check(Mls<1>{.support = 2.0});
}

TEST_CASE("gradients are the derivatives of the shape functions") {
  const auto check = [](const auto& kernel, const auto& cloud) {
    constexpr int D = std::remove_cvref_t<decltype(kernel)>::dimension;
    const double h = 1e-5;
    std::mt19937 generator(5);
    double worst = 0.0;
    for (int sample = 0; sample < 30; ++sample) {
      Point<D> x;
      for (int k = 0; k < D; ++k) x[k] = 0.15 + 0.7 * static_cast<double>(generator()) * 0x1.0p-32;
      std::vector<KernelNeighbor<D>> near;
      const auto supports = support_radii(kernel, cloud);
      const auto volumes = nodal_volumes(cloud);
      const auto at = [&](const Point<D>& y) {
        near.clear();
        for (std::size_t i = 0; i < cloud.size(); ++i)
          near.push_back({cloud.positions[i] - y, supports[i], volumes[i]});
        ShapeFunctions<D> shape;
        kernel.shape_functions(near, shape);
        return shape;
      };
      const auto shape = at(x);
      double largest = 0.0;
      for (const auto& g : shape.gradient) largest = std::max(largest, g.norm());
      for (int k = 0; k < D; ++k) {
        Point<D> step = Point<D>::Zero();
        step[k] = h;
        const auto ahead = at(x + step), behind = at(x - step);
        for (std::size_t i = 0; i < cloud.size(); ++i) {
          const double difference = (ahead.value[i] - behind.value[i]) / (2.0 * h);
          worst = std::max(worst, std::abs(difference - shape.gradient[i][k]) / largest);
        }
      }
    }
    CHECK(worst < 1e-6);
  };
  const auto line = jitter(bar({.length = 1.0, .cells = 12}), 0.3);
  const auto plane = jitter(rectangle({.size = {1.0, 1.0}, .cells = {6, 6}}), 0.25);
  const auto brick = jitter(box({.size = {1.0, 1.0, 1.0}, .cells = {5, 5, 5}}), 0.25);
  check(Rkpm<1>{}, line);
  check(Mls<1, 2, WendlandC2>{}, line);
  check(Rkpm<2, 2>{}, plane);
  check(Mls<2, 1, QuinticBSpline>{}, plane);
  check(Rkpm<3>{}, brick);
  check(Mls<3, 2>{}, brick);
  check(Rkpm<3, 1, WendlandC2>{}, brick);
}

TEST_CASE("RKPM weighs with nodal volumes, MLS does not") {
  const auto at_point = [](double volume_factor) {
    std::vector<KernelNeighbor<1>> near;
    for (const double d : {-0.9, -0.3, 0.4, 1.1}) near.push_back({Point<1>(d), 1.5, 1.0});
    near[2].volume = volume_factor;
    ShapeFunctions<1> rkpm, mls;
    Rkpm<1>{}.shape_functions(near, rkpm);
    Mls<1>{}.shape_functions(near, mls);
    return std::pair{rkpm, mls};
  };
  const auto [rkpm_equal, mls_equal] = at_point(1.0);
  const auto [rkpm_heavy, mls_heavy] = at_point(4.0);
  CHECK(rkpm_equal.value == mls_equal.value);
  CHECK(mls_equal.value == mls_heavy.value);
  CHECK(rkpm_heavy.value[2] > rkpm_equal.value[2] + 0.05);
}

TEST_CASE("the value-based gradient does not depend on the unit of length") {
  std::vector<KernelNeighbor<2>> near, small;
  std::mt19937 generator(11);
  for (int i = 0; i < 12; ++i) {
    const double x = static_cast<double>(generator()) * 0x1.0p-31 - 1.0;
    const Point<2> d(x, static_cast<double>(generator()) * 0x1.0p-31 - 1.0);
    near.push_back({d, 1.6, 0.3});
    small.push_back({1e-9 * d, 1.6e-9, 0.3e-18});
  }
  std::vector<Point<2>> g, s;
  const double condition = Rkpm<2>{}.direct_gradient(near, g);
  CHECK(Rkpm<2>{}.direct_gradient(small, s) == test::relative(condition).epsilon(1e-10));
  CHECK(condition > 1.0);
  CHECK(condition < 100.0);
  for (std::size_t i = 0; i < g.size(); ++i) CHECK((1e-9 * s[i] - g[i]).norm() < 1e-12 * (1.0 + g[i].norm()));
}

TEST_CASE("too few or badly placed neighbours give an infinite condition number") {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto condition = [](const std::vector<Point<2>>& offsets, double support = 1.0) {
    std::vector<KernelNeighbor<2>> near;
    for (const auto& d : offsets) near.push_back({d, support, 1.0});
    ShapeFunctions<2> shape;
    Rkpm<2>{}.shape_functions(near, shape);
    CHECK(shape.value.size() == offsets.size());
    CHECK(shape.gradient.size() == offsets.size());
    std::vector<Point<2>> g;
    CHECK(Rkpm<2>{}.direct_gradient(near, g) == shape.condition);
    return shape.condition;
  };
  CHECK(condition({}) == infinity);
  CHECK(condition({{0.1, 0.1}, {0.2, 0.0}}) == infinity);
  CHECK(condition({{0.1, 0.1}, {0.2, 0.2}, {-0.3, -0.3}, {0.4, 0.4}}) == infinity);      // on a line
  CHECK(condition({{0.1, 0.1}, {0.1, 0.1}, {0.1, 0.1}, {0.2, 0.3}}) == infinity);        // coincident
  CHECK(condition({{0.1, 0.0}, {0.0, 0.1}, {2.0, 2.0}, {-3.0, 1.0}}) == infinity);       // two of them out of reach
  CHECK(condition({{0.1, 0.0}, {0.0, 0.1}, {std::nan(""), 2.0}, {-0.1, 0.1}}) == infinity);
  CHECK(condition({{0.1, 0.1}, {0.2, 0.2}, {-0.3, -0.3}, {0.4, 0.4 + 1e-3}}) > 1e4);
  CHECK(condition({{0.4, 0.1}, {-0.3, 0.4}, {-0.3, -0.3}, {0.4, -0.4}}) < 100.0);
}

TEST_CASE("a table names the point, its neighbours and the condition number") {
  const auto cloud = box({.size = {1.0, 1.0, 1.0}, .cells = {4, 4, 4}});
  std::vector<Point<3>> points = {{0.5, 0.5, 0.5}, {0.125, 0.125, 0.125}, {5.0, 0.5, 0.5}};
  const auto message = [&](const auto& kernel, const ShapeFunctionOptions& options = {}) -> std::string {
    try {
      (void)shape_functions(kernel, cloud, points, options);
    } catch (const GeometryError& e) {
      return e.what();
    }
    return {};
  };
  CHECK(message(Rkpm<3>{}).find("Point 2 at (5, 0.5, 0.5) m has 0 particles in reach") == 0);
  CHECK(message(Rkpm<3>{}).find("condition number inf (allowed: 1e+10)") != std::string::npos);
  points.pop_back();
  CHECK(message(Rkpm<3>{}).empty());
  CHECK(message(Rkpm<3, 2>{.support = 1.55}).find("Point 1") == 0);  // eight particles for ten basis functions
  CHECK(message(Rkpm<3, 2>{.support = 1.55}).find("has 8 particles") != std::string::npos);
  CHECK(message(Mls<3>{}, {.condition_limit = 2.0}).find("Point 0") == 0);
  CHECK_THROWS_AS((void)shape_functions(Mls<3>{}, cloud, points, {.condition_limit = 0.0}), ParameterError);
  CHECK_THROWS_AS((void)direct_gradients(Mls<3>{}, cloud, {{9.0, 9.0, 9.0}}), GeometryError);
  CHECK(shape_functions(Mls<3>{}, cloud, {}).points() == 0);
  CHECK_THROWS_AS((void)shape_functions(Rkpm<3>{.support = 1.0}, cloud, points), ParameterError);
  CHECK_THROWS_AS((void)shape_functions(Rkpm<3>{.support = std::nan("")}, cloud, points), ParameterError);
  CHECK_THROWS_AS((Mls<2, 2>{.support = 1.5}.validate()), ParameterError);
}

TEST_CASE("interpolation converges, and any number of threads gives the same bits") {
  const auto error = [](int cells, auto kernel) {
    const auto cloud = jitter(rectangle({.size = {1.0, 1.0}, .cells = {cells, cells}}), 0.1);
    std::vector<double> nodal;
    for (const auto& x : cloud.positions) nodal.push_back(std::sin(3.0 * x[0]) * std::cos(2.0 * x[1]));
    std::vector<Point<2>> points;
    for (const auto& p : gauss_points<2>(cloud)) points.push_back(p.position);
    const auto shape = shape_functions(kernel, cloud, points);
    double worst = 0.0;
    for (std::size_t q = 0; q < points.size(); ++q)
      worst = std::max(worst, std::abs(interpolate(shape, q, nodal) -
                                       std::sin(3.0 * points[q][0]) * std::cos(2.0 * points[q][1])));
    return worst;
  };
  CHECK(std::log2(error(10, Rkpm<2>{}) / error(20, Rkpm<2>{})) > 1.7);
  CHECK(std::log2(error(10, Rkpm<2, 2>{}) / error(20, Rkpm<2, 2>{})) > 2.6);

  const auto cloud = ball({.radius = 1.0, .core_radius = 0.5, .core_cells = 4, .shells = 2});
  set_thread_count(1);
  const auto one = shape_functions(Rkpm<3>{}, cloud, cloud.positions);
  set_thread_count(2);
  const auto two = shape_functions(Rkpm<3>{}, cloud, cloud.positions);
  CHECK(one.values == two.values);
  CHECK(one.gradients == two.gradients);
  CHECK(one.indices == two.indices);
}

}  // namespace kernel_test
