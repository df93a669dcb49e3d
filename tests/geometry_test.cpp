#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <tactoid/geometry/all.hpp>

#include "relative.hpp"

namespace geometry_test {

using namespace tactoid;

namespace {

constexpr double pi = std::numbers::pi;

PointCloud<3> paper_ball(double fraction = 0.618) { return ball({.radius = 5e-6, .core_radius = fraction * 5e-6}); }

// Identities of the boundary integrals, and the nodal cells against independent integrals of the cells.
template <int D>
void check_measures(const PointCloud<D>& cloud) {
  validate(cloud);
  const double total = volume(cloud);
  const double length = std::pow(total, 1.0 / D);
  Point<D> closed = Point<D>::Zero();
  Eigen::Matrix<double, D, D> moment = Eigen::Matrix<double, D, D>::Zero();
  const auto b = boundary_normal_integrals(cloud);
  const auto boundary = on_boundary(cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    closed += b[i];
    moment += b[i] * cloud.positions[i].transpose();
    if (!boundary[i]) CHECK(b[i] == Point<D>::Zero());
  }
  CHECK(closed.norm() < 1e-13 * std::pow(length, D - 1) * static_cast<double>(cloud.facets.size()));
  CHECK((moment / total - Eigen::Matrix<double, D, D>::Identity()).norm() < 1e-12);

  double nodal = 0.0;
  Point<D> first = Point<D>::Zero();
  const auto cells = nodal_cells(cloud);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    CHECK(cells[i].volume > 0.0);
    if (i > 0) {
      const bool ascending = cells[i - 1].particle < cells[i].particle ||
                             (cells[i - 1].particle == cells[i].particle && cells[i - 1].region < cells[i].region);
      CHECK(ascending);
    }
    nodal += cells[i].volume;
    first += cells[i].volume * cells[i].centroid;
  }
  double gauss = 0.0;
  Point<D> gauss_first = Point<D>::Zero();
  for (const auto& p : gauss_points<3>(cloud)) {
    gauss += p.weight;
    gauss_first += p.weight * p.position;
  }
  CHECK(std::abs(nodal / total - 1.0) < 1e-12);
  CHECK(std::abs(gauss / total - 1.0) < 1e-12);
  CHECK((first - gauss_first).norm() < 1e-12 * total * length);
  // The divergence theorem with the facets: D V = ∮ x · n dA.
  double flux = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) flux += b[i].dot(cloud.positions[i]);
  CHECK(std::abs(flux / (D * total) - 1.0) < 1e-12);
}

template <class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const Error& e) {
    return e.what();
  }
  return {};
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("bricks: counts, volumes, facets") {
  const auto line = bar({.length = 2.0, .cells = 10});
  CHECK(line.size() == 11);
  CHECK(line.facets.size() == 2);
  CHECK(volume(line) == test::relative(2.0).epsilon(1e-14));
  const auto plane = rectangle({.size = {2.0, 3.0}, .cells = {4, 5}, .origin = {-1.0, 0.5}});
  CHECK(plane.size() == 30);
  CHECK(plane.facets.size() == 18);
  CHECK(volume(plane) == test::relative(6.0).epsilon(1e-14));
  CHECK(boundary_area(plane) == test::relative(10.0).epsilon(1e-14));
  const auto brick = box({.size = {2.0, 3.0, 1.0}, .cells = {4, 5, 3}, .origin = {-1.0, 0.5, 2.0}});
  CHECK(brick.size() == 120);
  CHECK(brick.facets.size() == 2 * (20 + 15 + 12));
  CHECK(volume(brick) == test::relative(6.0).epsilon(1e-14));
  CHECK(boundary_area(brick) == test::relative(22.0).epsilon(1e-14));
  CHECK(select(brick, [](const Point<3>& x) { return x[2] == 3.0; }).size() == 30);

  const Point<3> middle(0.0, 2.0, 2.5);
  for (const auto& facet : brick.facets) {
    Point<3> center = Point<3>::Zero();
    for (const Index i : facet) center += 0.25 * brick.positions[i];
    CHECK(facet_vector_area(brick, facet).dot(center - middle) > 0.0);
    CHECK(facet_area(brick, facet) == test::relative(facet_vector_area(brick, facet).norm()).epsilon(1e-13));
  }
  for (const auto& facet : plane.facets) {
    const Point<2> center = 0.5 * (plane.positions[facet[0]] + plane.positions[facet[1]]);
    CHECK(facet_vector_area(plane, facet).dot(center - Point<2>(0.0, 2.0)) > 0.0);
  }
}

