// What observers measure, against known answers: contact fronts, stresses, regions, motion, probes, reactions.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>
#include <Eigen/Geometry>

#include <tactoid/boundary/all.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/observe/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/all.hpp>

#include "surface_bodies.hpp"

namespace observe_test {

using namespace tactoid;
using test::Close;

namespace {

constexpr double um = 1e-6;
const double pi = std::numbers::pi;

/// The bottom of a flat disc as the spreading surface: the gap at each particle is a function of (x, y).
struct Footprint {
  PointCloud<3> cloud;
  FacetSurface<3> surface;
  Field position;
  std::vector<double> gaps;

  explicit Footprint(int scale, double radius = 10 * um)
      : cloud(disc({.radius = radius, .height = 1 * um, .core_cells = 9 * scale, .rings = 8 * scale, .layers = 2})),
        surface(cloud) {
    // Turned by an odd angle, so that no line of nodes lies along a ray.
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.3, Vector3::UnitZ()).toRotationMatrix();
    for (const auto& X : cloud.positions) position.push_back(pad(Vector3(turn * X)));
  }
  template <class Gap>
  ContactFront front(const Gap& gap, double cutoff = 100e-9, const Vector3& up = Vector3::UnitZ(), int modes = 16) {
    gaps.assign(cloud.size(), std::numeric_limits<double>::infinity());
    for (const Index i : surface.nodes) {
      // The top of the disc and its side are far from the substrate.
      const bool below = cloud.positions[i][2] < -0.5 * um;
      gaps[i] = below ? gap(position[i][0], position[i][1]) : 10 * um;
    }
    return contact_front(surface, position, gaps, cutoff, up, modes);
  }
};

/// Gap that is `cutoff` on the curve r = radius (1 + amplitude cos(m θ + phase)) around (x0, y0), with slope 0.1.
auto around(double radius, double amplitude, int m, double x0 = 0.0, double y0 = 0.0, double cutoff = 100e-9) {
  return [=](double x, double y) {
    const double angle = std::atan2(y - y0, x - x0);
    const double at = radius * (1.0 + amplitude * std::cos(m * angle + 0.7));
    return cutoff + 0.1 * (std::hypot(x - x0, y - y0) - at);
  };
}

}  // namespace

TEST_CASE("A circular front: area, centroid, radius, no modulation; errors fall with the square of the spacing") {
  std::vector<double> errors, noise;
  for (const int scale : {1, 2, 4}) {
    Footprint disc(scale);
    const ContactFront front = disc.front(around(5.3 * um, 0.0, 0, 0.8 * um, -0.5 * um));
    const double area = pi * 5.3 * 5.3 * um * um;
    errors.push_back(std::abs(front.area / area - 1.0));
    noise.push_back(front.modulation);
    const double allowed = 0.012 / (scale * scale);
    CHECK(front.area == Close{area, allowed});
    CHECK(front.radius == Close{5.3 * um, allowed});
    CHECK(std::abs(front.centroid[0] - 0.8 * um) < allowed * um);
    CHECK(std::abs(front.centroid[1] + 0.5 * um) < allowed * um);
    CHECK(std::abs(front.centroid[2] + 1.0 * um) < 1e-12 * um);
    CHECK((front.center - front.centroid).norm() < allowed * um);
    CHECK(front.modes.size() == 17);
    CHECK(front.modes[0] == 1.0);
    CHECK(front.modulation < allowed);
  }
  MESSAGE("circle: relative error of the area " << errors[0] << ", " << errors[1] << ", " << errors[2]
                                                << "; modulation " << noise[0] << ", " << noise[1] << ", " << noise[2]);
  CHECK(errors[2] < errors[0] / 10.0);
  CHECK(noise[2] < noise[0] / 10.0);
}

