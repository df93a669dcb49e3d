#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/unsatisfied.hpp>
#include <tactoid/integrator/projected_conjugate_gradients.hpp>
#include <tactoid/integrator/sparse_solvers.hpp>

namespace tactoid {

/// An equilibrium problem with n unknowns u under m conditions N u = ū, at a fraction of its load.
///
///   void set_load(double fraction);                     loads and prescribed values from 0 (present state) to 1 (all)
///   bool evaluate();                                    forces at the present u; false where a point is inverted
///   const Eigen::VectorXd& forces();                    internal and external forces on the unknowns, N (n)
///   double force_scale();                               norm of the parts that `forces` is the sum of, N
///   Eigen::SparseMatrix<double> stiffness();            K = −∂(internal forces)/∂u (n × n)
///   const Eigen::SparseMatrix<double>& conditions();    N (m × n)
///   bool conditions_are_values();                       true: each row of N is a unit vector
///   Eigen::VectorXd defect();                           ū − N u (m)
///   double length();                                    size of the body, m: the scale of round-off in positions
///   void move(const Eigen::VectorXd& du);               u ← u + du
///   void set_multipliers(const Eigen::VectorXd&);       forces of the conditions, N (m): called at the end
template <class S>
concept EquilibriumProblem =
    requires(S& s, const Eigen::VectorXd& x) {
      s.set_load(1.0);
      { s.evaluate() } -> std::same_as<bool>;
      { s.forces() } -> std::convertible_to<Eigen::VectorXd>;
      { s.force_scale() } -> std::convertible_to<double>;
      { s.stiffness() } -> std::convertible_to<Eigen::SparseMatrix<double>>;
      { s.conditions() } -> std::convertible_to<Eigen::SparseMatrix<double>>;
      { s.conditions_are_values() } -> std::same_as<bool>;
      { s.defect() } -> std::convertible_to<Eigen::VectorXd>;
      { s.length() } -> std::convertible_to<double>;
      s.move(x);
      s.set_multipliers(x);
    } ||
    unsatisfied<
        "An EquilibriumProblem has set_load, evaluate, forces, force_scale, stiffness, conditions, "
        "conditions_are_values, defect, length, move and set_multipliers.">;

/// What a static solution took.
struct StaticReport {
  int load_steps = 0;          ///< taken
  int iterations = 0;          ///< over all load steps
  double residual = 0.0;       ///< unbalanced force over the scale of the forces, at the end
  bool factorized_lu = false;  ///< the matrix was not positive definite and symmetric
  int linear_iterations = 0;   ///< of the conjugate gradients, over all iterations
  /// The residual before each iteration of the last load step, and at its end: near the solution each is about the
  /// square of the one before.
  std::vector<double> residuals;
};

/// How the linear systems of Newton's method are solved.
enum class LinearSolver {
  direct,              ///< factorisation: any matrix, to round-off; time and memory grow fast in three dimensions
  conjugate_gradients  ///< projected_conjugate_gradients: large bodies; needs a symmetric, positive definite stiffness
};

/// Equilibrium by Newton's method with a consistent tangent, a backtracking line search and load steps. Conditions on
/// values are eliminated and the rest is solved by LDLᵀ (by LU where the matrix is not symmetric and positive
/// definite); conditions on an interpolated field are met by Lagrange multipliers, with LU. For large bodies
///   StaticNewton{.solver = LinearSolver::conjugate_gradients}
/// needs no factorisation, in either case. It throws ComputationError where the stiffness is not symmetric or not
/// positive definite (follower loads, buckling), and where it does not converge.
struct StaticNewton {
  double tolerance = 1e-11;  ///< unbalanced force over the scale of the forces; > 0
  int max_iterations = 30;   ///< per load step
  int load_steps = 1;        ///< equal parts in which loads and prescribed displacements are applied
  int max_cuts = 12;         ///< halvings of a Newton step that inverts a point or does not reduce the residual
  LinearSolver solver = LinearSolver::direct;  ///< of the linear systems
  double linear_tolerance = 1e-9;     ///< of the conjugate gradients, relative to the residual of the start; in (0, 1)
  int max_linear_iterations = 20000;  ///< of the conjugate gradients, per iteration of Newton's method

  /// Throws ParameterError for a parameter out of the range that is given beside it.
  void validate() const;

  /// Brings the problem to equilibrium under its full load. Throws ComputationError where that fails.
  template <EquilibriumProblem Problem>
  StaticReport solve(Problem& problem) const {
    validate();
    StaticReport report;
    for (int step = 1; step <= load_steps; ++step) {
      const double fraction = static_cast<double>(step) / load_steps;
      problem.set_load(fraction);
      solve_step(problem, fraction, report);
      ++report.load_steps;
    }
    return report;
  }

