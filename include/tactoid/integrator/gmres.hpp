#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace tactoid {

/// What gmres found.
struct GmresSolution {
  Eigen::VectorXd x;        ///< the solution; the best one where it did not converge
  int iterations = 0;       ///< products with A
  double residual = 0.0;    ///< relative to |b|
  bool converged = false;   ///< residual <= tolerance
};

/// Solves A x = b for any regular A of which only products are known, from x = 0: generalised minimal residuals, restarted after
/// `restart` iterations. Y. Saad and M. H. Schultz, SIAM J. Sci. Stat. Comput. 1986, 7, 856. `multiply(v)` gives A v; a
/// preconditioner belongs in it and in b. The least |b − A x| of each subspace: an iteration never makes it worse.
template <class Multiply>
[[nodiscard]] GmresSolution gmres(const Multiply& multiply, const Eigen::VectorXd& b, double tolerance, int max_iterations, int restart = 60) {
  GmresSolution solution;
  solution.x = Eigen::VectorXd::Zero(b.size());
  const double size = b.norm();
  if (!(size > 0.0)) {
    solution.converged = size == 0.0;
    return solution;
  }
  solution.residual = 1.0;
  Eigen::VectorXd r = b;
  while (solution.iterations < max_iterations) {
    const double start = r.norm();
    const int most = std::min(restart, max_iterations - solution.iterations);
    std::vector<Eigen::VectorXd> basis{r / start};
    Eigen::MatrixXd R = Eigen::MatrixXd::Zero(most + 1, most);  // Hessenberg matrix, turned to a triangle as it grows
    Eigen::VectorXd g = Eigen::VectorXd::Zero(most + 1), cosine(most), sine(most);
    g[0] = start;
    int n = 0;
    while (n < most) {
      Eigen::VectorXd w = multiply(basis.back());
      ++solution.iterations;
      for (int pass = 0; pass < 2; ++pass)  // twice, or round-off spoils the orthogonality
        for (int i = 0; i <= n; ++i) {
          const double h = basis[static_cast<std::size_t>(i)].dot(w);
          R(i, n) += h;
          w -= h * basis[static_cast<std::size_t>(i)];
        }
      const double rest = w.norm(), before = R.col(n).head(n + 1).norm();
      if (!std::isfinite(rest)) break;  // what is known so far has to do
      for (int i = 0; i < n; ++i) {
        const double upper = R(i, n);
        R(i, n) = cosine[i] * upper + sine[i] * R(i + 1, n);
        R(i + 1, n) = -sine[i] * upper + cosine[i] * R(i + 1, n);
      }
      const double radius = std::hypot(R(n, n), rest);
      if (!(radius > 0.0)) break;  // A is singular on this subspace
      cosine[n] = R(n, n) / radius;
      sine[n] = rest / radius;
      R(n, n) = radius;
      g[n + 1] = -sine[n] * g[n];
      g[n] *= cosine[n];
      ++n;
      if (std::abs(g[n]) <= tolerance * size || rest <= std::numeric_limits<double>::epsilon() * before) break;
      basis.push_back(w / rest);
    }
    if (n == 0) return solution;
    const Eigen::VectorXd y = R.topLeftCorner(n, n).template triangularView<Eigen::Upper>().solve(g.head(n));
    for (int i = 0; i < n; ++i) solution.x += y[i] * basis[static_cast<std::size_t>(i)];
    solution.residual = std::abs(g[n]) / size;
    solution.converged = solution.residual <= tolerance;
    if (solution.converged || n < most) return solution;
    r = b - multiply(solution.x);
  }
  return solution;
}

}  // namespace tactoid