TEST_CASE("A front modulated by cos m θ: that mode has the amplitude, the others nothing") {
  Footprint disc(4);
  for (const int m : {2, 3, 4, 8}) {
    for (const double amplitude : {0.01, 0.05}) {
      const ContactFront front = disc.front(around(6 * um, amplitude, m));
      CHECK(front.radius == Close{6 * um, 1e-3});
      CHECK(front.area == Close{pi * 36 * um * um * (1.0 + 0.5 * amplitude * amplitude), 2e-3});
      CHECK(front.modes[static_cast<std::size_t>(m)] == Close{amplitude, 0.03});
      CHECK(std::abs(front.phases[static_cast<std::size_t>(m)] + 0.7) < 0.03);
      CHECK(front.modulation == Close{amplitude / std::sqrt(2.0), 0.03});
      for (std::size_t k = 1; k < front.modes.size(); ++k)
        if (k != static_cast<std::size_t>(m)) CHECK(front.modes[k] < 0.001 + 0.02 * amplitude);
    }
  }
  // A mode above those asked for does not show.
  CHECK(disc.front(around(6 * um, 0.02, 8), 100e-9, Vector3::UnitZ(), 6).modulation < 1e-3);
  CHECK(disc.front(around(6 * um, 0.02, 8), 100e-9, Vector3::UnitZ(), 6).modes.size() == 7);
}

TEST_CASE("The modulation counts the modes from 2 on: mode 1 is no shape but a place") {
  Footprint disc(4);
  const ContactFront front = disc.front([](double x, double y) {
    const double angle = std::atan2(y, x);
    const double at = 5 * um * (1.0 + 0.2 * std::cos(2 * angle) + 0.2 * std::cos(3 * angle));
    return 100e-9 + 0.1 * (std::hypot(x, y) - at);
  });
  REQUIRE(front.modes[1] > 0.01);
  double sum = 0.0;
  for (std::size_t m = 2; m < front.modes.size(); ++m) sum += 0.5 * front.modes[m] * front.modes[m];
  CHECK(front.modulation == Close{std::sqrt(sum), 1e-12});
  CHECK(front.modulation > 0.15);
}

TEST_CASE("An elliptic front, against its Fourier series") {
  Footprint disc(4);
  const double a = 6 * um, b = 4.5 * um;
  const ContactFront front = disc.front(
      [=](double x, double y) { return 100e-9 + 0.1 * b * (std::sqrt(x * x / (a * a) + y * y / (b * b)) - 1.0); });
  std::vector<double> mode(17, 0.0);
  const int n = 4096;
  for (std::size_t m = 0; m < mode.size(); ++m)
    for (int k = 0; k < n; ++k) {
      const double angle = 2.0 * pi * k / n;
      const double r = 1.0 / std::hypot(std::cos(angle) / a, std::sin(angle) / b);
      mode[m] += (m == 0 ? 1.0 : 2.0) / n * r * std::cos(static_cast<double>(m) * angle);
    }
  CHECK(front.area == Close{pi * a * b, 1e-3});
  CHECK(front.radius == Close{mode[0], 1e-3});
  double sum = 0.0;
  for (std::size_t m = 1; m < mode.size(); ++m) {
    CHECK(std::abs(front.modes[m] - std::abs(mode[m]) / mode[0]) < 6e-4);
    if (m >= 2) sum += 0.5 * mode[m] * mode[m] / (mode[0] * mode[0]);
  }
  CHECK(front.modulation == Close{std::sqrt(sum), 0.005});
}

TEST_CASE("The area is continuous while the front passes through facets, and nothing is found without contact") {
  Footprint disc(1);
  const auto cone = [](double x, double y) { return 0.1 * std::hypot(x - 0.31 * um, y - 0.17 * um); };
  double last = 0.0, largest_jump = 0.0;
  const double step = 1e-3 * um;
  for (double radius = step; radius < 8 * um; radius += step) {
    const double area = disc.front(cone, 0.1 * radius).area;
    REQUIRE(area >= last * (1.0 - 1e-12));
    if (radius > 1.5 * um) largest_jump = std::max(largest_jump, (area - last) / (2.0 * pi * radius * step));
    last = area;
  }
  MESSAGE("largest growth of the area per growth of the circle: " << largest_jump);
  CHECK(largest_jump < 1.1);  // a facet that counts as a whole would be 20 and more
  // Exactly through particles, too: a cutoff that equals their gap.
  const auto inside = std::find_if(disc.surface.nodes.begin(), disc.surface.nodes.end(),
                                   [&](Index i) { return disc.gaps[i] > 0.2 * um && disc.gaps[i] < 0.4 * um; });
  const double at = disc.gaps[*inside];
  CHECK(disc.front(cone, at).area > 10 * um * um);
  CHECK(disc.front(cone, at).area == Close{disc.front(cone, at * (1.0 + 1e-12)).area, 1e-9});
  const ContactFront none = disc.front([](double, double) { return 1 * um; });
  CHECK(none.area == 0.0);
  CHECK(none.radius == 0.0);
  CHECK(none.modulation == 0.0);
  CHECK(none.centroid == Vector3::Zero());
  CHECK(none.modes.size() == 17);
  // All of the bottom in contact: the area ends at its rim, where the gap jumps within the last facets.
  CHECK(disc.front([](double, double) { return 0.0; }).area == Close{pi * 100 * um * um, 0.01});
}