 private:
  struct Update {
    Eigen::VectorXd du, multipliers;
  };

  template <class Problem>
  void solve_step(Problem& problem, double fraction, StaticReport& report) const {
    if (!problem.evaluate()) fail(fraction, 0, 0.0, "a point is inverted before the first iteration");
    Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(problem.conditions().rows());
    double unbalanced = residual(problem, multipliers), last_step = 0.0;
    report.residuals.clear();
    for (int iteration = 0;; ++iteration) {
      const Eigen::VectorXd defect = problem.defect();
      const double scale = std::max(problem.force_scale(), multipliers.norm());
      report.residual = scale > 0.0 ? unbalanced / scale : 0.0;
      report.residuals.push_back(report.residual);
      // Forces are known to the round-off of the positions: a step below that is the last one.
      const bool settled = iteration > 1 && last_step <= 1e-13 * problem.length();
      if (iteration > 0 && (report.residual <= tolerance || settled) && small(defect, problem)) break;
      if (iteration == max_iterations)
        fail(fraction, iteration, report.residual,
             "the load step may be too large: use more StaticNewton.load_steps, or the "
             "body may be held too loosely (a rigid motion is left free) or buckle");
      const Update update = newton_update(problem, defect, fraction, iteration, report);
      double factor = 1.0;
      problem.move(update.du);
      bool sound = problem.evaluate();
      const bool conditions_move = !small(defect, problem);
      double next = sound ? residual(problem, update.multipliers) : 0.0;
      for (int cut = 0; cut < max_cuts; ++cut) {
        // Towards the end the residual is round-off, and need not fall.
        if (sound && (conditions_move || next <= unbalanced || report.residual < 1e3 * tolerance)) break;
        problem.move(-0.5 * factor * update.du);
        factor *= 0.5;
        sound = problem.evaluate();
        next = sound ? residual(problem, update.multipliers) : 0.0;
      }
      if (!sound) fail(fraction, iteration, report.residual, "a point is inverted: use more StaticNewton.load_steps");
      multipliers = update.multipliers;
      unbalanced = next;
      last_step = factor * update.du.cwiseAbs().maxCoeff();
      ++report.iterations;
    }
    problem.set_multipliers(
        problem.conditions_are_values() ? Eigen::VectorXd(-(problem.conditions() * problem.forces())) : multipliers);
  }

  /// Norm of the forces that nothing balances: on free unknowns, or beside those of the conditions.
  template <class Problem>
  static double residual(Problem& problem, const Eigen::VectorXd& multipliers) {
    const Eigen::SparseMatrix<double>& N = problem.conditions();
    Eigen::VectorXd r = problem.forces();
    if (problem.conditions_are_values())
      r -= N.transpose() * (N * r);
    else
      r += N.transpose() * multipliers;
    return r.norm();
  }

  template <class Problem>
  static bool small(const Eigen::VectorXd& defect, Problem& problem) {
    return defect.size() == 0 || defect.cwiseAbs().maxCoeff() <= 1e-13 * problem.length();
  }

