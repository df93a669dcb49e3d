// Implicit steps of bodies: tangents against differences, creep and vibration against exact solutions and explicit steps,
// energy, prescribed motion, and the same bits for any number of threads and after a restart.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <tactoid/boundary/all.hpp>
#include <tactoid/contact/all.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/director/all.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/all.hpp>

#include "relative.hpp"

using namespace tactoid;
using tactoid::test::relative;

namespace {

constexpr double um = 1e-6;

/// A cube of gel on a slab with memory: everything that an implicit step has to do with.
auto cube_on_slab(const ImplicitDynamics& integrator, double tethers, double adhesion) {
  Body cube{"cube", box({.size = Point<3>(2.0 * um, 2.0 * um, 2.0 * um), .cells = {2, 2, 2}, .origin = Point<3>(-0.9 * um, -1.1 * um, 0.1 * um)}),
            Rkpm<3>{}, NodalCentroids{.fluid_modulus = 50.0},
            Materials{Region{"body", NematicGel<>{.viscosity = 0.05, .bulk_modulus = 1e4, .reference_pressure = 30.0, .director_elasticity = 1e-11, .activity = -500.0}}},
            DirectorField<>{.diffusivity = 1e-7}, RandomDirector({.seed = 3})};
  Body slab{"slab", box({.size = Point<3>(4.0 * um, 4.0 * um, 2.0 * um), .cells = {2, 2, 2}, .origin = Point<3>(-2.0 * um, -2.0 * um, -2.0 * um)}),
            Rkpm<3>{}, NodalCentroids{}, Materials{Region{"body", YangVisco<>{.a3 = 2e-6}}}};
  const auto bottom = select(slab.cloud(), [](const Point<3>& X) { return X[2] < -1.99 * um; });
  return Simulation{
      Bodies{std::move(cube), std::move(slab)},
      Contacts{between<0, 1>(TetheredBonds{.density = tethers, .stiffness = 1e-3, .rest_length = 0.09 * um, .capture_distance = 0.3 * um}),
               between<0, 1>(LigandReceptor{.bond_density = adhesion})},
      Boundaries{on<0>(SurfaceTension{}), on<1>(PrescribedMotion{bottom, [](const Vector3&, double t) { return Vector3(0.01 * t, 0.0, 0.0); }, {true, true, true}})},
      integrator};
}

/// A block of the residual's derivative, by differences; a state and rates away from rest.
struct Derivative {
  Eigen::MatrixXd exact, assembled;

  template <class Simulation>
  explicit Derivative(Simulation& simulation) {
    auto problem = simulation.implicit_problem();
    const double dt = 2e-7, rate_factor = 1.5 / dt;
    Eigen::VectorXd z, rate;
    problem.state(z, rate);
    const Eigen::VectorXd scale = problem.scale(), start = z;
    std::mt19937 engine(7);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (Eigen::Index i = 0; i < z.size(); ++i) z[i] += 0.01 * scale[i] * uniform(engine);
    problem.prescribe(dt, z);
    Eigen::VectorXd R(z.size()), up(z.size()), down(z.size());
    const auto evaluate = [&](const Eigen::VectorXd& at, Eigen::VectorXd& into) {
      const Eigen::VectorXd v = rate_factor * (at - start), a = rate_factor * v;
      REQUIRE(problem.residual(at, v, a, dt, into));
    };
    evaluate(z, R);
    assembled = Eigen::MatrixXd(problem.tangent(rate_factor, rate_factor * rate_factor, dt));
    exact.setZero(z.size(), z.size());
    Eigen::VectorXd prescribed = z;
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      Eigen::VectorXd moved = z;
      const double step = 1e-6 * scale[i];
      moved[i] = z[i] + step;
      prescribed = moved;
      problem.prescribe(dt, prescribed);
      if (prescribed != moved) {  // the unknown is held
        exact(i, i) = 1.0;
        continue;
      }
      evaluate(moved, up);
      moved[i] = z[i] - step;
      evaluate(moved, down);
      exact.col(i) = (up - down) / (2.0 * step);
    }
  }
  /// Largest difference in a block, over its largest entry.
  [[nodiscard]] double error(Eigen::Index row, Eigen::Index rows, Eigen::Index column, Eigen::Index columns) const {
    const auto a = exact.block(row, column, rows, columns), b = assembled.block(row, column, rows, columns);
    return (a - b).cwiseAbs().maxCoeff() / a.cwiseAbs().maxCoeff();
  }
};