TEST_CASE("A pocket under the cell lessens the area and leaves the front as it is") {
  Footprint disc(4);
  const auto plain = around(6 * um, 0.03, 5);
  const ContactFront whole = disc.front(plain);
  const ContactFront holed = disc.front(
      [&](double x, double y) { return std::max(plain(x, y), 100e-9 + 0.1 * (1.5 * um - std::hypot(x - 2 * um, y))); });
  CHECK(whole.area - holed.area == Close{pi * 1.5 * 1.5 * um * um, 0.01});
  CHECK(holed.radius == Close{whole.radius, 1e-9});
  CHECK(holed.modulation == Close{whole.modulation, 1e-6});
  CHECK((holed.center - whole.center).norm() < 1e-6 * um);
  CHECK(holed.centroid[0] < whole.centroid[0] - 0.1 * um);
  for (std::size_t m = 1; m < whole.modes.size(); ++m) CHECK(std::abs(holed.modes[m] - whole.modes[m]) < 1e-7);
}

TEST_CASE("How far a displaced circle has come in a direction") {
  Footprint disc(4);
  const double R = 5.3 * um, shift = 0.8 * um;
  const ContactFront front = disc.front(around(R, 0.0, 0, shift, 0.0));
  REQUIRE(front.outline.size() > 100);
  for (const Vector3& x : front.outline) CHECK((x - front.center).norm() == Close{R, 2e-3});
  const auto exact = [&](double toward, double half_angle) {  // the mean over the arc in the sector
    double sum = 0.0, count = 0.0;
    for (int k = 0; k < 100000; ++k) {
      const double angle = 2.0 * pi * k / 100000.0;
      const double x = toward * (shift + R * std::cos(angle)), y = R * std::sin(angle);
      if (std::abs(std::atan2(y, x)) > half_angle) continue;
      sum += std::hypot(x, y);
      count += 1.0;
    }
    return sum / count;
  };
  const Vector3 origin = Vector3::Zero(), x = Vector3::UnitX();
  CHECK(exact(1.0, pi / 4.0) - exact(-1.0, pi / 4.0) == Close{2.0 * 0.9 * shift, 0.02});
  for (const double half_angle : {pi / 4.0, pi / 8.0}) {
    CHECK(front_radius(front, origin, x, half_angle) == Close{exact(1.0, half_angle), 2e-3});
    CHECK(front_radius(front, origin, -x, half_angle) == Close{exact(-1.0, half_angle), 2e-3});
  }
  CHECK(front_radius(front, front.center, Vector3::UnitY()) == Close{R, 2e-3});
  CHECK(front_radius(front, origin + 3 * um * Vector3::UnitZ(), x) == front_radius(front, origin, x));
  CHECK(front_radius(ContactFront{}, origin, x) == 0.0);
}

TEST_CASE("The area is that projected on the substrate, whatever its direction") {
  Footprint disc(2);
  const auto gap = around(5 * um, 0.02, 3);
  const ContactFront flat = disc.front(gap);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vector3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  Field turned;
  for (const Vector4& x : disc.position) turned.push_back(pad(Vector3(turn * x.head<3>())));
  const ContactFront same = contact_front(disc.surface, turned, disc.gaps, 100e-9, turn * Vector3::UnitZ());
  CHECK(same.area == Close{flat.area, 1e-12});
  CHECK(same.radius == Close{flat.radius, 1e-5});
  CHECK(same.modes[3] == Close{flat.modes[3], 1e-2});
  const ContactFront oblique = contact_front(disc.surface, disc.position, disc.gaps, 100e-9, Vector3(0.6, 0.0, 0.8));
  CHECK(oblique.area == Close{0.8 * flat.area, 1e-12});
}

