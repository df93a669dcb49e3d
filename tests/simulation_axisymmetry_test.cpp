// Bodies of revolution, computed in their meridian section: the section stands for whole rings in volumes, surfaces,
// stresses, contact and the director.
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include <tactoid/boundary/all.hpp>
#include <tactoid/contact/all.hpp>
#include <tactoid/director/all.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/observe/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/all.hpp>
#include <tactoid/verify/patch_test.hpp>

#include "relative.hpp"
#include "surface_bodies.hpp"

namespace simulation_axisymmetry_test {

using namespace tactoid;
using test::Close;

namespace {

constexpr double pi = std::numbers::pi, radius = 5e-6;

PointCloud<2> half_circle(int core_cells = 8, int shells = 4) {
  return meridian(Ball{.radius = radius, .core_radius = 0.4 * radius, .core_cells = core_cells, .shells = shells});
}

/// A thick shell, radius a to b, from pole to pole.
PointCloud<2> shell(double a, double b, int through, int around) {
  PointCloud<2> cloud = rectangle({.size = {b - a, pi}, .cells = {through, around}, .origin = {a, 0.0}});
  for (Point<2>& X : cloud.positions) {
    const double latitude = X[1] - 0.5 * pi;  // south pole first, so that cells keep their orientation
    X = X[0] * Point<2>(std::cos(latitude), std::sin(latitude));
    if (X[0] < 1e-9 * b) X[0] = 0.0;
  }
  cloud.axisymmetric = true;
  return cloud;
}

Body<Rkpm<2>, NodalCentroids, Materials<NeoHookean, NeoHookean>> elastic_ball(PointCloud<2> cloud) {
  const NeoHookean law = NeoHookean::from_young(1e4, 0.3);
  return {"ball", std::move(cloud), Rkpm<2>{}, NodalCentroids{}, Materials{Region{"nucleus", law}, Region{"cytoplasm", law}}};
}

Vector3 smooth_motion(const Vector3& X) {
  const double r = X[0] / radius, z = X[1] / radius;
  return {0.1 * radius * r * (1.0 + 0.3 * z - 0.2 * r * r), radius * (0.1 * z + 0.05 * z * z - 0.1 * r * r), 0.0};
}

/// Places a body for tests of surfaces: a smooth axisymmetric motion.
void deform(test::TestBody<2>& body, double amplitude = 1.0) {
  for (std::size_t i = 0; i < body.position.size(); ++i)
    body.position[i] = body.reference[i] + amplitude * pad(smooth_motion(body.reference[i].head<3>()));
}

/// Largest error of the forces against central differences of an energy, over the largest force. Radial forces of
/// particles on the axis do not count: nothing moves there.
double gradient_error(test::TestBody<2>& body, const std::function<double()>& energy, const Field& forces) {
  double error = 0.0, size = 0.0;
  const double step = 1e-5 * radius;
  for (std::size_t i = 0; i < body.position.size(); ++i)
    for (int c = 0; c < 2; ++c) {
      if (c == 0 && body.reference[i][0] == 0.0) continue;
      const double x = body.position[i][c];
      body.position[i][c] = x + step;
      const double above = energy();
      body.position[i][c] = x - step;
      const double below = energy();
      body.position[i][c] = x;
      error = std::max(error, std::abs(forces[i][c] + (above - below) / (2.0 * step)));
      size = std::max(size, std::abs(forces[i][c]));
    }
  return error / size;
}

/// A rule made for planes.
struct WithoutRings : NodalCentroids {
  template <Kernel K>
  [[nodiscard]] PointTable build(const PointCloud<K::dimension>& cloud, const K& kernel) const {
    PointTable table = NodalCentroids::build(cloud, kernel);
    for (TableEntry& entry : table.entries) entry.gradient[2] = 0.0;
    return table;
  }
};

}  // namespace

TEST_CASE("A meridian section has the volume and the surface of the body of revolution") {
  // Of the polygon, exactly: by Pappus for a triangle, by frusta for the surface.
  PointCloud<2> frustum = rectangle({.size = {2e-6, 3e-6}, .cells = {3, 4}, .origin = {1e-6, 0.0}});
  for (Point<2>& X : frustum.positions) X[0] *= 1.0 + X[1] / 6e-6;  // walls from 1, 3 to 1.5, 4.5 µm
  frustum.axisymmetric = true;
  const auto cone = [](double below, double above, double h) { return pi * h / 3.0 * (below * below + below * above + above * above); };
  CHECK(volume(frustum) == test::relative(cone(3e-6, 4.5e-6, 3e-6) - cone(1e-6, 1.5e-6, 3e-6)).epsilon(1e-14));
  double nodal = 0.0;
  for (const auto& cell : nodal_cells(frustum)) nodal += cell.volume;
  CHECK(nodal == test::relative(volume(frustum)).epsilon(1e-14));
  const double walls = pi * (1e-6 + 1.5e-6) * std::hypot(3e-6, 0.5e-6) + pi * (3e-6 + 4.5e-6) * std::hypot(3e-6, 1.5e-6);
  const double ends = pi * (9e-12 - 1e-12) + pi * (4.5e-6 * 4.5e-6 - 1.5e-6 * 1.5e-6);
  CHECK(boundary_area(frustum) == test::relative(walls + ends).epsilon(1e-14));
  const FacetSurface<2> surface(frustum);
  double area = 0.0;
  for (const double a : surface.nodal_area) area += a;
  CHECK(area == test::relative(walls + ends).epsilon(1e-14));
  CHECK(surface.closed);

  const PointCloud<2> ball = half_circle(32, 16);
  CHECK(volume(ball) == test::relative(4.0 / 3.0 * pi * radius * radius * radius).epsilon(1e-3));
  CHECK(FacetSurface<2>(ball).closed);
  CHECK(FacetSurface<2>(ball).facets.size() < ball.facets.size());  // the axis is no surface
  for (const auto& facet : FacetSurface<2>(ball).facets) CHECK(ball.positions[facet[0]].norm() == test::relative(radius).epsilon(1e-12));

  const Disc paper{.radius = 15e-6, .height = 5e-6};
  const PointCloud<2> substrate = meridian(paper);
  CHECK(substrate.size() == 8 * (1 + 11 + 19));
  CHECK(volume(substrate) == test::relative(pi * 15e-6 * 15e-6 * 5e-6).epsilon(1e-14));
}

TEST_CASE("Meridian sections that make no sense are refused") {
  CHECK_THROWS_WITH_AS((void)meridian(Ball{.radius = 1.0, .core_radius = 0.5, .center = {1.0, 0.0, 0.0}}),
                       "meridian: Ball.center must be on the axis, x = y = 0.", ParameterError);
  CHECK_THROWS_AS((void)meridian(Ball{.radius = 1.0, .core_radius = 0.5, .core_cells = 5}), ParameterError);
  CHECK_THROWS_AS((void)meridian(Disc{.radius = 1.0, .height = 1.0, .origin = {0.0, 0.1, 0.0}}), ParameterError);
  PointCloud<2> beyond = rectangle({.size = {1.0, 1.0}, .cells = {2, 2}, .origin = {-0.1, 0.0}});
  beyond.axisymmetric = true;
  CHECK_THROWS_WITH_AS(validate(beyond), doctest::Contains("lies beyond the axis"), GeometryError);
  PointCloud<3> solid = box({.size = {1.0, 1.0, 1.0}, .cells = {2, 2, 2}});
  solid.axisymmetric = true;
  CHECK_THROWS_WITH_AS(validate(solid), doctest::Contains("only one of 2"), GeometryError);
  PointCloud<2> endless = rectangle({.size = {1.0, 1.0}, .cells = {3, 3}, .periodic = {true, false}});
  endless.axisymmetric = true;
  CHECK_THROWS_WITH_AS(validate(endless), doctest::Contains("periodic across its axis"), GeometryError);
  PointCloud<2> nearly = half_circle();
  for (Point<2>& X : nearly.positions)
    if (X[0] == 0.0) X[0] = 1e-22;
  CHECK_THROWS_WITH_AS(validate(nearly), doctest::Contains("so near the axis"), GeometryError);
  test::TestBody<2> ball(half_circle());
  RigidPlate<> across_nothing{.point = {0.0, 0.0, 0.0}, .normal = Vector3::UnitX()};
  CHECK_THROWS_WITH_AS(across_nothing.initialize(ball.cloud, ball.fields()), doctest::Contains("surface of revolution"), ParameterError);
  BodyForce<> outward{.acceleration = Vector3(1.0, 0.0, 0.0)};
  CHECK_THROWS_WITH_AS(outward.initialize(ball.cloud, ball.fields()), doctest::Contains("along its axis"), ParameterError);
  const auto compose = [] {
    return Body{"ball", half_circle(), Rkpm<2>{}, WithoutRings{}, Materials{Region{"nucleus", NeoHookean{}}, Region{"cytoplasm", NeoHookean{}}}};
  };
  CHECK_THROWS_WITH_AS((void)compose(), doctest::Contains("does not support axisymmetric clouds"), ParameterError);
}

TEST_CASE("Rings pass the patch test: stretch across and along the axis") {
  auto ball = elastic_ball(jitter(half_circle(), 0.1));
  double mass = 0.0;
  for (const double m : ball.masses()) mass += m;
  CHECK(mass == test::relative(1000.0 * volume(ball.cloud())).epsilon(1e-13));
  Tensor3 F = Tensor3::Identity();
  F(0, 0) = 1.1, F(1, 1) = 0.85;
  const PatchReport report = patch_test(ball, F);
  CHECK(report.displacement_error < 1e-10);
  CHECK(report.stress_error < 1e-10);
  F(0, 1) = 0.1;
  CHECK_THROWS_WITH_AS((void)patch_test(ball, F), doctest::Contains("must be diagonal"), ParameterError);

  // Gauss points integrate rational functions: only nearly, as in the plane.
  const NeoHookean law = NeoHookean::from_young(1e4, 0.3);
  Body sampled{"ball", half_circle(), Rkpm<2>{}, GaussCells<2>{}, Materials{Region{"nucleus", law}, Region{"cytoplasm", law}}};
  F(0, 1) = 0.0;
  const PatchReport nearly = patch_test(sampled, F);
  CHECK(nearly.displacement_error < 0.02);
}

TEST_CASE("The stress of rings is the gradient of their energy, and the stiffness that of the stress") {
  auto ball = elastic_ball(half_circle(4, 2));
  for (std::size_t i = 0; i < ball.size(); ++i)
    ball.displacement[i] = pad(smooth_motion(ball.table().particle_position[i].head<3>()));
  const auto forces = [&] {
    ball.force.assign(ball.size(), Vector4::Zero());
    const BodyTotals totals = ball.add_internal_forces(0.0, false);
    return std::pair(ball.force, totals.strain_energy + totals.stabilization_energy);
  };
  const Field force = forces().first;
  const StiffnessMatrix K = assemble_stiffness(ball);
  double force_error = 0.0, force_size = 0.0, stiffness_error = 0.0, stiffness_size = 0.0;
  const double step = 1e-6 * radius;
  for (std::size_t i = 0; i < ball.size(); ++i)
    for (int c = 0; c < 2; ++c) {
      const double u = ball.displacement[i][c];
      ball.displacement[i][c] = u + step;
      const auto [above, above_energy] = forces();
      ball.displacement[i][c] = u - step;
      const auto [below, below_energy] = forces();
      ball.displacement[i][c] = u;
      force_error = std::max(force_error, std::abs(force[i][c] + (above_energy - below_energy) / (2.0 * step)));
      force_size = std::max(force_size, std::abs(force[i][c]));
      for (std::size_t j = 0; j < ball.size(); ++j)
        for (int d = 0; d < 2; ++d) {
          const double k = K.coeff(static_cast<Eigen::Index>(2 * j) + d, static_cast<Eigen::Index>(2 * i) + c);
          stiffness_error = std::max(stiffness_error, std::abs(k + (above[j][d] - below[j][d]) / (2.0 * step)));
          stiffness_size = std::max(stiffness_size, std::abs(k));
        }
    }
  CHECK(force_error < 1e-7 * force_size);
  CHECK(stiffness_error < 1e-7 * stiffness_size);
}

TEST_CASE("Stress around the axis is that of the stretch u/R") {
  auto ball = elastic_ball(half_circle());
  for (std::size_t i = 0; i < ball.size(); ++i) {
    const Vector4 X = ball.table().particle_position[i];
    ball.displacement[i] = Vector4(0.2 * X[0], -0.1 * X[1], 0.0, 0.0);
  }
  Tensor3 F = Tensor3::Zero();
  F.diagonal() << 1.2, 0.9, 1.2;
  const Tensor3 exact = cauchy_from_piola(NeoHookean::from_young(1e4, 0.3).first_piola(F), F);
  for (const PointSample& sample : ball.sample_points()) {
    CHECK((sample.cauchy - exact).norm() < 1e-11 * exact.norm());
    CHECK(sample.J == test::relative(1.2 * 1.2 * 0.9).epsilon(1e-12));
  }
}

TEST_CASE("A thick sphere under pressure inside: Lame's solution, with the order of the method") {
  // u = A ρ + B/ρ², σ_ρρ = (3λ + 2μ) A − 4μ B/ρ³; σ_ρρ(a) = −p, σ_ρρ(b) = 0.
  const double a = 2e-6, b = 4e-6, p = 1e-3;  // so small that the strains are
  const NeoHookean law{.mu = 1e3, .lambda = 2e3};
  const double B = p * a * a * a * b * b * b / (4.0 * law.mu * (b * b * b - a * a * a));
  const double A = 4.0 * law.mu * B / (b * b * b) / (3.0 * law.lambda + 2.0 * law.mu);
  const auto error = [&](int through) {
    Body body{"shell", shell(a, b, through, 4 * through), Rkpm<2>{}, NodalCentroids{}, Materials{Region{"body", law}}};
    const auto equator = select(body.cloud(), [](const Point<2>& X) { return std::abs(X[1]) < 1e-12; });
    StaticProblem problem(body, {fixed(equator, {false, true, false})},
                          OnFacets{AmbientPressure{.pressure = p}, [&](const Point<2>& X) { return X.norm() < 1.000001 * a; }});
    StaticNewton{.tolerance = 1e-9}.solve(problem);
    double sum = 0.0, size = 0.0;
    for (std::size_t i = 0; i < body.size(); ++i) {
      const Vector3 X = body.table().particle_position[i].head<3>();
      const double rho = X.norm();
      const Vector3 exact = (A + B / (rho * rho * rho)) * X;
      sum += body.nodal_volumes()[i] * (body.displacement[i].head<3>() - exact).squaredNorm();
      size += body.nodal_volumes()[i] * exact.squaredNorm();
    }
    return std::sqrt(sum / size);
  };
  const double coarse = error(6), fine = error(12);
  CHECK(fine < 0.01);
  CHECK(std::log2(coarse / fine) > 1.7);
}

TEST_CASE("Surface tension and pressure on rings are gradients of area and volume") {
  test::TestBody<2> ball(half_circle());
  deform(ball);
  SurfaceTension tension{.tension = 0.5e-3};
  tension.initialize(ball.cloud, ball.fields());
  const auto of_tension = [&] { return tension.apply(ball.fields(), 0.0).potential; };
  (void)of_tension();
  CHECK(gradient_error(ball, of_tension, Field(ball.force)) < 1e-8);
  AmbientPressure pressure{.pressure = 300.0};
  pressure.initialize(ball.cloud, ball.fields());
  const auto of_pressure = [&] { return pressure.apply(ball.fields(), 0.0).potential; };
  (void)of_pressure();
  CHECK(gradient_error(ball, of_pressure, Field(ball.force)) < 1e-8);

  deform(ball, 0.0);
  CHECK(of_tension() == test::relative(0.5e-3 * boundary_area(ball.cloud)).epsilon(1e-13));
  CHECK(of_pressure() == test::relative(300.0 * volume(ball.cloud)).epsilon(1e-13));
}

TEST_CASE("The curvature of a sphere is 2/R in its meridian") {
  for (const int cells : {8, 32}) {
    test::TestBody<2> ball(half_circle(cells, cells / 2));
    CurvatureSurfaceTension tension{.tension = 1e-3};
    tension.initialize(ball.cloud, ball.fields());
    (void)tension.apply(ball.fields(), 0.0);
    for (const Index i : FacetSurface<2>(ball.cloud).nodes) {
      CHECK(tension.curvatures[i] * radius == test::relative(2.0).epsilon(0.4 / cells));
      CHECK(Vector4(tension.normals[i] - ball.reference[i] / radius).norm() < 0.5 / cells);
    }
  }
}

TEST_CASE("Contact of rings: the gradient of its energy, action and reaction along the axis") {
  test::TestBody<2> ball(meridian(
      Ball{.radius = radius, .core_radius = 0.4 * radius, .core_cells = 8, .shells = 4, .center = {0.0, 0.0, 0.97 * radius}}));
  test::TestBody<2> base(meridian(Disc{.radius = 2.0 * radius, .height = radius, .core_cells = 8, .rings = 8, .layers = 4}));
  const auto contact = [&](auto law) {
    law.template initialize<2>(ball.cloud, ball.fields(), base.cloud, base.fields());
    const auto energy = [&] {
      const ParticleFields a = ball.fields(), b = base.fields();
      return law.apply(a, b, 0.0).potential;
    };
    (void)energy();
    const Field on_ball = ball.force, on_base = base.force;
    double along = 0.0, size = 0.0;
    for (const Vector4& f : on_ball) along += f[1], size += std::abs(f[1]);
    for (const Vector4& f : on_base) along += f[1];
    CHECK(size > 0.0);
    CHECK(std::abs(along) < 1e-13 * size);
    CHECK(gradient_error(ball, energy, on_ball) < 1e-4);  // the curvature of the gap jumps where closest points meet corners
    CHECK(gradient_error(base, energy, on_base) < 1e-4);
  };
  contact(LigandReceptor{.range = 1e-6});
  contact(LigandReceptor{.range = 1e-6, .sampled = ContactSide::both});
  contact(VanDerWaals{.range = 5e-6, .reaction = true});

  // A flat block on a plate: the whole area presses.
  test::TestBody<2> block(meridian(Disc{.radius = 3e-6, .height = 2e-6, .core_cells = 4, .rings = 4, .layers = 3, .origin = {0.0, 0.0, 2e-6}}));
  OnRigid<RepulsiveWall, RigidPlane> plate{.law = {.penalty = 1e12}, .surface = {.point = {0.0, 0.1e-6, 0.0}, .normal = Vector3::UnitY()}};
  plate.initialize(block.cloud, block.fields());
  (void)plate.apply(block.fields(), 0.0);
  const double pressure = 1e12 * 0.1e-6, wall = 2.0 * pi * 3e-6;  // the wall dips in, and is sampled at two points of a facet
  CHECK(plate.force()[1] < -pressure * pi * 9e-12 * (1.0 - 1e-12));
  CHECK(plate.force()[1] > -pressure * (pi * 9e-12 + wall * 0.5e-6));
}

TEST_CASE("Current areas of rings follow the radius: the power of bonds per current area") {
  test::TestBody<2> ball(meridian(
      Ball{.radius = radius, .core_radius = 0.4 * radius, .core_cells = 8, .shells = 4, .center = {0.0, 0.0, 1.1 * radius}}));
  test::TestBody<2> base(meridian(Disc{.radius = 2.0 * radius, .height = radius, .core_cells = 8, .rings = 8, .layers = 4}));
  LigandReceptor bonds{.range = 1e-6, .area = ContactArea::current};
  bonds.initialize(ball.cloud, ball.fields(), base.cloud, base.fields());
  for (std::size_t i = 0; i < ball.velocity.size(); ++i) ball.velocity[i] = pad(smooth_motion(ball.reference[i].head<3>())) * 1e5;
  const Field start = ball.position;
  const auto at = [&](double time) {
    for (std::size_t i = 0; i < start.size(); ++i) ball.position[i] = start[i] + time * ball.velocity[i];
    return bonds.apply(ball.fields(), base.fields(), 0.0);
  };
  const double step = 1e-10;
  const double rise = (at(step).potential - at(-step).potential) / (2.0 * step);
  const TermEnergy now = at(0.0);
  double power = 0.0;
  for (std::size_t i = 0; i < start.size(); ++i) power += ball.force[i].dot(ball.velocity[i]);
  CHECK(rise == test::relative(now.external_power - power).epsilon(1e-5));
  CHECK(std::abs(now.external_power) > 0.01 * std::abs(rise));
}

TEST_CASE("Diffusion of a director around the axis") {
  // ∇² vanishes for h = X (radial), h = e_z × X (around), h = z e_z; for h = R² e_z it is 4, for h = R² e_R 3.
  const PointCloud<2> cloud = half_circle(16, 8);
  struct Laplacian {
    double largest = 0.0;           ///< of any component at a particle inside
    Vector3 mean = Vector3::Zero(); ///< away from the surface
  };
  const auto laplacian = [&](const std::function<Vector3(double, double)>& h) {
    Body body{"gel", cloud, Rkpm<2>{}, NodalCentroids{}, Materials{Region{"nucleus", NeoHookean{}}, Region{"cytoplasm", NeoHookean{}}},
              DirectorField<>{}, [&](const Vector3& X) { return h(X[0] / radius, X[1] / radius); }};
    body.force.assign(body.size(), Vector4::Zero());
    (void)body.add_internal_forces(0.0, false);
    const auto surface = on_boundary(cloud);
    Laplacian result;
    double weight = 0.0;
    for (std::size_t i = 0; i < body.size(); ++i) {
      const Vector3 flux = body.director_flux[i].head<3>() * radius * radius;
      if (cloud.positions[i].norm() < 0.7 * radius) result.mean += flux, weight += body.nodal_volumes()[i];
      if (!surface[i]) result.largest = std::max(result.largest, flux.cwiseAbs().maxCoeff() / body.nodal_volumes()[i]);
    }
    result.mean /= weight;
    return result;
  };
  CHECK(laplacian([](double r, double) { return Vector3(r, 0.0, 0.0); }).largest < 1e-10);
  CHECK(laplacian([](double r, double) { return Vector3(0.0, 0.0, r); }).largest < 1e-10);
  CHECK(laplacian([](double, double z) { return Vector3(0.0, z, 0.0); }).largest < 1e-10);
  const Vector3 along = laplacian([](double r, double) { return Vector3(0.0, r * r, 0.0); }).mean;
  const Vector3 outward = laplacian([](double r, double) { return Vector3(r * r, 0.0, 0.0); }).mean;
  const Vector3 around = laplacian([](double r, double) { return Vector3(0.0, 0.0, r * r); }).mean;
  CHECK(along[1] == test::relative(4.0).epsilon(0.01));
  CHECK(outward[0] == test::relative(3.0).epsilon(0.01));
  CHECK(around[2] == test::relative(3.0).epsilon(0.01));
}

TEST_CASE("A free ball of revolution breathes in tune, keeps its energy and stays on its axis") {
  // Lowest radial mode: tan x = x / (1 − x² c_L²/(4 c_T²)), x = ω R/c_L; at ν = 0.3, c_L²/c_T² = 3.5: x = 2.6726… by bisection.
  const NeoHookean law = NeoHookean::from_young(1e4, 0.3);
  const double longitudinal = std::sqrt((law.lambda + 2.0 * law.mu) / law.density), ratio = (law.lambda + 2.0 * law.mu) / law.mu;
  double low = 2.0, high = 3.0;
  const auto f = [&](double x) { return std::tan(x) * (1.0 - 0.25 * x * x * ratio) - x; };
  for (int k = 0; k < 60; ++k) (f(low) * f(0.5 * (low + high)) <= 0.0 ? high : low) = 0.5 * (low + high);
  const double period = 2.0 * pi * radius / (low * longitudinal);

  auto ball = elastic_ball(half_circle(12, 6));
  for (std::size_t i = 0; i < ball.size(); ++i) ball.displacement[i] = 1e-4 * ball.table().particle_position[i];
  Simulation simulation{Bodies{std::move(ball)}, Contacts{}, Boundaries{}, CentralDifference{.safety = 0.25}};
  const auto size = [&] {  // the amplitude of the stretch
    double sum = 0.0, weight = 0.0;
    const auto& body = simulation.body<0>();
    for (std::size_t i = 0; i < body.size(); ++i) {
      sum += body.masses()[i] * body.displacement[i].dot(body.table().particle_position[i]);
      weight += body.masses()[i] * body.table().particle_position[i].squaredNorm();
    }
    return sum / weight;
  };
  std::vector<double> crossings;
  double before = size(), time = 0.0;
  simulation.run(2.2 * period, every_steps(1, [&](auto& s) {
    const double now = size();
    if (before < 0.0 && now >= 0.0) crossings.push_back(time + (s.time() - time) * before / (before - now));
    before = now;
    time = s.time();
  }));
  REQUIRE(crossings.size() >= 2);
  CHECK(crossings[1] - crossings[0] == test::relative(period).epsilon(0.01));
  CHECK(simulation.ledger().error() < 1e-3);
  const auto& body = simulation.body<0>();
  double momentum = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (body.cloud().positions[i][0] == 0.0) CHECK(body.displacement[i][0] == 0.0);
    CHECK(body.displacement[i][2] == 0.0);
    momentum += body.masses()[i] * body.velocity[i][1];
    scale += body.masses()[i] * std::abs(body.velocity[i][1]);
  }
  CHECK(std::abs(momentum) < 1e-11 * scale);
  const Motion whole = motion<0>(simulation);
  CHECK(whole.center_of_mass[0] == 0.0);
  CHECK(whole.angular_momentum.norm() == 0.0);
  CHECK(std::abs(whole.center_of_mass[1]) < 1e-9 * radius);
}

}  // namespace simulation_axisymmetry_test
