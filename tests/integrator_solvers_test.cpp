#include <cmath>

#include <doctest/doctest.h>

#include <tactoid/integrator/sparse_solvers.hpp>

#if defined(TACTOID_TEST_OF_SUITESPARSE) != defined(TACTOID_WITH_SUITESPARSE)
#error "The solvers of SuiteSparse are tested by the target that links tactoid::suitesparse."
#endif

namespace integrator_solvers_test {

using namespace tactoid;
using Matrix = Eigen::SparseMatrix<double>;

namespace {

/// −∇² + drift ∂/∂x on n × n points, by second-order differences; each value times a weight that varies over four decades.
Matrix transport(int n, double drift, bool scaled) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto weight = [&](int i) { return scaled ? std::pow(10.0, 4.0 * i / (n * n)) : 1.0; };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int i = y * n + x;
      const auto add = [&](int j, double value) { entries.emplace_back(i, j, value * weight(i)); };
      add(i, 4.0);
      if (x > 0) add(i - 1, -1.0 - drift);
      if (x + 1 < n) add(i + 1, -1.0 + drift);
      if (y > 0) add(i - n, -1.0);
      if (y + 1 < n) add(i + n, -1.0);
    }
  Matrix A(n * n, n * n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}
Eigen::VectorXd waves(Eigen::Index n) {
  return Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return std::sin(0.7 * double(i)) + 0.1; });
}

TEST_CASE("factors solve systems: LU any regular one, Cholesky those that are positive definite") {
  const Matrix A = transport(23, 0.4, true), K = transport(23, 0.0, false);
  const Eigen::VectorXd x = waves(A.rows());
  const auto lu = factorize_lu(A);
  REQUIRE(lu);
  CHECK((lu->apply(A * x) - x).norm() < 1e-10 * x.norm());
  const auto cholesky = factorize_cholesky(K);
  REQUIRE(cholesky);
  CHECK((cholesky->apply(K * x) - x).norm() < 1e-11 * x.norm());
}

TEST_CASE("a singular matrix has no inverse, an indefinite one no Cholesky factors") {
  Matrix A = transport(7, 0.0, false);
  const Eigen::VectorXd x = waves(A.rows());
  Matrix shifted = A;
  for (int i = 0; i < A.rows(); ++i) shifted.coeffRef(i, i) -= 3.0;  // between the eigenvalues
  CHECK_FALSE(factorize_cholesky(shifted));
  const auto lu = factorize_lu(shifted);
  REQUIRE(lu);
  CHECK((lu->apply(shifted * x) - x).norm() < 1e-10 * x.norm());
  for (int i = 0; i < A.rows(); ++i)
    if (A.coeff(i, 3) != 0.0) A.coeffRef(i, 3) = 0.0;
  A.prune(0.0);
  CHECK_FALSE(factorize_lu(A));
  CHECK_FALSE(factorize_cholesky(Matrix(-transport(5, 0.0, false))));
}

TEST_CASE("an inverse does not need its matrix any more") {
  Matrix A = transport(11, 0.2, true);
  const Eigen::VectorXd x = waves(A.rows()), b = A * x;
  const auto lu = factorize_lu(A);
  REQUIRE(lu);
  A = Matrix(3, 3);
  CHECK((lu->apply(b) - x).norm() < 1e-10 * x.norm());
}

TEST_CASE("incomplete factors nearly invert, where the diagonal does not") {
  const Matrix A = transport(31, 0.4, false);
  const Eigen::VectorXd b = waves(A.rows());
  const auto incomplete = factorize_incomplete(A);
  REQUIRE(incomplete);
  const double residual = (A * incomplete->apply(b) - b).norm() / b.norm();
  const double jacobi = (A * b.cwiseQuotient(Eigen::VectorXd(A.diagonal())) - b).norm() / b.norm();
  CHECK(residual < 0.15);
  CHECK(residual > 1e-12);  // in part only
  CHECK(residual < 0.5 * jacobi);
}

}  // namespace

}  // namespace integrator_solvers_test
