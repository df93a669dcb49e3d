// Implicit steps: the formula and its solvers on small systems.
#include <cmath>
#include <random>

#include <Eigen/LU>

#include <doctest/doctest.h>

#include <tactoid/integrator/gmres.hpp>
#include <tactoid/integrator/implicit_dynamics.hpp>

#include "relative.hpp"

using namespace tactoid;
using tactoid::test::relative;

namespace {

/// Masses on springs: M z̈ + c ż + k (z + b z³) = 0 for each unknown, as the system and its problem in one.
struct Oscillators {
  Eigen::VectorXd mass, damping, stiffness, z, rate;
  double cubic = 0.0, now = 0.0;

  // The problem.
  [[nodiscard]] Eigen::Index size() const { return z.size(); }
  void state(Eigen::VectorXd& to_z, Eigen::VectorXd& to_rate) const { to_z = z, to_rate = rate; }
  [[nodiscard]] Eigen::VectorXd scale() const { return Eigen::VectorXd::Ones(z.size()); }
  [[nodiscard]] double first_time_step() const { return 1e-3; }
  [[nodiscard]] double time() const { return now; }
  void prescribe(double, Eigen::VectorXd&) {}
  bool residual(const Eigen::VectorXd& at, const Eigen::VectorXd& v, const Eigen::VectorXd& a, double, Eigen::VectorXd& R) {
    last = at;
    R = mass.cwiseProduct(a) + damping.cwiseProduct(v) + stiffness.cwiseProduct(at + cubic * at.cwiseProduct(at).cwiseProduct(at));
    return true;
  }
  [[nodiscard]] Eigen::SparseMatrix<double> tangent(double rate_factor, double acceleration_factor, double) const {
    const Eigen::VectorXd diagonal = acceleration_factor * mass + rate_factor * damping +
                                     stiffness.cwiseProduct(Eigen::VectorXd::Ones(z.size()) + 3.0 * cubic * last.cwiseProduct(last));
    return Eigen::SparseMatrix<double>(Eigen::MatrixXd(diagonal.asDiagonal()).sparseView());
  }
  void accept(const Eigen::VectorXd& at, const Eigen::VectorXd& v, const Eigen::VectorXd&, double dt) {
    z = at, rate = v, now += dt;
  }
  Eigen::VectorXd last;

  // The system.
  Oscillators& implicit_problem() { return *this; }
};

Oscillators one(double mass, double damping, double stiffness, double z, double rate = 0.0) {
  Oscillators o;
  o.mass = Eigen::VectorXd::Constant(1, mass);
  o.damping = Eigen::VectorXd::Constant(1, damping);
  o.stiffness = Eigen::VectorXd::Constant(1, stiffness);
  o.z = Eigen::VectorXd::Constant(1, z);
  o.rate = Eigen::VectorXd::Constant(1, rate);
  return o;
}

template <class System>
void run(System& system, ImplicitDynamics integrator, double until) {
  integrator.initialize(system);
  while (system.now < until * (1.0 - 1e-12)) integrator.step(system, until);
}

}  // namespace