namespace {

Tensor3 affine() {
  Tensor3 F;
  F << 1.02, 0.05, -0.03, 0.01, 0.97, 0.04, 0.02, -0.06, 1.04;
  return F;
}

template <class Body>
void deform(Body& body, const Tensor3& F, const Vector3& shift = Vector3::Zero()) {
  const auto& X = body.table().particle_position;
  for (std::size_t i = 0; i < body.size(); ++i)
    body.displacement[i] = pad(Vector3((F - Tensor3::Identity()) * X[i].template head<3>() + shift));
}

template <class Quadrature>
void check_uniform_stress(Quadrature rule, double tolerance) {
  const ModifiedMooneyRivlin inside{}, outside{.c1 = 500.0, .c2 = 900.0, .lambda = 3e4};
  Body body{"ball", ball({.radius = 1 * um, .core_radius = 0.5 * um, .core_cells = 4, .shells = 3}), Rkpm<3>{}, rule,
            Materials{Region{"nucleus", inside}, Region{"cytoplasm", outside}}};
  const Tensor3 F = affine();
  deform(body, F, {0.2 * um, 0.0, 0.0});
  const StressFields s = stress_fields(body);
  // Written out: σ = P Fᵀ/J, σ_e² = 3/2 dev σ : dev σ.
  const auto expected = [&](const ModifiedMooneyRivlin& law) {
    const Tensor3 sigma = law.first_piola(F) * F.transpose() / F.determinant();
    const Tensor3 dev = sigma - sigma.trace() / 3.0 * Tensor3::Identity();
    return std::pair(std::sqrt(1.5 * (dev.array() * dev.array()).sum()), -sigma.trace() / 3.0);
  };
  const auto [effective_in, pressure_in] = expected(inside);
  const auto [effective_out, pressure_out] = expected(outside);
  REQUIRE(std::abs(effective_in - effective_out) > 0.2 * effective_in);

  int alone = 0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    CHECK(s.volume_ratio[i] == Close{F.determinant(), tolerance});
    const double r = body.table().particle_position[i].template head<3>().norm() / um;
    if (body.table().value_based() && std::abs(r - 0.5) > 1e-6) {
      CHECK(s.effective_stress[i] == Close{r < 0.5 ? effective_in : effective_out, tolerance});
      CHECK(s.pressure[i] == Close{r < 0.5 ? pressure_in : pressure_out, tolerance});
      ++alone;
    } else {  // a mean of both
      CHECK(s.effective_stress[i] <= std::max(effective_in, effective_out) * (1.0 + tolerance));
      CHECK(s.effective_stress[i] >= std::min(effective_in, effective_out) * (1.0 - tolerance));
    }
  }
  if (body.table().value_based()) CHECK(alone > 100);
  const RegionStatistics in = region_statistics(body.table(), s.point_effective_stress, 0);
  const RegionStatistics out = region_statistics(body.table(), s.point_effective_stress, 1);
  CHECK(in.mean == Close{effective_in, tolerance});
  CHECK(in.max == Close{effective_in, tolerance});
  CHECK(out.mean == Close{effective_out, tolerance});
  CHECK(out.max == Close{effective_out, tolerance});
}

}  // namespace

TEST_CASE("Uniform strain gives the law's stress at every particle, in each of two regions") {
  check_uniform_stress(NodalCentroids{}, 1e-9);
  check_uniform_stress(GaussCells<2>{}, 1e-9);
}

TEST_CASE("Statistics of a region are weighted by volume") {
  PointTable table;
  table.volume = {1e-18, 3e-18, 2e-18};
  table.region = {0, 0, 1};
  const RegionStatistics first = region_statistics(table, {10.0, 2.0, 50.0}, 0);
  CHECK(first.mean == Close{4.0, 1e-14});
  CHECK(first.max == 10.0);
  CHECK(region_statistics(table, {10.0, 2.0, 50.0}, 1).mean == Close{50.0, 1e-14});
  CHECK(region_statistics(table, {10.0, 2.0, 50.0}, 2).mean == 0.0);
}