TEST_CASE("periodic bricks wrap their cells") {
  const auto ring = bar({.length = 2.0, .cells = 5, .periodic = true, .origin = 0.3});
  CHECK(ring.size() == 5);
  CHECK(ring.cells.size() == 5);
  CHECK(ring.facets.empty());
  CHECK(ring.period[0] == 2.0);
  for (const auto& b : boundary_normal_integrals(ring)) CHECK(b[0] == 0.0);

  const auto slab = box({.size = {2.0, 3.0, 1.0}, .cells = {4, 6, 3}, .periodic = {true, true, false}});
  validate(slab);
  CHECK(slab.size() == 4 * 6 * 4);
  CHECK(slab.facets.size() == 2 * 24);
  CHECK(volume(slab) == test::relative(6.0).epsilon(1e-13));
  CHECK(boundary_area(slab) == test::relative(12.0).epsilon(1e-13));
  for (const auto& cell : nodal_cells(slab)) {
    const Point<3>& x = slab.positions[cell.particle];
    const bool outside = x[2] == 0.0 || x[2] == 1.0;
    CHECK(cell.volume == test::relative((outside ? 0.5 : 1.0) / 12.0).epsilon(1e-13));
    CHECK((cell.centroid - x).template head<2>().norm() < 1e-14);  // near the particle, not across the box
    CHECK(std::abs(std::abs(cell.centroid[2] - x[2]) - (outside ? 1.0 / 12.0 : 0.0)) < 1e-15);
  }
  for (const double l : longest_edges(slab)) CHECK(l == test::relative(0.5));
  for (const double l : shortest_edges(slab)) CHECK(l == test::relative(1.0 / 3.0));
}

TEST_CASE("measures: identities to round-off on regular, O-grid and jittered clouds") {
  check_measures(bar({.length = 2.0, .cells = 10, .origin = -0.7}));
  check_measures(jitter(bar({.length = 2.0, .cells = 10}), 0.4));
  check_measures(rectangle({.size = {2.0, 3.0}, .cells = {4, 5}, .origin = {0.2, -0.1}}));
  check_measures(jitter(rectangle({.size = {2.0, 3.0}, .cells = {8, 12}}), 0.2));
  check_measures(circle({.radius = 15e-6}));
  const auto graded = circle({.radius = 2.0, .core_cells = 5, .rings = 4, .growth = 1.2, .center = {1.0, 2.0}});
  check_measures(graded);
  check_measures(jitter(graded, 0.2));
  check_measures(box({.size = {2.0, 3.0, 1.0}, .cells = {4, 5, 3}, .origin = {0.2, -0.1, 0.4}}));
  check_measures(jitter(box({.size = {2.0, 3.0, 1.0}, .cells = {6, 9, 3}}), 0.2));
  check_measures(disc({.radius = 3.0, .height = 1.0, .core_cells = 5, .rings = 4, .layers = 4}));
  check_measures(paper_ball());
  check_measures(ball({.radius = 2.0, .shells = 0, .center = {1.0, 0.0, -1.0}}));
}

TEST_CASE("nodal cells of a frustum have the exact volume and centroid") {
  PointCloud<3> frustum;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const double half = k == 0 ? 1.0 : 0.5;
        frustum.positions.push_back({half * (2 * i - 1), half * (2 * j - 1), static_cast<double>(k)});
      }
  frustum.cells = {{0, 1, 2, 3, 4, 5, 6, 7}};
  frustum.cell_regions = {0};
  frustum.facets = extract_facets(frustum);
  CHECK(frustum.facets.size() == 6);
  check_measures(frustum);
  // V = h (A + √(A B) + B) / 3, z = h (A + 2 √(A B) + 3 B) / (4 (A + √(A B) + B)).
  double z = 0.0, lower = 0.0;
  for (const auto& cell : nodal_cells(frustum)) {
    z += cell.volume * cell.centroid[2];
    if (cell.particle < 4) lower += cell.volume;
  }
  CHECK(volume(frustum) == test::relative(7.0 / 3.0).epsilon(1e-14));
  CHECK(z / volume(frustum) == test::relative(11.0 / 28.0).epsilon(1e-14));
  CHECK(lower == test::relative((4.0 + 3.0 + 2.25) / 6.0).epsilon(1e-14));  // the half below z = 1/2
  CHECK(boundary_area(frustum) == test::relative(5.0 + 4.0 * 1.5 * std::sqrt(1.25)).epsilon(1e-13));
}