TEST_CASE("GMRES solves systems that are not symmetric, with restarts too") {
  std::mt19937 engine(1);
  std::normal_distribution<double> normal;
  const int n = 80;
  Eigen::MatrixXd A = 12.0 * Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd b(n);
  for (int i = 0; i < n; ++i) {
    b[i] = normal(engine);
    for (int j = 0; j < n; ++j) A(i, j) += normal(engine);
  }
  const Eigen::VectorXd exact = A.partialPivLu().solve(b);
  for (const int restart : {60, 12}) {
    const auto solution = gmres([&](const Eigen::VectorXd& x) { return Eigen::VectorXd(A * x); }, b, 1e-10, 2000, restart);
    CHECK(solution.converged);
    CHECK((solution.x - exact).norm() <= 1e-8 * exact.norm());
    CHECK((b - A * solution.x).norm() <= 1.1e-10 * b.norm());
  }
  // Exact after as many iterations as there are different eigenvalues.
  const Eigen::VectorXd two = Eigen::VectorXd::LinSpaced(n, 0.0, 1.0).unaryExpr([](double x) { return x < 0.5 ? 1.0 : 5.0; });
  const auto quick = gmres([&](const Eigen::VectorXd& x) { return Eigen::VectorXd(two.cwiseProduct(x)); }, b, 1e-12, 100);
  CHECK(quick.iterations == 2);
  CHECK((quick.x - b.cwiseQuotient(two)).norm() <= 1e-12 * b.norm());
  // Too few iterations: the best of them, and not converged.
  const auto few = gmres([&](const Eigen::VectorXd& x) { return Eigen::VectorXd(A * x); }, b, 1e-10, 3);
  CHECK_FALSE(few.converged);
  CHECK(few.residual < 1.0);
  CHECK((b - A * few.x).norm() == relative(few.residual * b.norm()).epsilon(1e-10));
  CHECK(gmres([](const Eigen::VectorXd& x) { return x; }, Eigen::VectorXd::Zero(4).eval(), 1e-6, 5).converged);
}

TEST_CASE("Implicit steps are of second order: oscillation, decay without inertia, a stiff spring that is not linear") {
  for (const ImplicitSolver solver : {ImplicitSolver::newton_krylov, ImplicitSolver::direct}) {
    const auto error = [&](double dt, bool inertia) {
      ImplicitDynamics integrator{.inertia = inertia, .time_step = dt, .newton_tolerance = 1e-9, .solver = solver, .linear_tolerance = 1e-6};
      Oscillators o = inertia ? one(1.0, 0.2, 1.0, 0.3, 0.1) : one(1.0, 2.0, 1.0, 0.3);
      run(o, integrator, 2.0);
      if (!inertia) return std::abs(o.z[0] - 0.3 * std::exp(-1.0));
      const double w = std::sqrt(0.99);
      return std::abs(o.z[0] - std::exp(-0.2) * (0.3 * std::cos(2.0 * w) + (0.1 + 0.03) / w * std::sin(2.0 * w)));
    };
    for (const bool inertia : {true, false}) {
      const double coarse = error(0.02, inertia), fine = error(0.01, inertia);
      CHECK(coarse / fine == relative(4.0).epsilon(0.06));
      CHECK(fine < 2e-4);
    }
    // A Duffing spring against a run with steps that are fifty times shorter.
    const auto duffing = [&](double dt) {
      Oscillators o = one(1.0, 0.0, 1.0, 0.9);
      o.cubic = 2.0;
      run(o, {.time_step = dt, .newton_tolerance = 1e-9, .solver = solver, .linear_tolerance = 1e-6}, 1.0);
      return o.z[0];
    };
    const double exact = duffing(0.0002);
    CHECK((duffing(0.02) - exact) / (duffing(0.01) - exact) == relative(4.0).epsilon(0.06));
  }
}

TEST_CASE("Steps that change are of second order too, and the local error is what was asked for") {
  // A fixed pattern of steps, by events: 1, 1.7, 0.6, 1.1 times the mean.
  const auto error = [](int steps) {
    Oscillators o = one(1.0, 0.0, 1.0, 0.3);
    ImplicitDynamics integrator{.time_step = 1.0, .newton_tolerance = 1e-9, .linear_tolerance = 1e-7};
    integrator.initialize(o);
    const double mean = 2.0 / steps, pattern[] = {1.0, 1.7, 0.6, 0.7};
    double until = 0.0;
    for (int k = 0; k < steps; ++k) integrator.step(o, until += mean * pattern[k % 4]);
    return std::abs(o.z[0] - 0.3 * std::cos(until));
  };
  CHECK(error(80) / error(160) == relative(4.0).epsilon(0.1));

  // The error of a run with chosen steps falls with the tolerance (as its power 2/3), and so does the number of its steps.
  double before = 1.0;
  std::size_t steps_before = 0;
  for (const double tolerance : {1e-4, 1e-5, 1e-6}) {
    Oscillators o = one(1.0, 0.0, 1.0, 0.3);
    ImplicitDynamics integrator{.tolerance = tolerance, .newton_tolerance = 1e-9, .linear_tolerance = 1e-6};
    integrator.initialize(o);
    while (o.now < 6.0 * (1.0 - 1e-12)) integrator.step(o, 6.0);
    const double error_now = std::abs(o.z[0] - 0.3 * std::cos(6.0));
    CHECK(error_now < 0.4 * before);
    CHECK(error_now < 2.0 * std::pow(tolerance, 2.0 / 3.0));
    if (steps_before > 0) CHECK(static_cast<double>(integrator.report().steps) == relative(std::cbrt(10.0) * static_cast<double>(steps_before)).epsilon(0.25));
    before = error_now;
    steps_before = integrator.report().steps;
  }
}

