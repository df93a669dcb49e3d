#include <cmath>
#include <cstring>
#include <numbers>

#include <doctest/doctest.h>

#include <tactoid/boundary/body_force.hpp>
#include <tactoid/boundary/boundary.hpp>
#include <tactoid/boundary/curvature_surface_tension.hpp>
#include <tactoid/boundary/pressure.hpp>
#include <tactoid/boundary/surface_tension.hpp>
#include <tactoid/contact/ligand_receptor.hpp>
#include <tactoid/contact/on_rigid.hpp>

#include "surface_bodies.hpp"

namespace boundary_test {

using namespace tactoid;
using tactoid::test::Close;
using tactoid::test::TestBody;

namespace {

struct NoForce {};
const auto gravity_field = [](const Vector3& X, double t) { return Vector3(X.y() * t, 1.0, 2.0); };
static_assert(BoundaryTerm<SurfaceTension, 2> && BoundaryTerm<SurfaceTension, 3> && !BoundaryTerm<SurfaceTension, 1>);
static_assert(BoundaryTerm<CurvatureSurfaceTension, 3> && BoundaryTerm<AmbientPressure, 3> &&
              !BoundaryTerm<NoForce, 3>);
static_assert(BoundaryTerm<BodyForce<>, 1> && BoundaryTerm<BodyForce<decltype(gravity_field)>, 3>);

static_assert(BoundaryTerm<RigidPlate<LigandReceptorLaw>, 2> && BoundaryTerm<OnRigid<RepulsiveWall, RigidSphere>, 3>);

constexpr double um = 1e-6, sigma = 0.072e-3;

TestBody<3> rough_ball(int core, int shells, double amplitude) {
  TestBody<3> body(ball({.radius = 5.0 * um, .core_radius = 2.5 * um, .core_cells = core, .shells = shells}));
  body.place({0.3 * um, -0.2 * um, 1.0 * um}, amplitude, 3, 0.4, Vector3(1, 2, 0.5));
  for (Vector4& x : body.position) x[0] *= 1.2;
  body.random_velocities(1.0, 9);
  return body;
}
TestBody<2> rough_circle(double amplitude) {
  TestBody<2> body(circle({.radius = 5.0 * um, .core_cells = 4, .rings = 3}));
  body.place({0.3 * um, -0.2 * um, 0.0}, amplitude, 3, 0.4);
  body.random_velocities(1.0, 9);
  return body;
}

/// −dU/dt along the velocities of the body, by central differences of fourth order.
template <int D, class Term>
double energy_release(Term& term, TestBody<D>& body, double h) {
  const Field x = body.position;
  const auto energy = [&](double s) {
    for (std::size_t i = 0; i < x.size(); ++i) body.position[i] = x[i] + s * body.velocity[i];
    return term.apply(body.fields(), 0.0).potential;
  };
  const double slope = (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h))) / (12.0 * h);
  body.position = x;
  return -slope;
}

/// Volume enclosed by the facets, split into triangle fans around the facets' middles: exact as a bilinear volume too.
double enclosed_volume(const TestBody<3>& body) {
  double volume = 0.0;
  const auto at = [&](Index i) { return Vector3(body.position[i].head<3>()); };
  for (const auto& f : body.cloud.facets) {
    // The volume under a bilinear facet is the mean of its two triangulations'.
    const Vector3 a = at(f[0]), b = at(f[1]), c = at(f[3]), d = at(f[2]);
    const auto tet = [](const Vector3& p, const Vector3& q, const Vector3& r) { return p.dot(q.cross(r)) / 6.0; };
    volume += 0.5 * (tet(a, b, c) + tet(a, c, d) + tet(a, b, d) + tet(b, c, d));
  }
  return volume;
}

template <int D, class Term>
void check_conservative(Term term, TestBody<D> body, double tolerance) {
  auto f = body.fields();
  term.initialize(body.cloud, f);
  const TermEnergy e = term.apply(f, 0.0);
  const double power = body.power(), scale = body.force_scale();
  CHECK(scale > 0.0);
  CHECK(e.external_power == 0.0);
  CHECK(body.total_force().norm() < 1e-13 * scale);
  CHECK(body.total_torque().norm() < 1e-13 * scale * body.extent());
  CHECK(power == Close{energy_release(term, body, 1e-3 * um), tolerance});
}

}  // namespace

