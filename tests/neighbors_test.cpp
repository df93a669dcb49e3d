#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <tactoid/geometry/all.hpp>
#include <tactoid/neighbors/all.hpp>

namespace neighbors_test {

using namespace tactoid;

namespace {

template <int D>
std::vector<Point<D>> random_points(std::size_t count, unsigned seed, double lower = 0.0, double upper = 1.0) {
  std::mt19937 generator(seed);
  std::vector<Point<D>> points(count);
  for (auto& p : points)
    for (int k = 0; k < D; ++k) p[k] = lower + (upper - lower) * static_cast<double>(generator()) * 0x1.0p-32;
  return points;
}

template <int D>
double plain_distance(const Point<D>& a, const Point<D>& b, const Point<D>& period) {
  PointCloud<D> cloud;
  cloud.period = period;
  return cloud.difference(a, b).norm();
}

template <int D>
void against_brute_force(const std::vector<Point<D>>& points, const std::vector<Point<D>>& queries,
                         const std::vector<double>& radii, const Point<D>& period = Point<D>::Zero()) {
  const NeighborSearch<D> search(points, period);
  std::vector<Neighbor> found;
  std::vector<Index> indices;
  std::size_t total = 0;
  for (const auto& x : queries) {
    for (const double radius : radii) {
      std::vector<Neighbor> expected;
      for (Index i = 0; i < points.size(); ++i) {
        const double d = plain_distance<D>(x, points[i], period);
        if (d < radius) expected.push_back({i, d});
      }
      total += expected.size();
      search.within(x, radius, found);
      search.within(x, radius, indices);
      REQUIRE(found.size() == expected.size());
      REQUIRE(indices.size() == expected.size());
      for (std::size_t k = 0; k < found.size(); ++k) {
        CHECK(found[k].index == expected[k].index);
        CHECK(found[k].distance == expected[k].distance);
        CHECK(indices[k] == expected[k].index);
      }
    }
    std::vector<Neighbor> all;
    for (Index i = 0; i < points.size(); ++i) all.push_back({i, plain_distance<D>(x, points[i], period)});
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.distance < b.distance; });
    const auto nearest = search.nearest(x, 5);
    REQUIRE(nearest.size() == std::min<std::size_t>(5, points.size()));
    for (std::size_t k = 0; k < nearest.size(); ++k)
      CHECK(std::abs(nearest[k].distance - all[k].distance) <= 1e-12 * all[k].distance);
    CHECK(plain_distance<D>(x, points[search.nearest(x)], period) <= (1.0 + 1e-12) * all[0].distance);
  }
  CHECK(total > 0);
}

}  // namespace

TEST_CASE("neighbour search against brute force: random points") {
  against_brute_force<1>(random_points<1>(300, 1), random_points<1>(40, 2, -0.1, 1.1), {0.01, 0.1, 2.0});
  against_brute_force<2>(random_points<2>(500, 3), random_points<2>(40, 4, -0.1, 1.1), {0.05, 0.2, 2.0});
  against_brute_force<3>(random_points<3>(800, 5), random_points<3>(40, 6, -0.1, 1.1), {0.0, 0.1, 0.3, 3.0});
}

TEST_CASE("neighbour search against brute force: grids, where distances equal the radius") {
  const auto grid = box({.size = {4.0, 4.0, 4.0}, .cells = {4, 4, 4}});
  against_brute_force<3>(grid.positions, grid.positions, {1.0, 1.5, 2.0, std::sqrt(2.0), std::sqrt(3.0), 3.0});
  const NeighborSearch<3> search(grid.positions);
  std::vector<Index> found;
  search.within({2.0, 2.0, 2.0}, 1.0, found);
  CHECK(found.size() == 1);  // strictly nearer than the radius
  search.within({2.0, 2.0, 2.0}, std::nextafter(1.0, 2.0), found);
  CHECK(found.size() == 7);
  against_brute_force<3>(ball({.radius = 1.0, .core_radius = 0.5, .core_cells = 4}).positions,
                         random_points<3>(30, 7, -1.0, 1.0), {0.2, 0.6});
}

TEST_CASE("neighbour search: coincident, single and no points") {
  const std::vector<Point<3>> same(100, Point<3>(0.5, 0.5, 0.5));
  against_brute_force<3>(same, {{0.5, 0.5, 0.5}, {0.0, 0.5, 0.5}}, {0.1, 0.5, 0.6});
  const NeighborSearch<3> coincident(same);
  CHECK(coincident.nearest({0.0, 0.0, 0.0}) == 0);  // ties go to the least index
  const auto first = coincident.nearest({0.0, 0.0, 0.0}, 3);
  for (Index k = 0; k < 3; ++k) CHECK(first[k].index == k);
  against_brute_force<3>({{0.5, 0.5, 0.5}}, {{0.5, 0.5, 0.5}, {0.0, 0.5, 0.5}}, {0.1, 0.6});

  const NeighborSearch<2> empty(std::vector<Point<2>>{});
  std::vector<Neighbor> found{{1, 1.0}};
  empty.within({0.0, 0.0}, 1.0, found);
  CHECK(found.empty());
  CHECK(empty.nearest({0.0, 0.0}, 3).empty());
  CHECK_THROWS_AS((void)empty.nearest({0.0, 0.0}), GeometryError);
  NeighborSearch<2> unbuilt;
  unbuilt.within({0.0, 0.0}, 1.0, found);
  CHECK(found.empty());
}