constexpr double length = 10.0 * um;

/// A plane block that moves along x only, fixed at x = 0: uniaxial strain.
auto column_body(const YangVisco<>& law) {
  return Body{"column", rectangle({.size = Point<2>(length, 2.0 * um), .cells = {10, 2}}), Rkpm<2>{}, NodalCentroids{}, Materials{Region{"body", law}}};
}
std::vector<PrescribedMotion> guides(const PointCloud<2>& cloud) {
  return {fixed(select(cloud, [](const Point<2>& X) { return X[0] < 1e-9; })),
          fixed(select(cloud, [](const Point<2>& X) { return X[0] > 1e-9; }), {false, true, false})};
}
template <class Integrator, class Term>
auto column(const YangVisco<>& law, const Integrator& integrator, const Term& load) {
  auto body = column_body(law);
  const auto held = guides(body.cloud());
  return Simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{on<0>(load), on<0>(held[0]), on<0>(held[1])}, integrator};
}

template <class AnyBody>
double tip_of(const AnyBody& body) {
  double most = 0.0;
  for (const Vector4& u : body.displacement)
    if (std::abs(u[0]) > std::abs(most)) most = u[0];
  return most;
}
template <class Simulation>
double tip(Simulation& simulation) {
  return tip_of(simulation.template body<0>());
}

YangVisco<> without_memory() { return {.a1 = 0.0, .a2 = 0.0}; }

/// Of the elastic part, in equilibrium under a body force.
double static_tip(const Vector3& acceleration) {
  auto body = column_body(without_memory());
  StaticProblem problem{body, guides(body.cloud()), BodyForce<>{.acceleration = acceleration}};
  StaticNewton{}.solve(problem);
  return tip_of(body);
}

}  // namespace

TEST_CASE("The assembled tangent is the derivative of the residual") {
  // Bonds that hold: two steps with fast kinetics.
  auto bonded = cube_on_slab(ImplicitDynamics{.time_step = 1e-9}, 1e14, 0.0);
  bonded.run(2e-9);
  REQUIRE(bonded.contact<0>().bonds() > 0.0);
  const Derivative d(bonded);
  const Eigen::Index u = 3 * static_cast<Eigen::Index>(bonded.body<0>().size()), all = d.exact.rows(), slab = 2 * u;
  CHECK(d.error(0, u, 0, u) < 1e-7);              // gel, surface tension, bonds
  CHECK(d.error(u, u, u, u) < 1e-7);              // director
  CHECK(d.error(slab, all - slab, slab, all - slab) < 1e-7);  // solid with memory, damping of the stabilisation, bonds
  CHECK(d.error(0, u, slab, all - slab) < 1e-5);  // bonds
  CHECK(d.error(slab, all - slab, 0, u) < 1e-5);
  // What it leaves out is there: director and motion depend on each other.
  CHECK(d.exact.block(0, u, u, u).cwiseAbs().maxCoeff() > 0.0);
  CHECK(d.assembled.block(0, u, u, u).cwiseAbs().maxCoeff() == 0.0);

  // Around an axis: rings of gel, of their surface, of the director.
  Body ball{"ball", meridian(Ball{.radius = um, .core_radius = 0.5 * um, .core_cells = 2, .shells = 1, .core_region = "body", .shell_region = "body"}), Rkpm<2>{},
            NodalCentroids{.fluid_modulus = 50.0}, Materials{Region{"body", NematicGel<>{.viscosity = 0.05, .bulk_modulus = 1e4, .activity = -500.0}}},
            DirectorField<>{}, UniformDirector(Vector3(0.5, 1.0, 0.3))};
  Simulation section{Bodies{std::move(ball)}, Contacts{}, Boundaries{on<0>(SurfaceTension{.smoothing = 0.5})}, ImplicitDynamics{}};
  const Derivative rings(section);
  const Eigen::Index plane = 2 * static_cast<Eigen::Index>(section.body<0>().size()), turning = rings.exact.rows() - plane;
  CHECK(rings.error(0, plane, 0, plane) < 1e-7);
  CHECK(rings.error(plane, turning, plane, turning) < 1e-7);

  // Adhesion: in the motion of the points that are tried, and of the surface that they find.
  auto adhering = cube_on_slab(ImplicitDynamics{.time_step = 1e-9}, 1.0, 5e16);
  auto free_cube = cube_on_slab(ImplicitDynamics{.time_step = 1e-9}, 1.0, 0.0);
  const Derivative with(adhering), without(free_cube);
  const Eigen::MatrixXd contact = with.exact - without.exact, assembled = with.assembled - without.assembled;
  for (const auto& [row, rows] : {std::pair(Eigen::Index{0}, u), std::pair(slab, all - slab)})
    for (const auto& [column, columns] : {std::pair(Eigen::Index{0}, u), std::pair(slab, all - slab)}) {
      const auto block = contact.block(row, column, rows, columns);
      REQUIRE(block.cwiseAbs().maxCoeff() > 0.0);
      CHECK((block - assembled.block(row, column, rows, columns)).cwiseAbs().maxCoeff() < 1e-6 * block.cwiseAbs().maxCoeff());
    }
}