TEST_CASE("Gauss points integrate polynomials of degree 2 N - 1") {
  const auto plane = rectangle({.size = {2.0, 1.0}, .cells = {3, 2}});
  const auto moment = [&](const auto& points, int degree) {
    double sum = 0.0;
    for (const auto& p : points) sum += p.weight * std::pow(p.position[0], degree);
    return sum * (degree + 1) / std::pow(2.0, degree + 1);
  };
  CHECK(gauss_points<1>(plane).size() == 6);
  CHECK(gauss_points<2>(plane).size() == 24);
  CHECK(gauss_points<3>(plane).size() == 54);
  CHECK(moment(gauss_points<1>(plane), 1) == test::relative(1.0).epsilon(1e-13));
  CHECK(moment(gauss_points<2>(plane), 3) == test::relative(1.0).epsilon(1e-13));
  CHECK(moment(gauss_points<3>(plane), 5) == test::relative(1.0).epsilon(1e-13));
  CHECK(std::abs(moment(gauss_points<2>(plane), 4) - 1.0) > 1e-6);
}

TEST_CASE("the paper's ball and disc") {
  for (const double fraction : {0.382, 0.618}) {
    const auto cell = paper_ball(fraction);
    CHECK(cell.size() == 4341);
    CHECK(cell.cells.size() == 4000);
    CHECK(cell.facets.size() == 600);
    CHECK(cell.regions == std::vector<std::string>{"nucleus", "cytoplasm"});
    validate(cell);
    std::vector<bool> nucleus(cell.size(), false), cytoplasm(cell.size(), false);
    for (std::size_t c = 0; c < cell.cells.size(); ++c)
      for (const Index i : cell.cells[c]) (cell.cell_regions[c] == 0 ? nucleus : cytoplasm)[i] = true;
    int shared = 0;
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const double r = cell.positions[i].norm();
      if (nucleus[i] && cytoplasm[i]) {
        ++shared;
        CHECK(r == test::relative(fraction * 5e-6).epsilon(1e-14));
      } else if (nucleus[i]) {
        CHECK(r < fraction * 5e-6);
      } else {
        CHECK(r > fraction * 5e-6);
      }
    }
    CHECK(shared == 602);
    CHECK(std::count(cytoplasm.begin(), cytoplasm.end(), true) - shared == 3010);
    for (const auto& facet : cell.facets)
      for (const Index i : facet) CHECK(cell.positions[i].norm() == test::relative(5e-6).epsilon(1e-14));
    double parts[2] = {0.0, 0.0};
    for (const auto& n : nodal_cells(cell)) parts[n.region] += n.volume;
    CHECK(nodal_cells(cell).size() == 4341 + 602);
    const double sphere = 4.0 / 3.0 * pi * 125e-18;
    CHECK(parts[0] / (std::pow(fraction, 3) * sphere) == test::relative(0.98925).epsilon(1e-5));
    CHECK((parts[0] + parts[1]) / sphere == test::relative(0.98925).epsilon(1e-5));
  }
  const auto substrate = disc({.radius = 15e-6, .height = 5e-6, .region = "substrate"});
  CHECK(substrate.size() == 16640);
  CHECK(substrate.cells.size() == 7 * (21 * 21 + 19 * 84));
  CHECK(substrate.regions == std::vector<std::string>{"substrate"});
  validate(substrate);
  CHECK(select(substrate, [](const Point<3>& x) { return x[2] == 0.0; }).size() == 2080);
  CHECK(select(substrate, [](const Point<3>& x) { return x[2] == -5e-6; }).size() == 2080);
  const auto rim = select(substrate, [](const Point<3>& x) { return x.head<2>().norm() > 15e-6 * (1.0 - 1e-12); });
  CHECK(rim.size() == 8 * 84);
  double largest = 0.0;
  for (const auto& x : substrate.positions) largest = std::max(largest, x.head<2>().norm());
  CHECK(largest == test::relative(15e-6).epsilon(1e-14));
  // Area of a polygon of 84 nearly equal sides.
  const double polygon = 84 / (2 * pi) * std::sin(2 * pi / 84);
  CHECK(volume(substrate) / (pi * 225e-12 * 5e-6) == test::relative(polygon).epsilon(1e-4));
}

