// Parts of clouds that one of several processes has, made with and without the whole.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <vector>

#include <tactoid/geometry/all.hpp>
#include <tactoid/neighbors/part_of.hpp>

namespace neighbors_part_test {
using namespace tactoid;

/// What every division must have, of all parts of a cloud.
template <int D, class MakePart>
void check_division(const PointCloud<D>& whole, const MakePart& make, int ranks, double support, bool surface = false) {
  CAPTURE(ranks);
  CAPTURE(surface);
  const std::vector<NodalCell<D>> cells = nodal_cells(whole);
  const std::vector<double> volumes = nodal_volumes(whole), spacing = longest_edges(whole);
  const auto normals = boundary_normal_integrals(whole);
  std::vector<int> owner(whole.size(), -1);
  std::vector<PointCloud<D>> parts;
  for (int rank = 0; rank < ranks; ++rank) {
    parts.push_back(make(Part{.rank = rank, .ranks = ranks, .support = support, .surface = surface}));
    const PointCloud<D>& here = parts.back();
    CHECK_NOTHROW(validate(here));
    REQUIRE(here.part);
    CHECK(here.part->rank == rank);
    CHECK(here.part->ranks == ranks);
    CHECK(here.part->whole == whole.size());
    CHECK(here.part->surface == surface);
    for (const Index i : here.part->own) {
      CHECK(owner[here.number(i)] == -1);  // each particle belongs to one rank
      owner[here.number(i)] = rank;
    }
  }
  CHECK(std::count(owner.begin(), owner.end(), -1) == 0);
  for (const PointCloud<D>& here : parts) {
    const CloudPart& part = *here.part;
    CAPTURE(part.rank);
    CHECK(part.own.size() + part.own.size() / 2 + 2 >= whole.size() / static_cast<std::size_t>(ranks));
    const std::vector<double> volumes_here = nodal_volumes(here), spacing_here = longest_edges(here);
    const auto normals_here = boundary_normal_integrals(here);
    std::vector<char> is_here(whole.size(), 0);
    std::size_t places = 0, owners = 0, off = 0;
    for (std::size_t i = 0; i < here.size(); ++i) {
      const std::size_t of_whole = here.number(i);
      is_here[of_whole] = part.complete[i] ? 2 : 1;
      off += std::abs(part.spacing[i] - spacing[of_whole]) > 1e-12 * spacing[of_whole] ? 1 : 0;
      places += here.positions[i] != whole.positions[of_whole] ? 1 : 0;
      owners += part.owner[i] != owner[of_whole] ? 1 : 0;
      if (!part.complete[i]) continue;
      off += std::abs(volumes_here[i] - volumes[of_whole]) > 1e-12 * volumes[of_whole] ? 1 : 0;
      off += spacing_here[i] != spacing[of_whole] ? 1 : 0;
      if constexpr (D > 1) off += (normals_here[i] - normals[of_whole]).norm() > 1e-12 ? 1 : 0;
    }
    CHECK(places == 0);
    CHECK(owners == 0);
    CHECK(off == 0);
    if (surface) {  // on all ranks the same, particle by particle and facet by facet
      CHECK(here.facets == parts.front().facets);
      CHECK(here.facets.size() == whole.facets.size());
      const std::vector<bool> on_facets = on_boundary(here), on_facets_of_whole = on_boundary(whole);
      const auto n = static_cast<std::size_t>(std::count(on_facets_of_whole.begin(), on_facets_of_whole.end(), true));
      CHECK(std::count(on_facets.begin(), on_facets.end(), true) == static_cast<std::ptrdiff_t>(n));
      std::size_t others = 0;
      for (std::size_t i = 0; i < n; ++i) {
        others += on_facets[i] && here.number(i) == parts.front().number(i) ? 0 : 1;
        if constexpr (D > 1) others += (normals_here[i] - normals[here.number(i)]).norm() < 1e-12 ? 0 : 1;
      }
      CHECK(others == 0);
    }
    // Everything that a row may touch which touches an own particle is complete.
    std::size_t missing = 0;
    for (const Index i : part.own)
      for (std::size_t j = 0; j < whole.size(); ++j)
        if (whole.difference(here.positions[i], whole.positions[j]).norm() <= support * (spacing[here.number(i)] + spacing[j]) && is_here[j] != 2) ++missing;
    CHECK(missing == 0);
  }
}

/// A part of one rank with its particles in the order of the whole.
template <int D>
PointCloud<D> in_order(const PointCloud<D>& part) {
  PointCloud<D> whole = part;
  whole.part = nullptr;
  for (std::size_t i = 0; i < part.size(); ++i) whole.positions[part.number(i)] = part.positions[i];
  const auto renumber = [&](auto& list) {
    for (auto& entity : list)
      for (Index& i : entity) i = static_cast<Index>(part.number(i));
  };
  renumber(whole.cells);
  renumber(whole.facets);
  return whole;
}

/// The box with its particles in rows, as box_part numbers them.
PointCloud<3> in_rows(const Box& parameters) {
  PointCloud<3> cloud = box_part(parameters, {.rank = 0, .ranks = 1, .support = 2.0});
  CHECK(cloud.part->own.size() == cloud.size());
  const PointCloud<3> ordered = in_order(cloud);
  // It is the box.
  const PointCloud<3> same = box(parameters);
  CHECK(ordered.size() == same.size());
  CHECK(ordered.cells.size() == same.cells.size());
  CHECK(ordered.facets.size() == same.facets.size());
  CHECK(ordered.period == same.period);
  CHECK(volume(ordered) == doctest::Approx(volume(same)).epsilon(1e-14));
  CHECK((same.facets.empty() || boundary_area(ordered) == doctest::Approx(boundary_area(same)).epsilon(1e-14)));
  return ordered;
}

TEST_CASE("Parts of a box that are made without the whole") {
  const Box wide{.size = Point<3>(3.0, 1.0, 1.5), .cells = {14, 5, 9}, .region = "gel"};
  for (const bool surface : {false, true})
    for (const int ranks : {1, 2, 3, 7}) check_division(in_rows(wide), [&](const Part& part) { return box_part(wide, part); }, ranks, 1.2, surface);
  const Box around{.size = Point<3>(3.0, 0.5, 1.0), .cells = {30, 4, 4}, .periodic = {true, false, true}};
  for (const bool surface : {false, true})
    for (const int ranks : {1, 2, 5}) check_division(in_rows(around), [&](const Part& part) { return box_part(around, part); }, ranks, 1.1, surface);
  const PointCloud<3> one = box_part(wide, {.rank = 1, .ranks = 2, .support = 1.0});
  CHECK(one.regions == std::vector<std::string>{"gel"});
  CHECK(one.size() < 15 * 6 * 10);
}

TEST_CASE("Parts of a rectangle, periodic in one direction") {
  const Rectangle strip{.size = Point<2>(4.0, 1.0), .cells = {40, 7}, .periodic = {true, false}};
  const PointCloud<2> rows = rectangle_part(strip, {.support = 2.0});
  for (const bool surface : {false, true})
    for (const int ranks : {2, 3, 4}) check_division(in_order(rows), [&](const Part& part) { return rectangle_part(strip, part); }, ranks, 2.0, surface);
}

TEST_CASE("Parts of any cloud") {
  const PointCloud<3> round = ball({.radius = 1.0, .core_radius = 0.5, .core_cells = 4, .shells = 3});
  for (const bool surface : {false, true})
    for (const int ranks : {1, 2, 5}) check_division(round, [&](const Part& part) { return part_of(round, part); }, ranks, 1.3, surface);
  const PointCloud<3> around = box({.size = Point<3>(3.0, 0.5, 1.0), .cells = {24, 4, 6}, .periodic = {true, false, false}});
  for (const int ranks : {2, 4}) check_division(around, [&](const Part& part) { return part_of(around, part); }, ranks, 1.2);
  const PointCloud<1> line = bar({.length = 1.0, .cells = 40});
  check_division(line, [&](const Part& part) { return part_of(line, part); }, 3, 2.0);
}

TEST_CASE("A part of a graded cloud reaches as far as its own supports") {
  PointCloud<3> graded = box({.size = Point<3>(1.0, 1.0, 1.0), .cells = {20, 6, 6}});
  for (Point<3>& X : graded.positions) X[0] = X[0] * X[0] * 4.0;  // edges from 0.01 to 0.39
  for (const int ranks : {2, 4}) check_division(graded, [&](const Part& part) { return part_of(graded, part); }, ranks, 1.2);
  const PointCloud<3> fine = part_of(graded, {.rank = 0, .ranks = 4, .support = 1.2});
  CHECK(fine.size() < graded.size() / 2);  // twice the largest support would be all of it
}

TEST_CASE("So many particles that they are divided by a sample") {
  const PointCloud<1> line = bar({.length = 1.0, .cells = 2400000});
  CHECK(line.size() > 2 * detail::sampled_particles);
  std::size_t all = 0;
  for (int rank = 0; rank < 3; ++rank) {
    const PointCloud<1> here = part_of(line, {.rank = rank, .ranks = 3, .support = 2.0});
    CHECK(here.part->own.size() == doctest::Approx(800000.0).epsilon(1e-4));
    CHECK(here.size() <= here.part->own.size() + 2 * 5);
    all += here.part->own.size();
  }
  CHECK(all == line.size());
}

TEST_CASE("Particles that are moved at random are moved alike in a part and in the whole") {
  const PointCloud<3> cloud = box({.size = Point<3>(2.0, 1.0, 1.0), .cells = {12, 5, 5}});
  const PointCloud<3> moved = jitter(cloud, 0.2), here = jitter(part_of(cloud, {.rank = 1, .ranks = 3, .support = 1.0}), 0.2);
  for (std::size_t i = 0; i < here.size(); ++i) CHECK(here.positions[i] == moved.positions[here.number(i)]);
}

TEST_CASE("Parts that cannot be are refused") {
  const Box small{.size = Point<3>(1.0, 1.0, 1.0), .cells = {1, 1, 1}};
  CHECK_THROWS_WITH_AS((void)box_part(small, {.rank = 2, .ranks = 2, .support = 2.0}), "Part.rank = 2 is not allowed: it must be in [0, 2).", ParameterError);
  CHECK_THROWS_WITH_AS((void)box_part(small, {.rank = 0, .ranks = 0, .support = 2.0}), "Part.ranks = 0 is not allowed: it must be at least 1.", ParameterError);
  CHECK_THROWS_AS((void)box_part(small, {.rank = 0, .ranks = 1, .support = 0.0}), ParameterError);
  CHECK_THROWS_WITH_AS((void)box_part(small, {.rank = 0, .ranks = 9, .support = 2.0}), "Part.ranks = 9 is not allowed: the grid cannot be divided so often.", ParameterError);
  CHECK_THROWS_AS((void)part_of(box(small), {.rank = 0, .ranks = 9, .support = 2.0}), ParameterError);
  const Box vast{.size = Point<3>(1.0, 1.0, 1.0), .cells = {2000, 2000, 2000}};
  CHECK_THROWS_AS((void)box_part(vast, {.rank = 0, .ranks = 100000, .support = 2.0}), ParameterError);  // more than 2³² particles
  const PointCloud<3> one = box_part(small, {.rank = 0, .ranks = 2, .support = 2.0});
  CHECK_THROWS_AS((void)part_of(one, {.rank = 0, .ranks = 2, .support = 2.0}), ParameterError);
  CHECK_THROWS_AS((void)morton_ordered(one), ParameterError);
  CHECK_THROWS_AS((void)part_where(one, [](const Point<3>&) { return true; }), ParameterError);
}

}  // namespace neighbors_part_test