TEST_CASE("surface tension: gradient of the energy, no net force or torque, virial of Laplace") {
  const auto body3 = rough_ball(4, 2, 0.4 * um);
  const auto body2 = rough_circle(0.3 * um);
  check_conservative(SurfaceTension{}, body3, 1e-9);
  check_conservative(SurfaceTension{}, body2, 1e-9);
  check_conservative(SurfaceTension{.smoothing = 0.5}, body3, 1e-9);
  check_conservative(SurfaceTension{.smoothing = 0.5}, body2, 1e-9);
  auto body = body3;
  SurfaceTension term{};
  term.initialize(body.cloud, body.fields());
  const double potential = term.apply(body.fields(), 0.0).potential;
  CHECK(body.virial() == Close{-2.0 * potential, 1e-12});  // A is homogeneous of degree 2
  CHECK(term.area() == Close{potential / sigma, 1e-13});
  auto plane = body2;
  term.initialize(plane.cloud, plane.fields());
  const double length = term.apply(plane.fields(), 0.0).potential;
  CHECK(plane.virial() == Close{-length, 1e-12});
}

TEST_CASE("the tension of a facet that vanishes and turns over jumps, unless it is smooth there") {
  const auto jump = [](double smoothing) {
    auto body = rough_circle(0.0);
    const auto facet = body.cloud.facets.front();
    SurfaceTension term{.smoothing = smoothing};
    term.initialize(body.cloud, body.fields());
    Vector4 force[2];
    for (const int side : {0, 1}) {
      body.position[facet[1]] = body.position[facet[0]] + (side == 0 ? 1e-5 : -1e-5) * um * Vector4(1.0, 0.0, 0.0, 0.0);
      term.apply(body.fields(), 0.0);
      force[side] = body.force[facet[1]];
    }
    return (force[0] - force[1]).norm() / sigma;
  };
  CHECK(jump(0.0) == Close{2.0, 1e-3});
  CHECK(jump(0.1) < 1e-3);
}

TEST_CASE("surface tension of a sphere: area and nodal force converge with the square of the spacing") {
  const double R = 5.0 * um;
  double last_area = 0.0, last_force = 0.0;
  for (const int n : {8, 16, 32}) {
    TestBody<3> body(ball({.radius = R, .core_radius = 2.0 * um, .core_cells = n, .shells = 1}));
    SurfaceTension term{};
    term.initialize(body.cloud, body.fields());
    const double area = term.apply(body.fields(), 0.0).potential / sigma;
    const FacetSurface<3> surface(body.cloud);
    double square = 0.0, weight = 0.0;  // area-weighted error of the normal traction, exact 2σ₀/R
    for (const Index i : surface.nodes) {
      const double traction = -body.force[i].head<3>().dot(body.position[i].head<3>()) / (R * surface.nodal_area[i]);
      square += surface.nodal_area[i] * std::pow(traction / (2.0 * sigma / R) - 1.0, 2);
      weight += surface.nodal_area[i];
    }
    const double area_error = 1.0 - area / (4.0 * std::numbers::pi * R * R), force_error = std::sqrt(square / weight);
    MESSAGE(n, " facets along an edge: area ", area_error, ", traction (rms) ", force_error);
    if (n > 8) {
      CHECK(area_error < last_area / 3.5);
      CHECK(force_error < last_force / 1.6);
    }
    last_area = area_error;
    last_force = force_error;
  }
  CHECK(last_area < 0.002);
  CHECK(last_force < 0.03);
}

