#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <tactoid/core/parallel.hpp>

namespace tactoid {

/// What projected_conjugate_gradients found.
struct ConstrainedSolution {
  Eigen::VectorXd x;            ///< the solution
  Eigen::VectorXd multipliers;  ///< λ of K x + Nᵀ λ = f
  int iterations = 0;     ///< of the conjugate gradients
  double residual = 0.0;  ///< relative to that of the start, in the norm of the preconditioner
  /// How the iteration ended.
  enum class State {
    converged,      ///< the residual is below what was asked
    not_converged,  ///< within the iterations allowed
    indefinite,     ///< a direction of negative or no curvature: K is not positive definite where N x = 0
    dependent       ///< the rows of N are linearly dependent
  } state = State::not_converged;  ///< x and multipliers mean something only where converged
};

/// Solves K x + Nᵀ λ = f, N x = g for a symmetric K that is positive definite where N x = 0, without factorising K:
/// conjugate gradients in the null space of N, preconditioned by the diagonal D of K. Every residual is projected by
/// the small system N D⁻¹ Nᵀ, so the conditions hold to round-off all the way. N. I. M. Gould, M. E. Hribar and
/// J. Nocedal, SIAM J. Sci. Comput. 2001, 23, 1376. Both triangles of K are read. Same bits for any number of threads.
/// `Matrix` is an Eigen::SparseMatrix<double>; a template, so that programs that solve nothing do not compile it.
template <class Matrix>
[[nodiscard]] ConstrainedSolution projected_conjugate_gradients(const Matrix& K, const Matrix& N, const Eigen::VectorXd& f,
                                                                const Eigen::VectorXd& g, double tolerance, int max_iterations) {
  using State = ConstrainedSolution::State;
  ConstrainedSolution solution;
  const Eigen::VectorXd diagonal = K.diagonal();
  if (!(diagonal.minCoeff() > 0.0)) {
    solution.state = State::indefinite;
    return solution;
  }
  const Eigen::VectorXd inverse = diagonal.cwiseInverse();
  Eigen::SimplicialLDLT<Matrix> conditions;
  if (N.rows() > 0) {
    const Matrix small = N * inverse.asDiagonal() * N.transpose();
    conditions.compute(small);
    if (conditions.info() != Eigen::Success) {
      solution.state = State::dependent;
      return solution;
    }
  }
  // K is symmetric, so a row is a column: every thread adds up rows of its own.
  const auto multiply = [&](const Eigen::VectorXd& x) {
    Eigen::VectorXd y(x.size());
    parallel_for(static_cast<std::size_t>(x.size()), [&](std::size_t j) {
      double sum = 0.0;
      for (typename Matrix::InnerIterator it(K, static_cast<Eigen::Index>(j)); it; ++it)
        sum += it.value() * x[it.row()];
      y[static_cast<Eigen::Index>(j)] = sum;
    });
    return y;
  };
  const auto lambda = [&](const Eigen::VectorXd& right) {
    return N.rows() > 0 ? Eigen::VectorXd(conditions.solve(right)) : Eigen::VectorXd(Eigen::VectorXd::Zero(0));
  };
  // The part of a residual that no multiplier can balance.
  const auto project = [&](Eigen::VectorXd& r) { r -= N.transpose() * lambda(N * inverse.cwiseProduct(r)); };

  solution.x = inverse.cwiseProduct(N.transpose() * lambda(g));
  const Eigen::VectorXd imposed = multiply(solution.x);
  Eigen::VectorXd r = f - imposed;
  project(r);
  Eigen::VectorXd z = inverse.cwiseProduct(r), direction = z;
  double rho = r.dot(z);
  // Round-off of the forces (those of the conditions among them) that the residual is left over from: no iteration
  // gets below it.
  const double floor = 1e-30 * (f.cwiseAbs2().dot(inverse) + imposed.cwiseAbs2().dot(inverse));
  const double start = rho, goal = std::max(tolerance * tolerance * start, floor);
  while (rho > goal && solution.iterations < max_iterations) {
    const Eigen::VectorXd image = multiply(direction);
    const double curvature = direction.dot(image);
    if (!(curvature > 0.0)) {
      solution.state = State::indefinite;
      return solution;
    }
    const double step = rho / curvature;
    solution.x += step * direction;
    r -= step * image;
    project(r);
    z = inverse.cwiseProduct(r);
    const double next = r.dot(z);
    direction = z + (next / rho) * direction;
    rho = next;
    ++solution.iterations;
  }
  solution.residual = start > 0.0 ? std::sqrt(rho / start) : 0.0;
  if (rho <= goal) solution.state = State::converged;
  const Eigen::VectorXd rest = f - multiply(solution.x);
  solution.multipliers = lambda(N * inverse.cwiseProduct(rest));
  return solution;
}

}  // namespace tactoid
