#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <Eigen/SparseCore>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/unsatisfied.hpp>
#include <tactoid/integrator/gmres.hpp>
#include <tactoid/integrator/sparse_solvers.hpp>

namespace tactoid {

/// Equations in time that ImplicitDynamics solves: 0 = R(z, ż, z̈, t) for n unknowns z (displacements, directors), some of
/// them prescribed.
///
///   Eigen::Index size();                                the number n
///   void state(VectorXd& z, VectorXd& rate);            the present unknowns and their rates
///   VectorXd scale();                                   how large a change of each unknown is large (m; 1 for directors)
///   double first_time_step();                           a short one, s: an explicit scheme could take it
///   double time();                                      the present instant, s
///   void prescribe(double dt, VectorXd& z);             sets the prescribed unknowns at the end of a step
///   bool residual(z, rate, acceleration, dt, R);        R at the end of a step, zero where prescribed; false: not admissible
///   SparseMatrix tangent(double rate_factor, double acceleration_factor, double dt);
///                                                       dR/dz at the last residual with ż = rate_factor z + …, and the like; unit
///                                                       rows where prescribed. It may be incomplete (newton_krylov)
///   void accept(z, rate, acceleration, dt);             makes it the present state; with what the last residual was asked for
template <class P>
concept ImplicitProblem = requires(P& p, const Eigen::VectorXd& x, Eigen::VectorXd& y, double s) {
  { p.size() } -> std::convertible_to<Eigen::Index>;
  p.state(y, y);
  { p.scale() } -> std::convertible_to<Eigen::VectorXd>;
  { p.first_time_step() } -> std::convertible_to<double>;
  { p.time() } -> std::convertible_to<double>;
  p.prescribe(s, y);
  { p.residual(x, x, x, s, y) } -> std::same_as<bool>;
  { p.tangent(s, s, s) } -> std::convertible_to<Eigen::SparseMatrix<double>>;
  p.accept(x, x, x, s);
} || unsatisfied<"An ImplicitProblem has size, state, scale, first_time_step, time, prescribe, residual, tangent and accept.">;

/// How the linear systems of an implicit step are solved.
enum class ImplicitSolver {
  /// GMRES with derivatives of the residual in the direction that is asked for: everything is in them, also what has no tangent
  /// (own contacts, the coupling of director and motion). The assembled tangent, factorised and kept over many steps, preconditions.
  newton_krylov,
  /// Newton's method with the assembled tangent, factorised in every iteration: quadratic where the tangent is complete.
  direct
};

/// What newton_krylov takes for the inverse of the assembled tangent.
enum class Preconditioner {
  factorization,  ///< LU: few iterations; time and memory grow fast in three dimensions
  incomplete      ///< incomplete LU with threshold: large bodies
};

/// What implicit steps took since the start.
struct ImplicitReport {
  std::size_t steps = 0;              ///< accepted
  std::size_t rejected = 0;           ///< repeated for their local error
  std::size_t failed = 0;             ///< repeated because Newton's method failed
  std::size_t newton_iterations = 0;  ///< in all attempts
  std::size_t linear_iterations = 0;  ///< of GMRES
  std::size_t factorizations = 0;     ///< of tangents
  double smallest_step = std::numeric_limits<double>::infinity();  ///< accepted, s
  double largest_step = 0.0;                                       ///< accepted, s