TEST_CASE("A bar creeps under a growing pull as the standard linear solid does, with steps far above the stable one") {
  // Small strain: modulus M∞ of the elastic part, and a branch A₁ − 2A₂ with the relaxation time A₃.
  const YangVisco<> law{.a3 = 50e-6};
  const double elastic = law.elastic.wave_speed() * law.elastic.wave_speed() * law.density, branch = law.bracket_at_rest();
  const double retardation = law.a3 * (elastic + branch) / elastic;
  const auto error = [&](double dt, const ImplicitSolver solver) {
    // On the particles of the end.
    const BodyForce pull{.acceleration = [&](const Vector3& X, double t) { return Vector3(X[0] > length - 1e-9 ? 1e3 * t / law.a3 : 0.0, 0.0, 0.0); }};
    auto simulation = column(law, ImplicitDynamics{.inertia = false, .time_step = dt, .newton_tolerance = 1e-11, .solver = solver}, pull);
    CHECK(dt > 200.0 * simulation.largest_stable_time_step());
    const auto& bar = simulation.body<0>();
    double mass = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < bar.size(); ++i)
      if (bar.table().particle_position[i][0] > length - 1e-9) mass += bar.masses()[i];
    const double strain_rate = mass * 1e3 / law.a3 / (2.0 * um) / elastic;  // of the elastic part alone
    // Away from the ends, where the strain is uniform across.
    const auto at = [&](double X) {
      double sum = 0.0, count = 0.0;
      for (std::size_t i = 0; i < bar.size(); ++i)
        if (std::abs(bar.table().particle_position[i][0] - X) < 1e-9) sum += bar.displacement[i][0], count += 1.0;
      return sum / count;
    };
    for (double t = 40e-6; t < 5.0 * law.a3; t += 40e-6) {
      simulation.run(t);
      const double lag = branch / (elastic + branch) * retardation * -std::expm1(-t / retardation);
      largest = std::max(largest, std::abs((at(7.0 * um) - at(3.0 * um)) / (4.0 * um * strain_rate * (t - lag)) - 1.0));
    }
    CHECK(simulation.ledger().kinetic == 0.0);
    return largest;
  };
  const double coarse = error(20e-6, ImplicitSolver::newton_krylov), fine = error(10e-6, ImplicitSolver::direct);
  CHECK(fine < 5e-3);
  CHECK(coarse / fine > 3.0);
}

TEST_CASE("A column vibrates as with explicit steps: second order, and damped only where steps are too long to see") {
  const YangVisco<> law = without_memory();
  // In the shape of its first mode, so that nothing is shorter than the steps.
  const BodyForce pulled{.acceleration = [](const Vector3& X, double) { return Vector3(1e5 * std::sin(0.5 * std::numbers::pi * X[0] / length), 0.0, 0.0); }};
  const double period = 4.0 * length / law.wave_speed(), end = 0.4 * period;
  auto explicit_steps = column(law, CentralDifference{.safety = 0.05}, pulled);
  explicit_steps.run(end);
  const double exact = tip(explicit_steps);
  const auto implicit_steps = [&](int steps) {
    auto simulation = column(law, ImplicitDynamics{.time_step = end / steps, .newton_tolerance = 1e-10}, pulled);
    simulation.run(end);
    CHECK(simulation.steps() == static_cast<std::size_t>(steps));
    CHECK(simulation.ledger().error() < 0.02);
    return tip(simulation);
  };
  const double coarse = implicit_steps(40) - exact, fine = implicit_steps(80) - exact;
  CHECK(std::abs(fine) < 2e-3 * std::abs(exact));
  CHECK(coarse / fine == relative(4.0).epsilon(0.2));

  // A thousand times the stable step: the static answer, at once.
  const BodyForce<> weight{.acceleration = Vector3(1e4, 0.0, 0.0)};
  auto long_steps = column(law, ImplicitDynamics{.time_step = 1000.0 * explicit_steps.largest_stable_time_step()}, weight);
  long_steps.run(30.0 * long_steps.integrator().time_step);
  CHECK(tip(long_steps) == relative(static_tip(weight.acceleration)).epsilon(1e-6));
  CHECK(long_steps.ledger().kinetic < 1e-12 * long_steps.ledger().strain);
}