TEST_CASE("balls converge to the sphere with second order") {
  const auto defect = [](int n) {
    return 1.0 - volume(ball({.radius = 1.0, .core_radius = 0.5, .core_cells = n, .shells = n / 2})) / (4.0 / 3.0 * pi);
  };
  CHECK(std::log2(defect(4) / defect(8)) == test::relative(2.0).epsilon(0.05));
  CHECK(std::log2(defect(8) / defect(16)) == test::relative(2.0).epsilon(0.02));
}

TEST_CASE("cells of the generators are well shaped") {
  const auto worst = [](const PointCloud<3>& cloud) {
    double shape = 1.0;
    for (const auto& cell : cloud.cells) {
      const auto corners = cell_corners(cloud, cell);
      for (std::size_t a = 0; a < 8; ++a) {
        const Point<3> xi((a & 1) ? 1 : 0, (a & 2) ? 1 : 0, (a & 4) ? 1 : 0);
        const auto jacobian = cell_jacobian<3>(corners, xi);
        shape = std::min(shape, jacobian.determinant() / jacobian.colwise().norm().prod());
      }
    }
    return shape;
  };
  CHECK(worst(disc({.radius = 15e-6, .height = 5e-6})) > 0.75);
  // The eight corners of the core's cube lie on a sphere: their angles are bounded by the sphere, not by the map.
  CHECK(worst(paper_ball()) > 0.08);
  for (const int n : {2, 3, 5, 16, 24}) CHECK(worst(ball({.radius = 1.0, .core_radius = 0.4, .core_cells = n})) > 0.0);
  const auto edges = shortest_edges(paper_ball());
  CHECK(*std::min_element(edges.begin(), edges.end()) > 0.3e-6);
}

TEST_CASE("Morton order renumbers and keeps the cloud") {
  PointCloud<3> shuffled = box({.size = {1.0, 1.0, 1.0}, .cells = {9, 9, 9}});
  const auto scrambled = [n = shuffled.size()](std::size_t i) { return (i * 373) % n; };  // 373 and 1000 are coprime
  PointCloud<3> copy = shuffled;
  for (std::size_t i = 0; i < copy.size(); ++i) shuffled.positions[scrambled(i)] = copy.positions[i];
  for (auto& cell : shuffled.cells)
    for (Index& i : cell) i = static_cast<Index>(scrambled(i));
  for (auto& facet : shuffled.facets)
    for (Index& i : facet) i = static_cast<Index>(scrambled(i));
  const auto ordered = morton_ordered(shuffled);
  validate(ordered);
  CHECK(ordered.positions == copy.positions);
  CHECK(ordered.cells == copy.cells);
  CHECK(ordered.facets == copy.facets);
  const auto stride = [](const PointCloud<3>& cloud) {
    double sum = 0.0;
    for (const auto& cell : cloud.cells)
      sum += static_cast<double>(*std::max_element(cell.begin(), cell.end()) -
                                 *std::min_element(cell.begin(), cell.end()));
    return sum;
  };
  CHECK(stride(ordered) < 0.3 * stride(shuffled));
  // The first eight points of a cube of 4 × 4 × 4 are its first octant.
  const auto small = box({.size = {3.0, 3.0, 3.0}, .cells = {3, 3, 3}});
  for (Index i = 0; i < 8; ++i) CHECK(small.positions[i].maxCoeff() <= 1.0);
}