  /// For checkpoints: all of it.
  template <class Archive>
  void state(Archive& archive) {
    archive("steps", steps);
    archive("rejected", rejected);
    archive("failed", failed);
    archive("newton_iterations", newton_iterations);
    archive("linear_iterations", linear_iterations);
    archive("factorizations", factorizations);
    archive("smallest_step", smallest_step);
    archive("largest_step", largest_step);
  }
};

/// What ImplicitDynamics keeps from step to step.
struct ImplicitPast {
  Eigen::VectorXd z;                     ///< unknowns of the present state
  Eigen::VectorXd z_before;              ///< of the state before
  Eigen::VectorXd rate;                  ///< rates of the present state
  Eigen::VectorXd rate_before;           ///< of the state before
  double last_step = 0.0;                ///< between the two, s; 0 at the start
  double next_step = 0.0;                ///< that will be tried, s
  Eigen::SparseMatrix<double> matrix;    ///< a tangent
  std::shared_ptr<const LinearInverse> inverse;  ///< of `matrix`, whole or in part
  double factor_rate = 0.0;              ///< rate factor of `matrix`, 1/s
  int last_linear_iterations = 0;        ///< of GMRES
  ImplicitReport report;                 ///< since the start
  std::string cause;                     ///< why the last attempt failed
};

/// Implicit dynamics by the two-step backward differentiation formula with variable steps (BDF2),
///   v_{n+1} = [(1 + 2ω)/(1 + ω) u_{n+1} − (1 + ω) u_n + ω²/(1 + ω) u_{n−1}]/Δt,   ω = Δt/Δt₋,
/// the same for the acceleration from v and for the director; the first step is a backward Euler step (ω = 0). Of second order,
/// and, while the step does not change, stable for any step on linear problems (damped without limit in the stiffest modes), so that steps
/// follow what is to be resolved and not the waves. `inertia = false` is the overdamped limit, in which all forces balance at every instant: every
/// motion must then meet a viscous or elastic resistance (a body that nothing holds does not).
///
/// The step keeps the local error (the difference to a quadratic prediction: Milne's device) below `tolerance`; a step that
/// fails is repeated with a quarter. The energy that the scheme takes out of fast motions shows in the ledger's balance.
/// Histories of materials, directors, contacts and boundary terms are all taken at the positions of the end of the step. What contacts
/// remember (bonds) moves on once a step, when that is known, and contacts are told the time of its start until then: of first order.
///
/// Bodies with essential conditions need a value-based quadrature (NodalCentroids).
struct ImplicitDynamics {
  static constexpr bool synchronous = true;  ///< velocities belong to the end of the step

  bool inertia = true;             ///< false: overdamped
  double tolerance = 1e-4;         ///< local error per step in displacements, over the size of the body (and of directors); in (0, 1)
  double time_step = 0.0;          ///< fixed step, s; 0: chosen by the local error
  double first_time_step = 0.0;    ///< of a chosen step, s; 0: that of an explicit scheme
  double max_time_step = std::numeric_limits<double>::infinity();  ///< cap, s
  double min_time_step = 1e-15;    ///< floor, s: where a shorter step is needed the run stops
  double newton_tolerance = 1e-7;  ///< last correction of Newton's method, as `tolerance` is meant; > 0
  int max_newton_iterations = 12;  ///< per attempt
  int max_cuts = 4;                ///< halvings of a correction that inverts a point or does not help
  ImplicitSolver solver = ImplicitSolver::newton_krylov;          ///< of the linear systems
  Preconditioner preconditioner = Preconditioner::factorization;  ///< of newton_krylov
  double linear_tolerance = 1e-3;  ///< of GMRES, relative; in (0, 1)
  int max_linear_iterations = 120;  ///< of GMRES, per iteration of Newton's method
  int refresh_after = 25;          ///< iterations of GMRES from which on the preconditioner is made anew
  ImplicitPast past{};             ///< set by initialize() and by the steps

  /// Throws ParameterError for a parameter out of the range that is given beside it.
  void validate() const;

  /// Checks the parameters, and takes the present state as the first one.
  template <class System>
  void initialize(System& system) {
    validate();
    past = {};
    auto&& problem = system.implicit_problem();
    static_assert(ImplicitProblem<std::remove_reference_t<decltype(problem)>>, "The system of ImplicitDynamics has an implicit_problem() that is an ImplicitProblem.");
    problem.state(past.z, past.rate);
    past.z_before = past.z;
    past.rate_before = past.rate;
    past.last_step = 0.0;
    past.next_step = first_time_step > 0.0 ? first_time_step : problem.first_time_step();
  }

