#pragma once

#include <memory>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#ifdef TACTOID_WITH_SUITESPARSE
#include <Eigen/CholmodSupport>
#include <Eigen/UmfPackSupport>
#else
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#endif

/// The factorisations of implicit steps and of statics: Eigen's own, or those of SuiteSparse (UMFPACK and CHOLMOD, faster on
/// large systems, given a good BLAS) in a program that links tactoid::suitesparse, whole: its macro TACTOID_WITH_SUITESPARSE is the
/// same in all files. All functions are templates of the matrix, an
/// Eigen::SparseMatrix<double>, so that programs that solve nothing do not compile them.
namespace tactoid {

/// The inverse of a matrix, or an approximation of it.
struct LinearInverse {
  virtual ~LinearInverse() = default;
  /// Its product with x.
  [[nodiscard]] virtual Eigen::VectorXd apply(const Eigen::VectorXd& x) const = 0;
};

namespace detail {

template <class Solver>
struct FactorizedInverse final : LinearInverse {
  Solver solver;
  [[nodiscard]] Eigen::VectorXd apply(const Eigen::VectorXd& x) const override { return solver.solve(x); }
};

#ifdef TACTOID_WITH_SUITESPARSE
/// UMFPACK reads the matrix again when it solves.
template <class Matrix>
struct UmfPackInverse final : LinearInverse {
  Matrix matrix;
  Eigen::UmfPackLU<Matrix> solver;
  explicit UmfPackInverse(const Matrix& A) : matrix(A) {
    matrix.makeCompressed();
    solver.umfpackControl()[UMFPACK_IRSTEP] = 0;  // whoever needs it refines
    solver.compute(matrix);
  }
  [[nodiscard]] Eigen::VectorXd apply(const Eigen::VectorXd& x) const override { return solver.solve(x); }
};
#endif

}  // namespace detail

/// The inverse of a square matrix by its LU factors; null where it is singular.
template <class Matrix>
[[nodiscard]] std::shared_ptr<const LinearInverse> factorize_lu(const Matrix& A) {
#ifdef TACTOID_WITH_SUITESPARSE
  auto inverse = std::make_shared<detail::UmfPackInverse<Matrix>>(A);
#else
  auto inverse = std::make_shared<detail::FactorizedInverse<Eigen::SparseLU<Matrix>>>();
  inverse->solver.compute(A);
#endif
  if (inverse->solver.info() != Eigen::Success) return nullptr;
  return inverse;
}

/// The inverse of a symmetric matrix by its Cholesky factors; null where it is not positive definite.
template <class Matrix>
[[nodiscard]] std::shared_ptr<const LinearInverse> factorize_cholesky(const Matrix& A) {
#ifdef TACTOID_WITH_SUITESPARSE
  auto inverse = std::make_shared<detail::FactorizedInverse<Eigen::CholmodSupernodalLLT<Matrix>>>();
  inverse->solver.cholmod().print = 0;
  inverse->solver.compute(A);
  if (inverse->solver.info() != Eigen::Success) return nullptr;
#else
  auto inverse = std::make_shared<detail::FactorizedInverse<Eigen::SimplicialLDLT<Matrix>>>();
  inverse->solver.compute(A);
  if (inverse->solver.info() != Eigen::Success || !(inverse->solver.vectorD().minCoeff() > 0.0)) return nullptr;
#endif
  return inverse;
}

/// An approximation of the inverse by incomplete LU factors with a threshold; null where it breaks down.
template <class Matrix>
[[nodiscard]] std::shared_ptr<const LinearInverse> factorize_incomplete(const Matrix& A) {
  auto inverse = std::make_shared<detail::FactorizedInverse<Eigen::IncompleteLUT<double>>>();
  inverse->solver.setDroptol(1e-4);
  inverse->solver.setFillfactor(10);
  inverse->solver.compute(A);
  if (inverse->solver.info() != Eigen::Success) return nullptr;
  return inverse;
}

}  // namespace tactoid