TEST_CASE("curvature policy: sphere's curvature and traction, its balance; not exactly conservative") {
  const double R = 5.0 * um;
  double last = 0.0;
  for (const int n : {8, 16, 32}) {
    TestBody<3> body(ball({.radius = R, .core_radius = 2.0 * um, .core_cells = n, .shells = 1}));
    CurvatureSurfaceTension term{};
    term.initialize(body.cloud, body.fields());
    term.apply(body.fields(), 0.0);
    const FacetSurface<3> surface(body.cloud);
    double square = 0.0, weight = 0.0;
    for (const Index i : surface.nodes) {
      square += term.areas[i] * std::pow(term.curvatures[i] / (2.0 / R) - 1.0, 2);
      weight += term.areas[i];
      CHECK(body.force[i].head<3>().dot(body.position[i].head<3>()) < 0.0);
    }
    const double error = std::sqrt(square / weight);
    MESSAGE(n, " facets along an edge: curvature (rms) ", error, ", net force / sum ",
            body.total_force().norm() / body.force_scale());
    if (n > 8) CHECK(error < last / 1.8);
    last = error;
    double sum = 0.0;
    for (const Index i : surface.nodes) sum += body.force[i].norm();
    CHECK(sum == Close{8.0 * std::numbers::pi * R * sigma, 0.6 / (n * n) * 8});
  }
  CHECK(last < 0.01);
  // A circle: κ = 1/R.
  TestBody<2> ring(circle({.radius = R, .core_cells = 16, .rings = 2}));
  CurvatureSurfaceTension flat{};
  flat.initialize(ring.cloud, ring.fields());
  flat.apply(ring.fields(), 0.0);
  for (const Index i : FacetSurface<2>(ring.cloud).nodes) CHECK(flat.curvatures[i] * R == Close{1.0, 2e-3});
  // Away from the sphere: net force and torque small but not zero; energy balance closes by the external power.
  auto body = rough_ball(8, 2, 0.0);
  CurvatureSurfaceTension term{};
  term.initialize(body.cloud, body.fields());
  const TermEnergy e = term.apply(body.fields(), 0.0);
  const double power = body.power();
  const double net = body.total_force().norm() / body.force_scale();
  const double torque = body.total_torque().norm() / (body.force_scale() * 5.0 * um);
  MESSAGE("ellipsoid: net force ", net, ", net torque ", torque);
  CHECK(net < 0.02);
  CHECK(torque < 0.02);
  CHECK(power == Close{energy_release(term, body, 1e-3 * um) + e.external_power, 1e-9});
  SurfaceTension variational{};
  variational.initialize(body.cloud, body.fields());
  CHECK(variational.apply(body.fields(), 0.0).potential == Close{e.potential, 1e-14});
}

TEST_CASE("pressure: gradient of p V, no net force or torque, virial, open surface") {
  const auto body3 = rough_ball(4, 2, 0.4 * um);
  const auto body2 = rough_circle(0.3 * um);
  check_conservative(AmbientPressure{.pressure = 100.0}, body3, 1e-9);
  check_conservative(AmbientPressure{.pressure = -30.0}, body2, 1e-9);
  auto body = body3;
  AmbientPressure term{.pressure = 100.0};
  term.initialize(body.cloud, body.fields());
  const double potential = term.apply(body.fields(), 0.0).potential;
  CHECK(potential == Close{100.0 * enclosed_volume(body), 1e-12});
  CHECK(body.virial() == Close{-3.0 * potential, 1e-12});
  // Without the top of a box: the force is that on the remaining facets, and its power is external.
  TestBody<3> box_body(box({.size = Point<3>(2 * um, 3 * um, um), .cells = {2, 3, 2}}));
  std::erase_if(box_body.cloud.facets, [&](const auto& f) {
    return std::all_of(f.begin(), f.end(), [&](Index i) { return box_body.reference[i].z() > 0.99 * um; });
  });
  box_body.random_velocities(1.0, 4);
  term.initialize(box_body.cloud, box_body.fields());
  const TermEnergy e = term.apply(box_body.fields(), 0.0);
  CHECK(box_body.total_force().z() == Close{100.0 * 6.0 * um * um, 1e-12});
  CHECK(e.potential == 0.0);
  CHECK(e.external_power == Close{box_body.power(), 1e-12});
}

TEST_CASE("Young-Laplace: surface tension and an inner pressure of 2 sigma/R balance on a sphere") {
  const double R = 5.0 * um;
  TestBody<3> body(ball({.radius = R, .core_radius = 2.0 * um, .core_cells = 24, .shells = 1}));
  SurfaceTension tension{};
  AmbientPressure inside{.pressure = -2.0 * sigma / R};
  tension.initialize(body.cloud, body.fields());
  inside.initialize(body.cloud, body.fields());
  auto f = body.fields();
  tension.apply(f, 0.0);
  const double scale = body.force_scale();
  inside.apply(f, 0.0);
  CHECK(2.0 * sigma / R == Close{28.8, 1e-12});
  CHECK(std::abs(body.virial()) < 2e-3 * scale * R);
  CHECK(body.force_scale() < 0.05 * scale);
}