TEST_CASE("jitter moves the inside by a bounded, reproducible amount") {
  const auto cloud = box({.size = {2.0, 2.0, 2.0}, .cells = {8, 8, 8}});
  const auto moved = jitter(cloud, 0.2, 7);
  CHECK(moved.positions == jitter(cloud, 0.2, 7).positions);
  CHECK(moved.positions != jitter(cloud, 0.2, 8).positions);
  CHECK(cloud.positions == jitter(cloud, 0.0).positions);
  const auto fixed = on_boundary(cloud);
  double largest = 0.0, mean = 0.0, square = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Point<3> d = moved.positions[i] - cloud.positions[i];
    if (fixed[i]) {
      CHECK(d == Point<3>::Zero());
      continue;
    }
    largest = std::max(largest, d.cwiseAbs().maxCoeff());
    mean += d.sum();
    square += d.squaredNorm();
    count += 3;
  }
  const double step = 0.2 * 0.25;
  CHECK(count == 3 * 343);
  CHECK(largest <= step);
  CHECK(largest > 0.99 * step);
  CHECK(std::abs(mean / count) < 0.1 * step);
  CHECK(square / count == test::relative(step * step / 3.0).epsilon(0.1));
  CHECK_THROWS_AS((void)jitter(cloud, 0.5), ParameterError);
  CHECK_THROWS_AS((void)jitter(cloud, -0.1), ParameterError);
}

TEST_CASE("a ball that is refined at its pole: facets there are as small as said, the surface stays a sphere, the inside follows in part") {
  const PoleRefinement refinement{.factor = 2.0, .angle = 1.0};
  const auto check = [&](const auto& ball, const auto& center) {
    constexpr int D = std::decay_t<decltype(center)>::RowsAtCompileTime;
    const auto refined = refine_pole<D>(ball, center, 2.0, refinement);
    if constexpr (D == 3) check_measures(refined);  // the axis of a section is no surface
    CHECK(refined.cells == ball.cells);
    const auto boundary = on_boundary(ball);
    double all = 0.0;
    for (std::size_t i = 0; i < ball.size(); ++i) {
      const Point<D> before = ball.positions[i] - center, after = refined.positions[i] - center;
      CHECK(after.norm() == doctest::Approx(before.norm()).epsilon(1e-13));
      const double old_angle = std::atan2(before.template head<D - 1>().norm(), -before[D - 1]), angle = std::atan2(after.template head<D - 1>().norm(), -after[D - 1]);
      if (boundary[i] && before.norm() > 1.999) {
        CHECK(angle == doctest::Approx(refinement.polar_angle(old_angle)).epsilon(1e-12));
        if (old_angle < 1.999) CHECK(angle == doctest::Approx(0.5 * old_angle).epsilon(1e-12));
      } else if (before.norm() > 0.0) {
        CHECK(angle - old_angle == doctest::Approx(std::sqrt(0.5 * before.norm()) * (refinement.polar_angle(old_angle) - old_angle)).epsilon(1e-12));
      }
      all += std::abs(angle - old_angle);
    }
    CHECK(all > 0.0);
  };
  check(ball({.radius = 2.0, .core_radius = 0.8, .core_cells = 6, .shells = 4, .center = {0.0, 0.0, 0.5}}), Point<3>(0.0, 0.0, 0.5));
  check(meridian(Ball{.radius = 2.0, .core_radius = 0.8, .core_cells = 6, .shells = 4, .center = {0.0, 0.0, 0.5}}), Point<2>(0.0, 0.5));
  const PointCloud<2> section = meridian(Ball{.radius = 2.0, .core_radius = 0.8});
  CHECK(refine_pole<2>(section, Point<2>::Zero(), 2.0, {.factor = 1.0}).positions == section.positions);
  // π stays π, and the angle grows.
  CHECK(refinement.polar_angle(std::numbers::pi) == doctest::Approx(std::numbers::pi).epsilon(1e-14));
  for (int k = 0; k < 100; ++k) CHECK(refinement.polar_angle(0.0314 * (k + 1)) > refinement.polar_angle(0.0314 * k));
  CHECK(contains(message_of([] { PoleRefinement{.factor = 0.5}.validate(); }), "PoleRefinement.factor = 0.5"));
  CHECK(contains(message_of([] { PoleRefinement{.factor = 3.0, .angle = 1.0}.validate(); }), "below 0.8 pi"));
  CHECK(contains(message_of([] { PoleRefinement{.angle = 0.0}.validate(); }), "PoleRefinement.angle"));
}