  /// One step, not beyond `until` (s). Throws ComputationError where no step above min_time_step succeeds; the state is then that
  /// before the step.
  template <class System>
  void step(System& system, double until) {
    auto&& problem = system.implicit_problem();
    const double remaining = until - problem.time();
    if (remaining <= 0.0) return;
    if (past.last_step == 0.0) {  // the state may have been changed since initialize()
      problem.state(past.z, past.rate);
      past.z_before = past.z;
      past.rate_before = past.rate;
    }
    const auto back = [&] {  // to where the step began
      Eigen::VectorXd ignored;
      (void)problem.residual(past.z, past.rate, Eigen::VectorXd::Zero(past.z.size()), 0.0, ignored);
    };
    past.cause.clear();
    double wanted = time_step;
    if (time_step == 0.0) {
      wanted = std::min(past.next_step, max_time_step);
      if (past.last_step > 0.0) wanted = std::min(wanted, largest_growth * past.last_step);
      wanted = std::max(wanted, min_time_step);  // events may have cut the last one
    }
    for (;;) {
      if (!(wanted >= min_time_step)) give_up(problem, wanted);
      double dt = remaining / std::max(1.0, std::ceil(remaining / wanted * (1.0 - 1e-12)));
      if (time_step > 0.0) dt = std::min(wanted, remaining);
      Attempt attempt;
      try {
        attempt = solve(problem, dt);
      } catch (...) {
        back();
        throw;
      }
      if (!attempt.converged) {
        ++past.report.failed;
        back();
        if (time_step > 0.0) give_up(problem, dt);
        wanted = 0.25 * dt;
        continue;
      }
      // Steps change by as much that the error is half of what is allowed: of the third power of the step, of the second in the first.
      const double ratio = attempt.error > 0.0 ? 0.5 * tolerance / attempt.error : std::numeric_limits<double>::infinity();
      const double share = past.last_step > 0.0 ? std::cbrt(ratio) : std::sqrt(ratio);
      if (time_step == 0.0 && attempt.error > tolerance) {
        ++past.report.rejected;
        back();
        past.cause.clear();
        wanted = std::clamp(share, 0.2, 0.9) * dt;
        continue;
      }
      problem.accept(attempt.z, attempt.rate, attempt.acceleration, dt);
      past.z_before = std::move(past.z);
      past.rate_before = std::move(past.rate);
      past.z = attempt.z;
      past.rate = attempt.rate;
      past.last_step = dt;
      // A step that changes little keeps its preconditioner.
      const double grown = std::min(share, largest_growth);
      past.next_step = grown > 1.2 || grown < 1.0 ? grown * dt : std::max(dt, std::min(past.next_step, grown * dt));
      ++past.report.steps;
      past.report.smallest_step = std::min(past.report.smallest_step, dt);
      past.report.largest_step = std::max(past.report.largest_step, dt);
      return;
    }
  }

  /// Goes on after particles were redistributed, between two steps: what is kept of the step before is carried to where they are now by
  /// `rows` (ReferenceUpdate::rows).
  template <class System>
  void carry_over(System& system, const std::vector<Eigen::SparseMatrix<double, Eigen::RowMajor>>& rows) {
    auto&& problem = system.implicit_problem();
    // Changes are carried, so that the corrections of momentum are in both instants.
    Eigen::VectorXd change = past.z - past.z_before, rate_change = past.rate - past.rate_before, z, ignored;
    problem.carry(rows, change);
    problem.carry(rows, past.rate);
    problem.carry(rows, rate_change);
    problem.take_velocities(past.rate);
    past.rate_before = past.rate - rate_change;
    problem.state(z, ignored);
    past.z = z;
    past.z_before = z - change;
  }

  /// What the steps took.
  [[nodiscard]] const ImplicitReport& report() const { return past.report; }