namespace {

/// A free body that flies and turns; stiff enough to stay nearly rigid is not needed: the start is looked at.
template <class Quadrature>
auto free_block(Quadrature rule, double softness = 1.0) {
  return Body{"block", jitter(box({.size = {2 * um, 1 * um, 1 * um}, .cells = {6, 4, 4}}), 0.15), Rkpm<3>{}, rule,
              Materials{Region{"body", ModifiedMooneyRivlin{.c1 = 2000.0 * softness}}}};
}

template <class Quadrature>
void check_rigid_motion(Quadrature rule) {
  auto body = free_block(rule);
  const Vector3 v0(0.3, -0.2, 0.1), spin(2e5, -1e5, 3e5), shift(1 * um, 2 * um, -3 * um);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.7, Vector3(1, 1, 2).normalized()).toRotationMatrix();
  deform(body, R, shift);
  // v(x) = v₀ + ω × x is affine in X, so coefficients and values are the same.
  const Field X = body.table().particle_position;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector3 x = R * X[i].template head<3>() + shift;
    body.velocity[i] = pad(Vector3(v0 + spin.cross(x)));
  }
  // By the points of the quadrature, independently of the lumping. Positions of a value-based body's masses are
  // those of the particles.
  double mass = 0.0;
  Vector3 center = Vector3::Zero();
  for (std::size_t i = 0; i < body.size(); ++i) mass += body.masses()[i];
  if (body.table().value_based()) {
    for (std::size_t i = 0; i < body.size(); ++i) center += body.masses()[i] * (R * X[i].template head<3>() + shift);
  } else {
    for (std::size_t q = 0; q < body.table().points(); ++q)
      center += 1000.0 * body.table().volume[q] * (R * body.table().position[q] + shift);
  }
  center /= mass;
  Simulation simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{}, CentralDifference{}};
  const Motion m = motion<0>(simulation);
  CHECK(m.mass == Close{2e-15, 1e-10});
  CHECK((m.center_of_mass - center).norm() < 1e-12 * center.norm());
  const Vector3 momentum = mass * (v0 + spin.cross(center));
  CHECK((m.momentum - momentum).norm() < 1e-11 * momentum.norm());
  // L = Σ M x × (v₀ + ω × x).
  Vector3 angular = Vector3::Zero();
  const auto& b = simulation.template body<0>();
  for (std::size_t i = 0; i < b.size(); ++i) {
    const Vector3 x = R * X[i].template head<3>() + shift;
    angular += b.masses()[i] * x.cross(v0 + spin.cross(x));
  }
  CHECK((m.angular_momentum - angular).norm() < 1e-11 * angular.norm());
  if (b.table().value_based()) {
    const Motion same = motion(simulation.template particles<0>());
    CHECK((same.momentum - m.momentum).norm() < 1e-12 * momentum.norm());
    CHECK((same.angular_momentum - m.angular_momentum).norm() < 1e-12 * angular.norm());
    CHECK((same.center_of_mass - m.center_of_mass).norm() < 1e-12 * center.norm());
  }
}

}  // namespace

TEST_CASE("Motion of a body that flies and spins") {
  check_rigid_motion(NodalCentroids{});
  check_rigid_motion(GaussCells<2>{});
}

TEST_CASE("Momentum, angular momentum and the path of the centre of mass of a free body stay during a run") {
  auto body = free_block(NodalCentroids{});
  const Vector3 v0(0.3, -0.2, 0.1), spin(2e5, -1e5, 3e5);
  for (std::size_t i = 0; i < body.size(); ++i)
    body.velocity[i] = pad(Vector3(v0 + spin.cross(body.table().particle_position[i].head<3>())));
  Simulation simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{}, CentralDifference{}};
  const Motion start = motion<0>(simulation);
  simulation.run(1e-6);
  const Motion end = motion<0>(simulation);
  CHECK((end.momentum - start.momentum).norm() < 1e-11 * start.momentum.norm());
  const Vector3 path = 1e-6 / start.mass * start.momentum;
  CHECK((end.center_of_mass - start.center_of_mass - path).norm() < 1e-8 * path.norm());
  CHECK((end.angular_momentum - start.angular_momentum).norm() < 1e-3 * start.angular_momentum.norm());
}

