// Essential conditions hold on the interpolated field, in statics and in motion, and their reactions are right.
#include <numbers>

#include <doctest/doctest.h>

#include <tactoid/boundary/body_force.hpp>
#include <tactoid/boundary/on_facets.hpp>
#include <tactoid/contact/on_rigid.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/modified_mooney_rivlin.hpp>
#include <tactoid/material/neo_hookean.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/all.hpp>

#include "relative.hpp"

namespace essential_test {

using namespace tactoid;

namespace {

constexpr double length = 2e-6, height = 1e-6;
const ModifiedMooneyRivlin law{};

template <class Quadrature, class Law = std::decay_t<decltype(law)>>
auto plate(Quadrature rule, Law of = law) {
  return Body{"plate", jitter(rectangle({.size = {length, height}, .cells = {10, 5}}), 0.15), Rkpm<2>{}, rule,
              Materials{Region{"body", of}}};
}
NodalCentroids undamped() {
  return {.solid_damping_time = 0.0};
}

std::vector<Index> side(const PointCloud<2>& cloud, int k, double at) {
  return select(cloud, [=](const Point<2>& X) { return std::abs(X[k] - at) < 1e-12; });
}

/// Left side held, right side pulled along x, top and bottom guided along x: uniaxial strain.
std::vector<PrescribedMotion> pull(const PointCloud<2>& cloud, double by) {
  std::vector<Index> guides = side(cloud, 1, 0.0);
  for (Index i : side(cloud, 1, height)) guides.push_back(i);
  return {
      fixed(side(cloud, 0, 0.0), {true, false, false}),
      {side(cloud, 0, length), [by](const Vector3&, double) { return Vector3(by, 0.0, 0.0); }, {true, false, false}},
      fixed(guides, {false, true, false})};
}

/// Largest error of the conditions at the particles, on the interpolated field, m.
template <class Body>
double error_of(const Body& body, const std::vector<PrescribedMotion>& motions, double time) {
  const Field u = body.at_particles(body.displacement);
  double error = 0.0;
  for (const PrescribedMotion& motion : motions)
    for (Index i : motion.particles)
      for (int c = 0; c < 2; ++c)
        if (motion.components[static_cast<std::size_t>(c)])
          error = std::max(
              error, std::abs(u[i][c] - motion.value(body.table().particle_position[i].template head<3>(), time)[c]));
  return error;
}

template <class Body>
void check_statics(Body body, double reaction_tolerance) {
  const double by = 0.2 * length;
  const auto motions = pull(body.cloud(), by);
  StaticProblem problem(body, motions);
  const StaticReport report = StaticNewton{.load_steps = 2}.solve(problem);
  CHECK(report.load_steps == 2);
  CHECK(error_of(body, motions, 0.0) < 1e-10 * by);
  Tensor3 F = Tensor3::Identity();
  F(0, 0) += by / length;
  const double force = law.first_piola(F)(0, 0) * height;
  CHECK(problem.reaction(1)[0] == test::relative(force).epsilon(reaction_tolerance));
  CHECK(std::abs(problem.reaction(0)[0] + problem.reaction(1)[0]) < 1e-9 * force);
  MESSAGE("static reaction over stress × area: " << problem.reaction(1)[0] / force << ", " << report.iterations
                                                 << " iterations");
}

template <class Body>
void check_motion(Body start) {
  const double size = 0.02 * length, period = 4.0 * length / law.wave_speed();
  const auto motions = [&] {
    const auto& cloud = start.cloud();
    std::vector<PrescribedMotion> list = {fixed(side(cloud, 0, 0.0)), {side(cloud, 0, length), {}, {true, true, true}}};
    list[1].displacement = [=](const Vector3&, double t) {
      const double phase = 2.0 * std::numbers::pi * t / period;
      return Vector3(size * (1.0 - std::cos(phase)), 0.5 * size * std::sin(phase), 0.0);
    };
    return list;
  }();
  Simulation simulation{Bodies{std::move(start)}, Contacts{}, Boundaries{on<0>(motions[0]), on<0>(motions[1])},
                        CentralDifference{.safety = 0.4}};
  const auto& body = simulation.template body<0>();
  const auto momentum = [&] {
    Vector3 p = Vector3::Zero();
    for (std::size_t i = 0; i < body.size(); ++i) p += body.masses()[i] * body.velocity[i].template head<3>();
    return p;
  };
  Vector3 before = momentum();
  double step_before = 0.0, error = 0.0, balance = 0.0, largest = 0.0;
  simulation.run(1.3 * period, every_steps(1, [&](auto& s) {
                   if (s.last_time_step() == 0.0 || s.time() >= 1.3 * period) return;
                   error = std::max(error, error_of(body, motions, s.time()));
                   const Vector3 now = momentum(), change = now - before;
                   const Vector3 force = s.template essential<0>().reaction(0) + s.template essential<0>().reaction(1);
                   const double interval = 0.5 * (step_before + s.last_time_step());
                   balance = std::max(balance, (change - interval * force).norm());
                   largest = std::max(largest, change.norm());
                   before = now;
                   step_before = s.last_time_step();
                 }));
  CHECK(simulation.steps() > 100);
  CHECK(error < 1e-10 * size);
  CHECK(largest > 0.0);
  CHECK(balance < 1e-9 * largest);
  // The work of the conditions is the energy that the body has.
  MESSAGE("moving boundary: error " << error / size << ", energy error " << simulation.ledger().error() << " in "
                                    << simulation.steps() << " steps");
  CHECK(simulation.ledger().error() < 2e-3);
}

}  // namespace

TEST_CASE("Statics: prescribed displacements and reactions, values at the particles") {
  check_statics(plate(undamped()), 1e-9);
}
TEST_CASE("Statics: prescribed displacements and reactions, coefficients") {
  check_statics(plate(GaussCells<2>{}), 0.03);
}
TEST_CASE("A moving boundary: values at the particles") {
  check_motion(plate(undamped()));
}
TEST_CASE("A moving boundary: coefficients") {
  check_motion(plate(GaussCells<2>{}));
}

TEST_CASE("A hanging bar: displacement and reaction under its weight") {
  Body body{"bar", bar({.length = length, .cells = 40}), Rkpm<1>{}, undamped(), Materials{Region{"body", law}}};
  const double g = 1e6, modulus = law.density * law.wave_speed() * law.wave_speed();
  const auto top = select(body.cloud(), [](const Point<1>& X) { return X[0] < 1e-12; });
  const auto end = select(body.cloud(), [](const Point<1>& X) { return X[0] > length - 1e-12; });
  StaticProblem problem(body, {fixed(top)}, BodyForce<>{.acceleration = Vector3(g, 0.0, 0.0)});
  const StaticReport report = StaticNewton{}.solve(problem);
  CHECK_FALSE(report.factorized_lu);
  CHECK(body.displacement[end[0]][0] ==
        test::relative(0.5 * law.density * g * length * length / modulus).epsilon(5e-3));
  CHECK(problem.reaction(0)[0] == test::relative(-law.density * g * length).epsilon(1e-9));
}

TEST_CASE("A block under a rigid plate: Newton's method with the stiffness of the contact") {
  // Gauss cells meet the uniform state approximately only.
  const auto press = [](auto rule, double allowed) {
    const double edge = 1e-6, depth = 0.3e-6, penalty = 1e4 * law.wave_speed() * law.wave_speed() * law.density / edge;
    Body body{"block", rectangle({.size = {edge, edge}, .cells = {5, 5}}), Rkpm<2>{}, rule, Materials{Region{"body", law}}};
    const auto at = [&](int k, double x) {
      return select(body.cloud(), [=](const Point<2>& X) { return std::abs(X[k] - x) < 1e-9 * edge; });
    };
    // Held at its sides so that it shortens uniformly: P(λ) = k (penetration), known from the law alone.
    auto sides = at(0, 0.0), right = at(0, edge);
    sides.insert(sides.end(), right.begin(), right.end());
    OnFacets plate{OnRigid<>{.law = {.penalty = penalty},
                             .surface = {.point = {0.0, edge - depth, 0.0}, .normal = -Vector3::UnitY()}},
                   [=](const Point<2>& X) { return X[1] > edge * (1.0 - 1e-9); }};
    StaticProblem problem(body, {fixed(sides, {true, false, false}), fixed(at(1, 0.0), {false, true, false})}, plate);
    const StaticReport report = StaticNewton{.max_iterations = 12}.solve(problem);
    CHECK(report.residual < 1e-9);
    const double force = problem.reaction(1)[1] / edge;  // of the floor: the plate pushes as much
    CHECK(problem.term_energy().potential == test::relative(0.5 * force * force / penalty * edge).epsilon(30.0 * allowed));
    Tensor3 F = Tensor3::Identity();
    F(1, 1) = 1.0 - depth / edge + force / penalty / edge;
    CHECK(force == test::relative(-law.first_piola(F)(1, 1)).epsilon(allowed));
    CHECK(force > 0.0);
    return report;
  };
  const StaticReport values = press(undamped(), 1e-8), coefficients = press(GaussCells<2>{}, 1e-3);
  MESSAGE("iterations " << values.iterations << " and " << coefficients.iterations);
  CHECK(values.iterations < 10);
  CHECK(coefficients.iterations < 10);
  // Nowhere: an error, not a term without effect.
  Body body{"block", rectangle({.size = {1e-6, 1e-6}, .cells = {4, 4}}), Rkpm<2>{}, undamped(), Materials{Region{"body", law}}};
  CHECK_THROWS_WITH_AS(StaticProblem(body, {}, OnFacets{OnRigid<>{}, [](const Point<2>&) { return false; }}),
                       doctest::Contains("no facet of the body satisfies"), GeometryError);
}

TEST_CASE("Statics that cannot succeed say why") {
  Body body{"bar", bar({.length = length, .cells = 10}), Rkpm<1>{}, undamped(), Materials{Region{"body", law}}};
  const auto top = select(body.cloud(), [](const Point<1>& X) { return X[0] < 1e-12; });
  const auto end = select(body.cloud(), [](const Point<1>& X) { return X[0] > length - 1e-12; });
  PrescribedMotion through{
      end, [](const Vector3&, double) { return Vector3(-1.5 * length, 0.0, 0.0); }, {true, true, true}};
  StaticProblem problem(body, {fixed(top), through});
  std::string message;
  try {
    StaticNewton{}.solve(problem);
  } catch (const ComputationError& error) {
    message = error.what();
  }
  CAPTURE(message);
  CHECK(message.find("StaticNewton found no equilibrium at 1 of the load") != std::string::npos);
  CHECK(message.find("iterations") != std::string::npos);
  CHECK_THROWS_WITH_AS(StaticNewton{.load_steps = 0}.validate(), doctest::Contains("StaticNewton.load_steps = 0"),
                       ParameterError);
  CHECK_THROWS_WITH_AS(StaticProblem(body, {fixed({99})}), doctest::Contains("particle 99 does not exist"),
                       ParameterError);
  CHECK_THROWS_WITH_AS(StaticProblem(body, {fixed(end), fixed(end)}), doctest::Contains("is prescribed twice"),
                       ParameterError);
}

namespace {

/// A law whose tangent stays positive definite under this pull; that of a nearly incompressible one does not.
const NeoHookean compressible = NeoHookean::from_young(1e4, 0.3);

/// Largest difference between the solutions by conjugate gradients and by factorisation, over the displacement.
template <class Body>
void check_solvers(const Body& start) {
  const double by = 0.2 * length;
  Body direct = start, iterative = start;
  StaticProblem first(direct, pull(direct.cloud(), by)), second(iterative, pull(iterative.cloud(), by));
  (void)StaticNewton{}.solve(first);
  const StaticReport report = StaticNewton{.solver = LinearSolver::conjugate_gradients}.solve(second);
  CHECK(report.linear_iterations > 10);
  CHECK_FALSE(report.factorized_lu);
  double difference = 0.0;
  for (std::size_t i = 0; i < direct.size(); ++i)
    difference = std::max(difference, (direct.displacement[i] - iterative.displacement[i]).norm());
  CHECK(difference < 1e-8 * by);
  CHECK(second.reaction(1)[0] == test::relative(first.reaction(1)[0]).epsilon(1e-8));
  // Newton's iteration is quadratic near the solution.
  REQUIRE(report.residuals.size() >= 3);
  CHECK(report.residuals.back() == report.residual);
}

}  // namespace

TEST_CASE("Conjugate gradients find what factorisation finds: values at the particles") {
  check_solvers(plate(undamped(), compressible));
}
TEST_CASE("Conjugate gradients find what factorisation finds: coefficients") {
  check_solvers(plate(GaussCells<2>{}, compressible));
}

TEST_CASE("Conjugate gradients that cannot succeed say why") {
  auto body = plate(undamped());
  const auto message = [&](const StaticNewton& newton, std::vector<PrescribedMotion> motions, auto... terms) {
    auto copy = body;
    StaticProblem problem(copy, std::move(motions), terms...);
    try {
      (void)newton.solve(problem);
    } catch (const ComputationError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const StaticNewton few{.solver = LinearSolver::conjugate_gradients, .max_linear_iterations = 3};
  CHECK(message(few, pull(body.cloud(), 0.1 * length)).find("in 3 iterations: allow more (StaticNewton.max_linear_iterations)") !=
        std::string::npos);
  CHECK_THROWS_WITH_AS((StaticNewton{.linear_tolerance = 0.0}.validate()), doctest::Contains("linear_tolerance = 0"),
                       ParameterError);
  CHECK_THROWS_WITH_AS((StaticNewton{.max_linear_iterations = 0}.validate()),
                       doctest::Contains("max_linear_iterations = 0"), ParameterError);
  // A matrix with a negative direction, and conditions given twice.
  Eigen::SparseMatrix<double> K(2, 2), N(0, 2);
  K.insert(0, 0) = 1.0;
  K.insert(1, 1) = 1.0;
  K.insert(0, 1) = 2.0;
  K.insert(1, 0) = 2.0;
  const Eigen::VectorXd f = Eigen::Vector2d(1.0, -1.0);
  using State = ConstrainedSolution::State;
  CHECK(projected_conjugate_gradients(K, N, f, Eigen::VectorXd(0), 1e-9, 10).state == State::indefinite);
  // Where the condition forbids that direction it is positive: x + y = … is free, x − y = 1 is prescribed.
  N.resize(1, 2);
  N.insert(0, 0) = 1.0;
  N.insert(0, 1) = -1.0;
  const auto held = projected_conjugate_gradients(K, N, f, Eigen::VectorXd::Ones(1), 1e-12, 10);
  CHECK(held.state == State::converged);
  CHECK((held.x - Eigen::Vector2d(0.5, -0.5)).norm() < 1e-12);
  CHECK((K * held.x + N.transpose() * held.multipliers - f).norm() < 1e-12);
}

}  // namespace essential_test