TEST_CASE("Prescribed motion: the force that holds it relaxes, and does the work that is stored and dissipated") {
  const YangVisco<> law{.a3 = 20e-6};
  const double elastic = law.elastic.wave_speed() * law.elastic.wave_speed() * law.density, branch = law.bracket_at_rest();
  const auto pull = [&](double dt) {
    Body body{"block", rectangle({.size = Point<2>(10.0 * um, 2.0 * um), .cells = {5, 2}}), Rkpm<2>{}, NodalCentroids{}, Materials{Region{"body", law}}};
    // Uniform strain: u = 10⁻⁴ X t/T until T = 20 µs, then held.
    const auto all = select(body.cloud(), [](const Point<2>&) { return true; });
    Simulation simulation{Bodies{std::move(body)}, Contacts{},
                          Boundaries{on<0>(PrescribedMotion{all, [](const Vector3& X, double t) { return Vector3(1e-4 * X[0] * std::min(t / 20e-6, 1.0), 0.0, 0.0); }})},
                          ImplicitDynamics{.inertia = false, .time_step = dt}};
    simulation.run(20e-6);
    const double x = 20e-6 / law.a3;
    const double at_end = elastic + branch * (1.0 - std::exp(-x)) / x;  // stress over strain
    const auto stress = [&] { return simulation.body<0>().sample_points().front().cauchy(0, 0) / 1e-4; };
    CHECK(stress() == relative(at_end).epsilon(2e-3));
    simulation.run(60e-6);
    CHECK(stress() == relative(elastic + branch * (1.0 - std::exp(-x)) / x * std::exp(-2.0)).epsilon(2e-3));
    const Vector3 sum = simulation.essential<0>().reaction(0);
    CHECK(std::abs(sum[0]) < 1e-9 * 2.0 * um * 1e-4 * elastic);  // both ends in balance
    return simulation.ledger().defect() / simulation.ledger().strain;
  };
  const double coarse = pull(1e-6), fine = pull(0.5e-6);
  CHECK(std::abs(fine) < 5e-3);
  CHECK(std::abs(coarse / fine) > 1.8);
}

TEST_CASE("Everything on: implicit steps agree with explicit ones, in the first order of the kinetics of bonds") {
  const double end = 0.4e-6;
  // The same bodies under CentralDifference.
  auto copy = cube_on_slab(ImplicitDynamics{}, 1e14, 5e14);
  const auto bottom = select(copy.body<1>().cloud(), [](const Point<3>& X) { return X[2] < -1.99 * um; });
  Simulation explicit_steps{Bodies{std::move(copy.body<0>()), std::move(copy.body<1>())},
                            Contacts{between<0, 1>(copy.contact<0>()), between<0, 1>(copy.contact<1>())},
                            Boundaries{on<0>(SurfaceTension{}), on<1>(PrescribedMotion{bottom, [](const Vector3&, double t) { return Vector3(0.01 * t, 0.0, 0.0); }, {true, true, true}})},
                            CentralDifference{.safety = 0.1}};
  explicit_steps.run(end);
  const auto& a = explicit_steps.body<0>();
  const auto difference = [&](double longest) {
    auto implicit_steps = cube_on_slab(ImplicitDynamics{.tolerance = 1e-6, .max_time_step = longest, .newton_tolerance = 1e-8}, 1e14, 5e14);
    implicit_steps.run(end);
    CHECK(implicit_steps.ledger().error() < 0.02);
    CHECK(implicit_steps.contact<0>().bonds() == relative(explicit_steps.contact<0>().bonds()).epsilon(0.01));
    const auto& b = implicit_steps.body<0>();
    double largest = 0.0, off = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      largest = std::max(largest, a.displacement[i].norm());
      off = std::max(off, (a.displacement[i] - b.displacement[i]).norm());
      CHECK((a.director[i] - b.director[i]).norm() < 1e-3);
    }
    return off / largest;
  };
  const double coarse = difference(8e-9), fine = difference(4e-9);
  CHECK(fine < 0.02);
  CHECK(coarse / fine == relative(2.0).epsilon(0.3));
}