namespace {

template <class Quadrature>
void check_probe(Quadrature rule) {
  auto body = free_block(rule);
  const Tensor3 F = affine();
  const Vector3 shift(1 * um, 0.0, 2 * um);
  deform(body, F, shift);
  Tensor3 A;
  A << 1.0, 2.0, -3.0, 0.5, -1.0, 2.0, 4.0, 0.3, 0.7;
  A *= 1e5;
  for (std::size_t i = 0; i < body.size(); ++i)
    body.velocity[i] = pad(Vector3(A * body.table().particle_position[i].template head<3>()));
  std::vector<Point<3>> points;
  for (std::uint64_t k = 0; k < 20; ++k)
    points.push_back({um * (1.0 + test::hashed_uniform(1, 3 * k)),
                      um * (0.5 + 0.5 * test::hashed_uniform(1, 3 * k + 1)),
                      um * (0.5 + 0.5 * test::hashed_uniform(1, 3 * k + 2))});
  points.push_back({0.0, 0.0, 0.0});  // a corner
  const Probe probe(body, points);
  CHECK(probe.size() == 21);
  std::vector<double> linear;
  for (const Vector4& X : body.table().particle_position) linear.push_back(3.0 + 2e6 * X[0] - 5e6 * X[2]);
  Simulation simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{}, CentralDifference{}};
  const auto& b = simulation.template body<0>();
  double force = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i) force = std::max(force, b.force[i].norm());
  const auto readings = probe.template read<0>(simulation);
  for (std::size_t k = 0; k < points.size(); ++k) {
    CHECK((readings[k].position - (F * points[k] + shift)).norm() < 1e-11 * um);
    CHECK((readings[k].displacement - (F * points[k] + shift - points[k])).norm() < 1e-11 * um);
    CHECK((readings[k].velocity - A * points[k]).norm() < 1e-10 * A.norm() * um);
    CHECK(probe.interpolate(linear, k) == Close{3.0 + 2e6 * points[k][0] - 5e6 * points[k][2], 1e-10});
  }
}

}  // namespace

TEST_CASE("A probe reads linear motions exactly, anywhere in the body") {
  check_probe(NodalCentroids{});
  check_probe(GaussCells<2>{});
}

TEST_CASE("A probe reads the field of coefficients, at particles and between them, linear or not") {
  auto body = free_block(GaussCells<2>{});
  for (std::size_t i = 0; i < body.size(); ++i)
    for (int k = 0; k < 3; ++k)
      body.displacement[i][k] = 0.1 * um * test::hashed_uniform(7, 3 * i + static_cast<std::uint64_t>(k));
  const Field at_particles = body.at_particles(body.displacement);
  const Probe probe(body, body.cloud().positions);
  double difference = 0.0, change = 0.0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    difference = std::max(difference, (probe.interpolate(body.displacement, i) - at_particles[i]).norm());
    change = std::max(change, (body.displacement[i] - at_particles[i]).norm());
  }
  CHECK(difference < 1e-14 * um);
  CHECK(change > 0.01 * um);
  // The gradient of the field between the particles, by differences, is that of the body's own rows.
  const auto& table = body.table();
  const std::size_t q = table.points() / 2;
  const double h = 1e-4 * um;
  std::vector<Point<3>> around;
  for (int k = 0; k < 3; ++k)
    for (const double s : {-h, h}) {
      around.emplace_back(table.position[q]);
      around.back()[k] += s;
    }
  const Probe near(body, around);
  for (std::size_t k = 0; k < 3; ++k) {
    Vector4 gradient = Vector4::Zero();
    for (const TableEntry& entry : table.row(q)) gradient += entry.gradient[k] * body.displacement[entry.particle];
    const Vector4 slope =
        (near.interpolate(body.displacement, 2 * k + 1) - near.interpolate(body.displacement, 2 * k)) / (2.0 * h);
    CHECK((slope - gradient).norm() < 1e-5 * (1.0 + gradient.norm()));
  }
}