  template <class Problem>
  Update newton_update(Problem& problem, const Eigen::VectorXd& defect, double fraction, int iteration,
                       StaticReport& report) const {
    const Eigen::SparseMatrix<double> K = problem.stiffness();
    const Eigen::SparseMatrix<double>& N = problem.conditions();
    Update update;
    bool solved = false;
    if (solver == LinearSolver::conjugate_gradients) {
      if (!symmetric(K))
        fail(fraction, iteration, report.residual,
             "the stiffness is not symmetric, and conjugate gradients need that: use LinearSolver::direct");
      ConstrainedSolution solution =
          projected_conjugate_gradients(K, N, problem.forces(), defect, linear_tolerance, max_linear_iterations);
      report.linear_iterations += solution.iterations;
      using State = ConstrainedSolution::State;
      switch (solution.state) {
        case State::converged: break;
        case State::not_converged:
          fail(fraction, iteration, report.residual,
               fmt::format("the conjugate gradients reached {:.1e} of their first residual in {} iterations: allow more "
                           "(StaticNewton.max_linear_iterations), or use LinearSolver::direct",
                           solution.residual, solution.iterations));
        case State::indefinite:
          fail(fraction, iteration, report.residual,
               "the stiffness is not positive definite, and conjugate gradients need that: a rigid motion is left "
               "free, or the body buckles; use more StaticNewton.load_steps, or LinearSolver::direct");
        case State::dependent:
          fail(fraction, iteration, report.residual,
               "the conditions are not independent for the interpolated field: prescribe fewer particles");
      }
      update.du = std::move(solution.x);
      update.multipliers = -solution.multipliers;
      if (problem.conditions_are_values()) update.multipliers.setZero();
      return update;
    }
    if (problem.conditions_are_values()) {
      update.multipliers.setZero(N.rows());
      update.du = N.transpose() * defect;
      const Eigen::VectorXd right = problem.forces() - K * update.du;
      // Unknowns that are not prescribed, in their order.
      std::vector<int> place(static_cast<std::size_t>(K.rows()), 0);
      for (Eigen::Index c = 0; c < N.outerSize(); ++c)
        for (Eigen::SparseMatrix<double>::InnerIterator it(N, c); it; ++it) place[static_cast<std::size_t>(c)] = -1;
      int free = 0;
      for (int& p : place)
        if (p == 0) p = free++;
      if (free == 0) return update;
      Eigen::SparseMatrix<double> reduce(free, K.rows());
      std::vector<Eigen::Triplet<double>> ones;
      for (std::size_t i = 0; i < place.size(); ++i)
        if (place[i] >= 0) ones.emplace_back(place[i], static_cast<int>(i), 1.0);
      reduce.setFromTriplets(ones.begin(), ones.end());
      const Eigen::SparseMatrix<double> A = reduce * K * reduce.transpose();
      Eigen::VectorXd x;
      solved = solve_linear(A, reduce * right, x, report);
      if (solved) update.du += reduce.transpose() * x;
    } else {
      // [K  s Nᵀ; s N  0] (du, −λ/s) = (f, s defect), s of the size of K so that pivots are comparable.
      const double s = K.diagonal().cwiseAbs().mean();
      const auto n = static_cast<int>(K.rows()), m = static_cast<int>(N.rows());
      std::vector<Eigen::Triplet<double>> entries;
      entries.reserve(static_cast<std::size_t>(K.nonZeros() + 2 * N.nonZeros()));
      for (Eigen::Index c = 0; c < K.outerSize(); ++c)
        for (Eigen::SparseMatrix<double>::InnerIterator it(K, c); it; ++it)
          entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(it.col()), it.value());
      for (Eigen::Index c = 0; c < N.outerSize(); ++c)
        for (Eigen::SparseMatrix<double>::InnerIterator it(N, c); it; ++it) {
          entries.emplace_back(n + static_cast<int>(it.row()), static_cast<int>(it.col()), s * it.value());
          entries.emplace_back(static_cast<int>(it.col()), n + static_cast<int>(it.row()), s * it.value());
        }
      Eigen::SparseMatrix<double> A(n + m, n + m);
      A.setFromTriplets(entries.begin(), entries.end());
      Eigen::VectorXd right(n + m), x;
      right.head(n) = problem.forces();
      right.tail(m) = s * defect;
      solved = solve_lu(A, right, x, report);
      if (solved) {
        update.du = x.head(n);
        update.multipliers = -s * x.tail(m);
      }
    }
    if (!solved || !update.du.allFinite())
      fail(fraction, iteration, report.residual,
           "the stiffness is singular: a rigid motion is left free, or modes are not "
           "seen by the quadrature");
    return update;
  }

  // Templates, so that programs that solve nothing do not compile the factorisations.
  template <class Matrix>
  static bool symmetric(const Matrix& A) {
    const Matrix transposed = A.transpose();
    return (A - transposed).norm() <= 1e-9 * A.norm();
  }

  template <class Matrix>
  static bool solve_linear(const Matrix& A, const Eigen::VectorXd& right, Eigen::VectorXd& x,
                           StaticReport& report) {
    if (symmetric(A))
      if (const auto inverse = factorize_cholesky(A)) {
        x = refined(*inverse, A, right);
        return true;
      }
    return solve_lu(A, right, x, report);
  }

  template <class Matrix>
  static bool solve_lu(const Matrix& A, const Eigen::VectorXd& right, Eigen::VectorXd& x, StaticReport& report) {
    report.factorized_lu = true;
    const auto inverse = factorize_lu(A);
    if (!inverse) return false;
    x = refined(*inverse, A, right);
    return true;
  }

  template <class Matrix>
  static Eigen::VectorXd refined(const LinearInverse& inverse, const Matrix& A, const Eigen::VectorXd& right) {
    Eigen::VectorXd x = inverse.apply(right);
    x += inverse.apply(right - A * x);
    return x;
  }

  [[noreturn]] static void fail(double fraction, int iteration, double residual,
                                const std::string& cause);
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/integrator/static_newton.ipp>
#endif