TEST_CASE("neighbour search: periodic directions") {
  against_brute_force<1>(random_points<1>(200, 8, -3.0, 3.0), random_points<1>(30, 9, -5.0, 5.0), {0.1, 0.5},
                         Point<1>(1.0));
  against_brute_force<3>(random_points<3>(400, 10), random_points<3>(30, 11, -0.5, 1.5), {0.1, 0.3, 0.5},
                         {1.0, 1.0, 0.0});
  against_brute_force<3>(random_points<3>(400, 12, 5.0, 6.0), random_points<3>(30, 13, 5.0, 6.0), {0.2, 0.5},
                         {1.0, 1.0, 1.0});
  const auto slab = box({.size = {4.0, 4.0, 2.0}, .cells = {4, 4, 2}, .periodic = {true, true, false}});
  against_brute_force<3>(slab.positions, slab.positions, {1.0, 1.5, 2.0}, slab.period);
  const NeighborSearch<3> search(slab.positions, slab.period);
  std::vector<Neighbor> found;
  CHECK_THROWS_AS(search.within({0.0, 0.0, 0.0}, 2.1, found), ParameterError);
  CHECK_THROWS_AS(search.within({0.0, 0.0, 0.0}, -1.0, found), ParameterError);
  CHECK_THROWS_AS(search.within({0.0, 0.0, 0.0}, std::numeric_limits<double>::quiet_NaN(), found), ParameterError);
}

TEST_CASE("neighbour search: rebuilding, copies and padded vectors") {
  const auto points = random_points<3>(200, 14);
  NeighborSearch<3> search(points);
  const NeighborSearch<3> copy = search;
  Field padded;
  for (const auto& p : points) padded.push_back(pad((p + Point<3>::Constant(0.25)).eval()));
  search.rebuild(padded);
  std::vector<Index> moved, original;
  search.within({0.75, 0.75, 0.75}, 0.2, moved);
  copy.within({0.5, 0.5, 0.5}, 0.2, original);
  CHECK(moved == original);
  CHECK(!moved.empty());
  search = NeighborSearch<3>(std::vector<Point<3>>{{1.0, 2.0, 3.0}});
  CHECK(search.size() == 1);
  search.within({1.0, 2.0, 3.0}, 0.1, moved);
  CHECK(moved == std::vector<Index>{0});
  const NeighborSearch<2> flat(padded);  // the first two components
  CHECK(flat.nearest(padded[17].head<2>()) == 17);
  padded[3][1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(search.rebuild(padded), ComputationError);
}

TEST_CASE("the neighbour table takes the support of each particle") {
  const auto check = [](const auto& cloud, const auto& queries, const std::vector<double>& supports) {
    const NeighborTable table = neighbor_table(cloud, queries, supports);
    REQUIRE(table.rows() == queries.size());
    for (std::size_t q = 0; q < queries.size(); ++q) {
      std::vector<Index> expected;
      for (Index i = 0; i < cloud.size(); ++i)
        if (cloud.difference(queries[q], cloud.positions[i]).norm() < supports[i]) expected.push_back(i);
      const auto row = table.row(q);
      CHECK(std::vector<Index>(row.begin(), row.end()) == expected);
    }
    CHECK(!table.indices.empty());
    return table;
  };
  const auto graded = ball({.radius = 1.0, .core_radius = 0.3, .core_cells = 6, .shells = 4});
  std::vector<double> supports = longest_edges(graded);
  for (double& a : supports) a *= 1.75;
  check(graded, graded.positions, supports);
  check(graded, random_points<3>(100, 15, -1.0, 1.0), supports);
  const auto slab = rectangle({.size = {6.0, 6.0}, .cells = {6, 6}, .periodic = {true, false}});
  const auto table = check(slab, slab.positions, std::vector<double>(slab.size(), 2.5));
  set_thread_count(1);
  const NeighborTable one = neighbor_table(slab, slab.positions, std::vector<double>(slab.size(), 2.5));
  set_thread_count(2);
  CHECK(one.indices == table.indices);
  CHECK(one.offsets == table.offsets);
  CHECK_THROWS_AS((void)neighbor_table(slab, slab.positions, std::vector<double>(slab.size(), 3.5)), ParameterError);
  CHECK_THROWS_AS((void)neighbor_table(slab, slab.positions, std::vector<double>(slab.size(), 0.0)), ParameterError);
  CHECK_THROWS_AS((void)neighbor_table(slab, slab.positions, std::vector<double>(3, 1.0)), ParameterError);
  CHECK(neighbor_table(slab, std::vector<Point<2>>{}, std::vector<double>(slab.size(), 2.5)).rows() == 0);
}

}  // namespace neighbors_test