TEST_CASE("A probe's velocity is that of the present instant, as observers see it: free fall") {
  auto body = free_block(NodalCentroids{});
  const Probe probe(body, {{1 * um, 0.4 * um, 0.6 * um}});
  const Vector3 gravity(0.0, 2e4, -1e4);
  Simulation simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{on<0>(BodyForce<>{.acceleration = gravity})},
                        CentralDifference{}};
  int calls = 0;
  simulation.run(1e-7, every(2e-8, [&](auto& s) {
                   const ProbeReading reading = probe.template read<0>(s)[0];
                   CHECK((reading.velocity - s.time() * gravity).norm() <= 1e-9 * s.time() * gravity.norm());
                   const Vector3 fall = 0.5 * s.time() * s.time() * gravity;
                   CHECK((reading.displacement - fall).norm() <= 1e-9 * fall.norm());
                   ++calls;
                 }));
  CHECK(calls == 6);
}

TEST_CASE("A probe outside the body is refused with the point's name") {
  auto body = free_block(NodalCentroids{});
  try {
    const Probe probe(body, {{1 * um, 0.5 * um, 0.5 * um}, {9 * um, 0.5 * um, 0.5 * um}});
    FAIL("accepted");
  } catch (const GeometryError& error) {
    const std::string text = error.what();
    CHECK(text.find("\"block\"") != std::string::npos);
    CHECK(text.find("Point 1 at (9e-06") != std::string::npos);
    CHECK(text.find("0 particles") != std::string::npos);
  }
}

TEST_CASE(
    "Reactions of a held body under gravity: their impulse is that of the weight and of the motion, step by step") {
  PointCloud<2> cloud = rectangle({.size = {2 * um, 1 * um}, .cells = {8, 4}});
  const auto left = select(cloud, [](const Point<2>& X) { return X[1] < 1e-12 && X[0] < 0.99 * um; });
  const auto right = select(cloud, [](const Point<2>& X) { return X[1] < 1e-12 && X[0] > 0.99 * um; });
  const double gravity = 1e7, weight = 1000.0 * gravity * 2.0 * um * um;
  Body body{"block", std::move(cloud), Rkpm<2>{}, NodalCentroids{},
            Materials{Region{"body", ModifiedMooneyRivlin{.c1 = 2e4, .c2 = 1e3, .lambda = 1e5}}}};
  Simulation simulation{Bodies{std::move(body)}, Contacts{},
                        Boundaries{on<0>(fixed(left)), on<0>(BodyForce<>{.acceleration = Vector3(0.0, -gravity, 0.0)}),
                                   on<0>(fixed(right))},
                        CentralDifference{}};
  CHECK(reactions<0>(simulation).conditions.size() == 2);
  CHECK(reactions<0>(simulation).total == Vector3::Zero());
  Vector3 impulse = Vector3::Zero();
  double step_before = 0.0, largest = 0.0;
  std::size_t seen = 0;
  const auto observe = [&](auto& s) {
    if (s.steps() == seen) return;  // the start, and the end for the second time
    seen = s.steps();
    const Reactions r = reactions<0>(s);
    CHECK((r.conditions[0] + r.conditions[1] - r.total).norm() <= 1e-12 * weight);
    CHECK(r.conditions[1] == s.template essential<0>().reaction(1));
    impulse += 0.5 * (step_before + s.last_time_step()) * r.total;
    step_before = s.last_time_step();
    const double until = s.time() - 0.5 * s.last_time_step();  // where the velocities live
    Vector3 momentum = Vector3::Zero();
    const auto& b = s.template body<0>();
    for (std::size_t i = 0; i < b.size(); ++i) momentum += b.masses()[i] * b.velocity[i].template head<3>();
    largest = std::max(largest, momentum.norm());
    CHECK((impulse - momentum - Vector3(0.0, weight * until, 0.0)).norm() < 1e-11 * weight * until);
  };
  simulation.run(5e-7, every_steps(1, observe));
  CHECK(seen == simulation.steps());
  CHECK(seen > 20);
  CHECK(largest > 0.01 * weight * 5e-7);
  CHECK(reactions<0>(simulation).conditions[0][0] != 0.0);
}

}  // namespace observe_test