TEST_CASE("Steps far above the stable one of explicit schemes decay") {
  // ω Δt = 10⁶: an explicit step is stable up to 2.
  Oscillators o = one(1.0, 0.0, 1e12, 0.3);
  ImplicitDynamics integrator{.time_step = 1.0};
  integrator.initialize(o);
  double largest = 0.0;
  for (int k = 1; k <= 30; ++k) {
    integrator.step(o, static_cast<double>(k));
    largest = std::max(largest, std::abs(o.z[0]));
  }
  CHECK(largest < 1e-6);
  // And of any length: energy stays below what it was at the start.
  for (const double step : {0.1, 1.0, 3.0, 100.0}) {
    Oscillators p = one(1.0, 0.0, 1.0, 0.3);
    ImplicitDynamics any{.time_step = step};
    any.initialize(p);
    const double start = 0.5 * 0.09;
    double energy = start;
    for (int k = 1; k <= 50; ++k) {
      any.step(p, step * k);
      const double now = 0.5 * (p.z[0] * p.z[0] + p.rate[0] * p.rate[0]);
      CHECK(now < 1.0001 * start);  // (BDF2 is stable in a norm of two instants, not from each to the next)
      energy = now;
    }
    CHECK(energy < 0.99 * start);
  }
}

TEST_CASE("A step that fails is repeated smaller, and tells why at the floor") {
  // Admissible only below 0.4: a wall that cannot be passed.
  struct Walled : Oscillators {
    bool residual(const Eigen::VectorXd& at, const Eigen::VectorXd& v, const Eigen::VectorXd& a, double dt, Eigen::VectorXd& R) {
      return at[0] < 0.4 && Oscillators::residual(at, v, a, dt, R);
    }
    Walled& implicit_problem() { return *this; }
  };
  Walled w{one(1.0, 0.0, 1.0, 0.0, 1.0)};
  ImplicitDynamics integrator{.first_time_step = 0.5, .min_time_step = 1e-3};
  integrator.initialize(w);
  std::string message;
  try {
    while (w.now < 2.0) integrator.step(w, 2.0);
  } catch (const ComputationError& e) {
    message = e.what();
  }
  CHECK(message.find("ImplicitDynamics found no step at t = 0.4") != std::string::npos);
  CHECK(message.find("inverted") != std::string::npos);
  CHECK(w.z[0] < 0.4);
  CHECK(w.z[0] > 0.39);
  CHECK(integrator.report().failed > 0);
  CHECK(integrator.report().rejected > 0);

  CHECK_THROWS_WITH_AS(ImplicitDynamics{.tolerance = 2.0}.validate(), doctest::Contains("ImplicitDynamics.tolerance = 2"), ParameterError);
  CHECK_THROWS_WITH_AS((ImplicitDynamics{.tolerance = 1e-6, .newton_tolerance = 1e-6}.validate()), doctest::Contains("a tenth of the tolerance"),
                       ParameterError);
  CHECK_THROWS_AS(ImplicitDynamics{.max_newton_iterations = 0}.validate(), ParameterError);
  CHECK_THROWS_AS(ImplicitDynamics{.linear_tolerance = 0.0}.validate(), ParameterError);
  CHECK_THROWS_AS(ImplicitDynamics{.max_time_step = 0.0}.validate(), ParameterError);
}