TEST_CASE("wrong parameters are named") {
  CHECK(contains(message_of([] { (void)ball({.radius = 5e-6, .core_radius = 5e-6}); }), "Ball.core_radius = 5e-06 m"));
  CHECK(contains(message_of([] { (void)ball({.radius = 5e-6, .core_radius = 6e-6}); }), "Ball.radius = 5e-06 m"));
  CHECK(contains(message_of([] { (void)ball({.radius = -1.0, .core_radius = 1.0}); }), "Ball.radius = -1 m"));
  CHECK(contains(message_of([] { (void)ball({.radius = 1.0, .core_radius = 0.5, .core_cells = 1}); }),
                 "Ball.core_cells"));
  CHECK(contains(message_of([] { (void)ball({.radius = 1.0, .core_radius = 0.5, .shells = -1}); }), "Ball.shells"));
  for (const double grading : {-0.1, 1.0, std::nan("")}) {
    CHECK(contains(message_of([&] { (void)ball({.radius = 1.0, .core_radius = 0.5, .shell_grading = grading}); }),
                   "Ball.shell_grading"));
  }
  CHECK(contains(message_of([] { (void)disc({.radius = 1.0}); }), "Disc.height = 0 m"));
  CHECK(contains(message_of([] { (void)disc({.radius = 1.0, .height = 1.0, .layers = 1}); }), "Disc.layers = 1"));
  CHECK(contains(message_of([] { (void)disc({.radius = 0.0, .height = 1.0}); }), "Disc.radius"));
  CHECK(contains(message_of([] { (void)circle({.radius = 1.0, .core_roundness = 1.0}); }), "Circle.core_roundness"));
  CHECK(contains(message_of([] { (void)bar({.length = 1.0}); }), "Bar.cells = 0"));
  CHECK(contains(message_of([] { (void)bar({.length = 1.0, .cells = 2, .periodic = true}); }), "at least 3"));
  CHECK(contains(message_of([] { (void)box({.size = {1.0, 0.0, 1.0}, .cells = {1, 1, 1}}); }), "Box.size[1]"));
  CHECK(contains(message_of([] { (void)rectangle({.size = {1.0, 1.0}, .cells = {1, 0}}); }), "Rectangle.cells[1]"));
}

TEST_CASE("a broken cloud is refused with place and cause") {
  const auto sound = box({.size = {3.0, 3.0, 3.0}, .cells = {3, 3, 3}});
  const auto message = [&](const auto& damage) {
    auto cloud = sound;
    damage(cloud);
    CHECK_THROWS_AS(validate(cloud), GeometryError);
    return message_of([&] { validate(cloud); });
  };
  CHECK_NOTHROW(validate(sound));
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(contains(message([](auto& c) { c.positions[17][1] = nan; }), "Particle 17"));
  CHECK(contains(message([](auto& c) { c.cells[4][2] = 64; }), "Cell 4 uses particle 64"));
  CHECK(contains(message([](auto& c) { c.cells[4][2] = c.cells[4][3]; }), "twice"));
  CHECK(contains(message([](auto& c) { std::swap(c.cells[5][0], c.cells[5][1]); }), "Cell 5 has the Jacobian"));
  CHECK(contains(message([](auto& c) { c.positions.push_back({9.0, 9.0, 9.0}); }), "Particle 64"));
  CHECK(contains(message([](auto& c) { c.cell_regions[3] = 1; }), "Cell 3 is in region 1"));
  CHECK(contains(message([](auto& c) { c.cell_regions.pop_back(); }), "cell_regions"));
  CHECK(contains(message([](auto& c) { c.facets[6][0] = 99; }), "Facet 6"));
  CHECK(contains(message([](auto& c) { c.period[0] = -1.0; }), "period"));
  CHECK(contains(message([](auto& c) { c.cells.clear(); }), "no cells"));
  CHECK(contains(message([](auto& c) { c.positions.clear(); }), "no particles"));
}

}  // namespace geometry_test