  /// For checkpoints: the step before, and the matrix of the preconditioner, so that a continued run takes the same iterations.
  template <class Archive>
  void state(Archive& archive) {
    const auto keep = [&](const char* name, Eigen::VectorXd& v) {
      std::vector<double> list(v.data(), v.data() + v.size());
      archive(name, list);
      v = Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
    };
    keep("unknowns", past.z);
    keep("unknowns_before", past.z_before);
    keep("rates", past.rate);
    keep("rates_before", past.rate_before);
    archive("last_step", past.last_step);
    archive("next_step", past.next_step);
    archive("factor_rate", past.factor_rate);
    archive("linear_iterations", past.last_linear_iterations);
    archive.part("report", past.report);
    std::vector<double> values(past.matrix.valuePtr(), past.matrix.valuePtr() + past.matrix.nonZeros());
    std::vector<int> rows(past.matrix.innerIndexPtr(), past.matrix.innerIndexPtr() + past.matrix.nonZeros());
    std::vector<int> columns;
    if (past.matrix.nonZeros() > 0) columns.assign(past.matrix.outerIndexPtr(), past.matrix.outerIndexPtr() + past.matrix.outerSize() + 1);
    if constexpr (Archive::restoring) values.clear(), rows.clear(), columns.clear();
    archive("matrix_values", values);
    archive("matrix_rows", rows);
    archive("matrix_columns", columns);
    if constexpr (Archive::restoring) {
      past.matrix.resize(0, 0);
      past.inverse.reset();
      if (!columns.empty()) {
        const auto n = static_cast<Eigen::Index>(columns.size()) - 1;
        past.matrix = Eigen::Map<const Eigen::SparseMatrix<double>>(n, n, static_cast<Eigen::Index>(values.size()), columns.data(), rows.data(), values.data());
        factorize(past.matrix);
      }
    }
  }

 private:
  static constexpr double largest_growth = 2.0;  // BDF2 with variable steps is stable below 1 + √2

  /// A step that was tried.
  struct Attempt {
    Eigen::VectorXd z, rate, acceleration;
    double error = 0.0;  // local, as `tolerance` is meant
    bool converged = false;
  };

  /// v_{n+1} = factor u_{n+1} + known, from the values at the two instants before.
  struct Formula {
    double factor, now, before;
    Formula(double dt, double last);
  };

