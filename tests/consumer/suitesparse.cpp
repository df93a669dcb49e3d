#include <tactoid/integrator/sparse_solvers.hpp>

#include <cstdio>

int main() {
  Eigen::SparseMatrix<double> A(2, 2);
  A.insert(0, 0) = 4.0;
  A.insert(0, 1) = A.insert(1, 0) = 1.0;
  A.insert(1, 1) = 3.0;
  const Eigen::VectorXd x = tactoid::factorize_lu(A)->apply(Eigen::Vector2d(6.0, 7.0));
#ifndef TACTOID_WITH_SUITESPARSE
#error tactoid::suitesparse does not say so
#endif
  std::printf("%g %g\n", x[0], x[1]);
  return (x - Eigen::Vector2d(1.0, 2.0)).norm() < 1e-12 ? 0 : 1;
}