TEST_CASE("body force: constant with its energy, field with its power, dimension, parameters") {
  auto body = rough_ball(2, 1, 0.3 * um);
  BodyForce gravity{.acceleration = Vector3(1.0, 2.0, -9.81)};
  gravity.initialize(body.cloud, body.fields());
  const TermEnergy e = gravity.apply(body.fields(), 0.0);
  double mass = 0.0;
  for (const double m : body.mass) mass += m;
  CHECK((body.total_force() - mass * Vector3(1.0, 2.0, -9.81)).norm() < 1e-14 * mass * 10.0);
  CHECK(e.external_power == 0.0);
  CHECK(body.power() == Close{energy_release(gravity, body, 1e-2 * um), 1e-9});
  BodyForce field{.acceleration = gravity_field};
  field.initialize(body.cloud, body.fields());
  const TermEnergy w = field.apply(body.fields(), 2.0);
  CHECK(w.potential == 0.0);
  CHECK(w.external_power == Close{body.power(), 1e-13});
  const Vector4 X = body.reference[5];
  CHECK((body.force[5] - body.mass[5] * Vector4(2.0 * X.y(), 1.0, 2.0, 0.0)).norm() < 1e-14 * body.mass[5]);
  auto plane = rough_circle(0.0);
  gravity.initialize(plane.cloud, plane.fields());
  gravity.apply(plane.fields(), 0.0);
  CHECK(plane.force[3][2] == 0.0);
  CHECK(plane.force[3][1] == 2.0 * plane.mass[3]);
  CHECK_THROWS_AS(BodyForce{.acceleration = Vector3(0, std::nan(""), 0)}.validate(), ParameterError);
  CHECK_THROWS_AS(SurfaceTension{.tension = -1.0}.validate(), ParameterError);
  CHECK_THROWS_AS(SurfaceTension{.smoothing = 1.0}.validate(), ParameterError);
  CHECK_THROWS_AS(CurvatureSurfaceTension{.tension = -1.0}.validate(), ParameterError);
  CHECK_THROWS_AS(AmbientPressure{.pressure = INFINITY}.validate(), ParameterError);
}

TEST_CASE("stiffness rates bound the largest eigenvalue; same bits for one and two threads") {
  auto body = rough_ball(2, 1, 0.2 * um);
  const auto largest = [&](auto term) {
    term.initialize(body.cloud, body.fields());
    const Field x = body.position;
    const double bound = term.stiffness_rate(body.fields());
    Field v = body.velocity;
    double omega2 = 0.0;
    for (int iteration = 0; iteration < 300; ++iteration) {  // power iteration of M⁻¹K by differences of the force
      const double h = 1e-4 * um;
      for (std::size_t i = 0; i < x.size(); ++i) body.position[i] = x[i] + h * v[i];
      term.apply(body.fields(), 0.0);
      const Field plus = body.force;
      for (std::size_t i = 0; i < x.size(); ++i) body.position[i] = x[i] - h * v[i];
      term.apply(body.fields(), 0.0);
      double norm = 0.0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        v[i] = (body.force[i] - plus[i]) / (2.0 * h * body.mass[i]);
        norm += v[i].squaredNorm() * body.mass[i];
      }
      omega2 = std::sqrt(norm);
      for (auto& w : v) w /= omega2;
      double unit = 0.0;
      for (std::size_t i = 0; i < x.size(); ++i) unit += v[i].squaredNorm() * body.mass[i];
      for (auto& w : v) w /= std::sqrt(unit);
    }
    body.position = x;
    return std::pair(bound, omega2);
  };
  const auto [bound, omega2] = largest(SurfaceTension{});
  MESSAGE("surface tension: bound ", bound, " of omega^2 ", omega2);
  CHECK(bound >= omega2);
  CHECK(bound < 20.0 * omega2);
  const auto [pressure_bound, pressure_omega2] = largest(AmbientPressure{.pressure = 100.0});
  CHECK(pressure_bound >= pressure_omega2);
  const int threads = thread_count();
  const auto run = [&](int count) {
    set_thread_count(count);
    auto f = body.fields();
    SurfaceTension a{};
    CurvatureSurfaceTension b{};
    AmbientPressure c{.pressure = 10.0};
    a.initialize(body.cloud, f), b.initialize(body.cloud, f), c.initialize(body.cloud, f);
    a.apply(f, 0.0), b.apply(f, 0.0), c.apply(f, 0.0);
    return body.force;
  };
  const Field one = run(1), two = run(2);
  set_thread_count(threads);
  CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(Vector4)) == 0);
}

}  // namespace boundary_test