TEST_CASE("Incomplete factors precondition the same steps as whole ones") {
  const auto run = [](Preconditioner preconditioner) {
    auto simulation = cube_on_slab(ImplicitDynamics{.time_step = 4e-8, .newton_tolerance = 1e-9, .preconditioner = preconditioner}, 1e14, 5e14);
    simulation.run(4e-7);
    using Incomplete = detail::FactorizedInverse<Eigen::IncompleteLUT<double>>;
    CHECK((dynamic_cast<const Incomplete*>(simulation.integrator().past.inverse.get()) != nullptr) == (preconditioner == Preconditioner::incomplete));
    return std::pair(simulation.body<0>().displacement, simulation.integrator().report());
  };
  const auto [a, whole] = run(Preconditioner::factorization);
  const auto [b, part] = run(Preconditioner::incomplete);
  double largest = 0.0, off = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, a[i].norm());
    off = std::max(off, (a[i] - b[i]).norm());
  }
  CHECK(off < 1e-6 * largest);
  CHECK(part.factorizations > 0);
  CHECK(part.linear_iterations <= 2 * whole.linear_iterations);  // here the factors are nearly whole
}

TEST_CASE("Implicit runs: the same bits for any number of threads, and after a restart") {
  const auto compose = [] { return cube_on_slab(ImplicitDynamics{.first_time_step = 2e-8}, 1e14, 5e14); };
  auto whole = compose();
  SavedState saved;
  whole.run(1e-6, every_steps(1, [&](auto& s) { if (saved.empty() && s.time() >= 0.3e-6) saved = save_state(s); }));
  REQUIRE(!saved.empty());
  const int threads = thread_count();
  set_thread_count(threads == 1 ? 2 : 1);
  auto resumed = compose();
  restore_state(resumed, saved);
  resumed.run(1e-6);
  set_thread_count(threads);
  const SavedState first = save_state(whole), second = save_state(resumed);
  for (const auto& [name, array] : first) {
    INFO(name);
    CHECK(second.at(name) == array);
  }
}

TEST_CASE("A step that ends the run leaves the state before it") {
  // The first step is too long for the error that is asked for, and may not be shorter.
  auto simulation = cube_on_slab(ImplicitDynamics{.tolerance = 1e-8, .first_time_step = 1e-7, .min_time_step = 0.99e-7, .newton_tolerance = 1e-10}, 1e14, 5e14);
  const SavedState before = save_state(simulation);
  const Field director = simulation.body<0>().director;
  CHECK_THROWS_WITH_AS(simulation.run(1e-6), doctest::Contains("ImplicitDynamics found no step at t = 0 s: the local error asks for too short a step"),
                       ComputationError);
  CHECK(simulation.time() == 0.0);
  for (const Vector4& u : simulation.body<0>().displacement) CHECK(u.norm() == 0.0);
  for (const Vector4& v : simulation.particles<0>().velocity) CHECK(v.norm() == 0.0);
  CHECK(simulation.body<0>().director == director);
  CHECK(save_state(simulation).at("ledger/external_work") == before.at("ledger/external_work"));
}

TEST_CASE("Implicit steps refuse what they cannot do") {
  Body body{"block", rectangle({.size = Point<2>(2.0 * um, 2.0 * um), .cells = {2, 2}}), Rkpm<2>{}, GaussCells<2>{}, Materials{Region{"body", YangVisco<>{}}}};
  const auto left = select(body.cloud(), [](const Point<2>& X) { return X[0] < 1e-9; });
  CHECK_THROWS_WITH_AS((Simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{on<0>(fixed(left))}, ImplicitDynamics{}}),
                       doctest::Contains("Body \"block\": ImplicitDynamics takes prescribed motion (which a meridian section has on its axis) only where"), ParameterError);
}