  template <class Problem>
  Attempt solve(Problem& problem, double dt) {
    const Formula formula(dt, past.last_step);
    const Eigen::VectorXd scale = problem.scale();
    Attempt a;
    // Quadratic through the last two values and the last rate.
    a.z = past.z + dt * past.rate;
    if (past.last_step > 0.0) a.z += (dt * dt / (past.last_step * past.last_step)) * (past.z_before - past.z + past.last_step * past.rate);
    problem.prescribe(dt, a.z);
    const Eigen::VectorXd predicted = a.z;  // what is prescribed has no error
    const auto complete = [&](const Eigen::VectorXd& z, Eigen::VectorXd& rate, Eigen::VectorXd& acceleration) {
      rate = formula.factor * z + formula.now * past.z + formula.before * past.z_before;
      if (inertia) acceleration = formula.factor * rate + formula.now * past.rate + formula.before * past.rate_before;
      else acceleration = Eigen::VectorXd::Zero(z.size());
    };
    const auto residual = [&](const Eigen::VectorXd& z, Eigen::VectorXd& R) {
      Eigen::VectorXd rate, acceleration;
      complete(z, rate, acceleration);
      return problem.residual(z, rate, acceleration, dt, R) && R.allFinite();
    };
    Eigen::VectorXd R(past.z.size());
    if (!residual(a.z, R)) {
      // The prediction goes too far; where the step began is always admissible.
      a.z = past.z;
      problem.prescribe(dt, a.z);
      if (!residual(a.z, R)) return fail(a, "the prescribed motion of a step inverts a point");
    }
    const auto weighted = [&](const Eigen::VectorXd& x) { return x.cwiseQuotient(scale).cwiseAbs().maxCoeff(); };
    const auto refresh = [&] {
      past.matrix = problem.tangent(formula.factor, inertia ? formula.factor * formula.factor : 0.0, dt);
      past.matrix.makeCompressed();
      past.factor_rate = formula.factor;
      ++past.report.factorizations;
      return factorize(past.matrix);
    };
    const bool direct = solver == ImplicitSolver::direct;
    const double change = past.factor_rate > 0.0 ? formula.factor / past.factor_rate : 0.0;
    if (direct || !past.inverse || past.last_linear_iterations > refresh_after || !(change > 0.4 && change < 2.5))
      if (!refresh()) return fail(a, "the tangent is singular: a rigid motion is left free, or modes are not seen by the quadrature");
    Eigen::VectorXd correction = past.inverse->apply(-R);
    if (!correction.allFinite()) return fail(a, "the tangent is singular: a rigid motion is left free, or modes are not seen by the quadrature");
    double size = weighted(correction);
    const auto converged = [&] {
      complete(a.z, a.rate, a.acceleration);
      a.converged = true;
      a.error = local_error(dt, a.z - predicted, scale);
      return a;
    };
    if (size == 0.0) return converged();
    for (int iteration = 0; iteration < max_newton_iterations; ++iteration) {
      ++past.report.newton_iterations;
      Eigen::VectorXd delta = correction;
      if (!direct) {
        const auto solution = gmres(
            [&](const Eigen::VectorXd& y) {
              // The derivative of R in a direction, from a difference that is small against the body and large against round-off.
              const Eigen::VectorXd direction = y.cwiseProduct(scale);
              const double epsilon = 1e-7 / weighted(direction);
              Eigen::VectorXd moved(R.size());
              if (!residual(a.z + epsilon * direction, moved)) moved.setConstant(std::numeric_limits<double>::quiet_NaN());
              return Eigen::VectorXd(past.inverse->apply((moved - R) / epsilon).cwiseQuotient(scale));
            },
            correction.cwiseQuotient(scale), linear_tolerance, max_linear_iterations);
        past.report.linear_iterations += static_cast<std::size_t>(solution.iterations);
        past.last_linear_iterations = solution.iterations;
        if (solution.x.isZero(0.0) || !solution.x.allFinite()) return fail(a, "the linear system has no solution");
        delta = solution.x.cwiseProduct(scale);
      }
      const double moves = weighted(delta);
      double factor = 1.0, next = 0.0;
      Eigen::VectorXd z, next_R(R.size());
      bool better = false;
      for (int cut = 0; cut <= max_cuts && !better; ++cut, factor *= 0.5) {
        z = a.z + factor * delta;
        if (!residual(z, next_R)) continue;
        correction = past.inverse->apply(-next_R);
        if (!correction.allFinite()) continue;
        next = weighted(correction);
        better = next <= (1.0 - 0.25 * factor) * size || next <= newton_tolerance;
        if (better) break;
      }
      if (!better)
        return fail(a, "Newton's method does not converge: the state changes too much within a step, or a point is about to be inverted");
      a.z = z;
      R = next_R;
      size = next;
      if (size <= newton_tolerance || factor * moves <= 1e-2 * newton_tolerance) return converged();
      if (direct || past.last_linear_iterations > refresh_after) {
        if (!refresh()) return fail(a, "the tangent is singular");
        correction = past.inverse->apply(-R);
        size = weighted(correction);
      }
    }
    return fail(a, "Newton's method needs more than max_newton_iterations");
  }

  /// The part of the difference to the prediction that is the error of the formula.
  [[nodiscard]] double local_error(double dt, const Eigen::VectorXd& difference, const Eigen::VectorXd& scale) const;

  /// A template, so that programs without implicit steps do not compile factorisations.
  template <class Matrix>
  bool factorize(const Matrix& matrix) {
    const bool whole = solver == ImplicitSolver::direct || preconditioner == Preconditioner::factorization;
    past.inverse = whole ? factorize_lu(matrix) : factorize_incomplete(matrix);
    return past.inverse != nullptr;
  }

  Attempt fail(Attempt& attempt, const char* cause);

  template <class Problem>
  [[noreturn]] void give_up(Problem& problem, double dt) const {
    throw ComputationError(fmt::format("ImplicitDynamics found no step at t = {:.6g} s: {} (at a step of {:.3g} s{}).", problem.time(),
                                       past.cause.empty() ? "the local error asks for too short a step" : past.cause, dt,
                                       time_step > 0.0 ? ", which is fixed: try a shorter one" : ""));
  }
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/integrator/implicit_dynamics.ipp>
#endif
