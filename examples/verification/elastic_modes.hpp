#pragma once

// Frequencies of elastic bodies: exact ones, and those of a Body.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <tactoid/core/tensor.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/neighbors/neighbor_search.hpp>
#include <tactoid/simulation/stiffness.hpp>

namespace tactoid::verification {

/// How a displacement field behaves in the mirrors x, y and z: that of the gradient of a potential which is even (+1)
/// or odd (-1) there. 0: no symmetry in this direction.
using Parity = std::array<int, 3>;

/// u_c(mirrored x) = sign · u_c(x) for the mirror with the normal `axis`.
[[nodiscard]] inline int mirror_sign(const Parity& parity, int axis, int component) {
  return parity[static_cast<std::size_t>(axis)] * (axis == component ? -1 : 1);
}

// --- Lamb's ball ------------------------------------------------------------------------------------------------

/// Determinant of the spheroidal modes of degree l of a free ball: H. Lamb, Proc. London Math. Soc. 1882, 13, 189, in
/// the notation of Eringen and Suhubi, Elastodynamics II, 1975, section 8.13; ξ = ω a/c_l, η = ω a/c_t:
///   T11 T43 - T13 T41,   T11 = (l² - l - η²/2) j_l(ξ) + 2ξ j_{l+1}(ξ),    T13 = l(l+1) [(l-1) j_l(η) - η j_{l+1}(η)],
///                        T41 = (l-1) j_l(ξ) - ξ j_{l+1}(ξ),               T43 = (l² - 1 - η²/2) j_l(η) + η j_{l+1}(η).
[[nodiscard]] inline double lamb_determinant(int l, double eta, double poisson) {
  const double xi = eta * std::sqrt((1.0 - 2.0 * poisson) / (2.0 - 2.0 * poisson));
  const auto n = static_cast<unsigned>(l);
  const double jx = std::sph_bessel(n, xi), kx = std::sph_bessel(n + 1, xi), jy = std::sph_bessel(n, eta),
               ky = std::sph_bessel(n + 1, eta);
  const double t11 = (l * l - l - 0.5 * eta * eta) * jx + 2.0 * xi * kx, t13 = l * (l + 1) * ((l - 1) * jy - eta * ky);
  const double t41 = (l - 1) * jx - xi * kx, t43 = (l * l - 1 - 0.5 * eta * eta) * jy + eta * ky;
  return (t11 * t43 - t13 * t41) / (jx * jy);
}

/// Smallest root η = ω a/c_t of Lamb's equation, l >= 2.
[[nodiscard]] inline double lamb_root(int l, double poisson) {
  double low = 1.0, high = low;
  const double sign = lamb_determinant(l, low, poisson);
  while (lamb_determinant(l, high, poisson) * sign > 0.0) {
    low = high;
    high += 0.01;
  }
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (lamb_determinant(l, middle, poisson) * sign > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// --- bars, by Ritz ----------------------------------------------------------------------------------------------

/// An isotropic elastic bar [-a, a] x [-b, b] x [-c, c], free, or clamped at x = -a.
struct ElasticBar {
  Vector3 half = Vector3::Ones();  ///< a, b, c, m
  double lambda = 0.0, mu = 0.0, density = 0.0;
  bool clamped = false;
};

namespace detail {

/// Polynomials on [-1, 1] with the integrals of their products: without, with one (first factor) and two derivatives.
struct RitzBasis {
  std::array<Eigen::MatrixXd, 4> integrals;  // flags: 1 the first factor, 2 the second one is derived
  [[nodiscard]] Eigen::Index size() const { return integrals[0].rows(); }

  /// Legendre polynomials up to `degree`, the even or odd ones or all (parity 0), times (1 + x) if `clamped`.
  RitzBasis(int degree, int parity, bool clamped) {
    constexpr int points = 24;  // Gauss points from the eigenvalues of the Jacobi matrix (Golub and Welsch 1969)
    Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(points, points);
    for (int i = 1; i < points; ++i) jacobi(i, i - 1) = jacobi(i - 1, i) = i / std::sqrt(4.0 * i * i - 1.0);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> gauss(jacobi);
    std::vector<int> degrees;
    for (int n = 0; n <= degree; ++n)
      if (parity == 0 || (n % 2 == 0) == (parity > 0)) degrees.push_back(n);
    const auto size = static_cast<Eigen::Index>(degrees.size());
    for (Eigen::MatrixXd& m : integrals) m = Eigen::MatrixXd::Zero(size, size);
    for (int g = 0; g < points; ++g) {
      const double x = gauss.eigenvalues()[g], weight = 2.0 * gauss.eigenvectors()(0, g) * gauss.eigenvectors()(0, g);
      Eigen::VectorXd f(size), d(size);
      for (Eigen::Index i = 0; i < size; ++i) {
        const int n = degrees[static_cast<std::size_t>(i)];
        f[i] = std::legendre(static_cast<unsigned>(n), x);
        d[i] = n == 0 ? 0.0 : n * (x * f[i] - std::legendre(static_cast<unsigned>(n - 1), x)) / (x * x - 1.0);
        if (!clamped) continue;
        d[i] = f[i] + (1.0 + x) * d[i];
        f[i] *= 1.0 + x;
      }
      integrals[0] += weight * f * f.transpose();
      integrals[1] += weight * d * f.transpose();
      integrals[2] += weight * f * d.transpose();
      integrals[3] += weight * d * d.transpose();
    }
  }
};

}  // namespace detail

/// Frequencies (rad/s, ascending, with the zero ones of rigid motions) of the modes of a bar that have the given
/// parity: Rayleigh and Ritz with polynomials of at most these degrees (W. M. Visscher et al., J. Acoust. Soc. Am.
/// 1991, 90, 2154, with products of Legendre polynomials). They converge from above, exponentially for a free bar.
[[nodiscard]] inline std::vector<double> ritz_frequencies(const ElasticBar& bar, const Parity& parity,
                                                          const std::array<int, 3>& degrees) {
  std::vector<std::array<detail::RitzBasis, 3>> basis;
  std::array<Eigen::Index, 4> start{0, 0, 0, 0};
  for (int c = 0; c < 3; ++c) {
    const auto along = [&](int a) {
      return detail::RitzBasis(degrees[static_cast<std::size_t>(a)], mirror_sign(parity, a, c), bar.clamped && a == 0);
    };
    basis.push_back({along(0), along(1), along(2)});
    const auto& b = basis.back();
    start[static_cast<std::size_t>(c) + 1] =
        start[static_cast<std::size_t>(c)] + b[0].size() * b[1].size() * b[2].size();
  }
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(start[3], start[3]), M = K;
  // ∫ ∂_p φ_A ∂_q φ_B: a product of integrals along the axes. Functions of different components have different
  // parities, so mixed integrals are taken with bases that hold all degrees and then picked.
  std::array<detail::RitzBasis, 3> all{detail::RitzBasis(degrees[0], 0, bar.clamped),
                                       detail::RitzBasis(degrees[1], 0, false),
                                       detail::RitzBasis(degrees[2], 0, false)};
  const auto degree_of = [&](int c, int a, Eigen::Index i) -> Eigen::Index {
    const int sign = mirror_sign(parity, a, c);
    return sign == 0 ? i : 2 * i + (sign < 0 ? 1 : 0);
  };
  struct Function {
    int component;
    std::array<Eigen::Index, 3> degree;
  };
  std::vector<Function> functions;
  for (int c = 0; c < 3; ++c)
    for (Eigen::Index i = 0; i < basis[static_cast<std::size_t>(c)][0].size(); ++i)
      for (Eigen::Index j = 0; j < basis[static_cast<std::size_t>(c)][1].size(); ++j)
        for (Eigen::Index k = 0; k < basis[static_cast<std::size_t>(c)][2].size(); ++k)
          functions.push_back({c, {degree_of(c, 0, i), degree_of(c, 1, j), degree_of(c, 2, k)}});
  const auto product = [&](const Function& A, const Function& B, int p, int q) {
    double value = bar.half.prod();
    for (int a = 0; a < 3; ++a) {
      const auto s = static_cast<std::size_t>(a);
      const int flags = (a == p ? 1 : 0) + (a == q ? 2 : 0);
      value *= all[s].integrals[static_cast<std::size_t>(flags)](A.degree[s], B.degree[s]);
      if (a == p) value /= bar.half[a];
      if (a == q) value /= bar.half[a];
    }
    return value;
  };
  for (std::size_t A = 0; A < functions.size(); ++A)
    for (std::size_t B = A; B < functions.size(); ++B) {
      const int p = functions[A].component, q = functions[B].component;
      double k =
          bar.lambda * product(functions[A], functions[B], p, q) + bar.mu * product(functions[A], functions[B], q, p);
      if (p == q)
        for (int a = 0; a < 3; ++a) k += bar.mu * product(functions[A], functions[B], a, a);
      const auto i = static_cast<Eigen::Index>(A), j = static_cast<Eigen::Index>(B);
      K(i, j) = K(j, i) = k;
      if (p == q) M(i, j) = M(j, i) = bar.density * product(functions[A], functions[B], -1, -1);
    }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, M, Eigen::EigenvaluesOnly);
  std::vector<double> frequencies;
  for (const double square : solver.eigenvalues()) frequencies.push_back(std::sqrt(std::max(square, 0.0)));
  return frequencies;
}

// --- of a body --------------------------------------------------------------------------------------------------

struct Mode {
  double frequency = 0.0;  ///< rad/s
  Field shape;             ///< of the unknowns, Σ M |shape|² = 1 kg m²
};

/// The lowest modes of a body whose cloud is its own mirror image in the planes through the origin, out of the class of
/// the given parity; `held(X)`: particles that do not move. `stiffness` is assemble_stiffness(body). The eigenvalues
/// are those of K u = ω² M u, by inverse subspace iteration with a shift of `scale`² (rad²/s²), so that rigid motions
/// (ω = 0) come with the others.
template <class Body, class Held>
[[nodiscard]] std::vector<Mode> lowest_modes(const Body& body, const StiffnessMatrix& stiffness, const Parity& parity,
                                             Eigen::Index count, double scale, const Held& held) {
  const auto& X = body.cloud().positions;
  const NeighborSearch<3> tree{X};
  double size = 0.0;
  for (const Point<3>& x : X) size = std::max(size, x.cwiseAbs().maxCoeff());
  // Each unknown is a weight times one of the class, or zero.
  std::vector<int> place(3 * X.size(), -1);
  std::vector<double> weight(3 * X.size(), 0.0);
  int unknowns = 0;
  for (Index i = 0; i < X.size(); ++i) {
    bool first = !held(X[i]);
    for (int a = 0; a < 3; ++a) first = first && (parity[static_cast<std::size_t>(a)] == 0 || X[i][a] > -1e-9 * size);
    if (!first) continue;
    for (int c = 0; c < 3; ++c) {
      std::vector<std::pair<std::size_t, double>> images;
      bool moves = true;
      for (unsigned mirrors = 0; mirrors < 8 && moves; ++mirrors) {
        Point<3> image = X[i];
        int sign = 1;
        for (int a = 0; a < 3; ++a)
          if (((mirrors >> a) & 1u) != 0) {
            image[a] = -image[a];
            sign *= mirror_sign(parity, a, c);
          }
        if (sign == 0) continue;
        const auto unknown = 3 * static_cast<std::size_t>(tree.nearest(image)) + static_cast<std::size_t>(c);
        const auto found =
            std::find_if(images.begin(), images.end(), [&](const auto& old) { return old.first == unknown; });
        if (found == images.end())
          images.emplace_back(unknown, sign);
        else
          moves = found->second == sign;  // a particle on a mirror, and a component that is odd there
      }
      if (!moves) continue;
      for (const auto& [unknown, sign] : images) {
        place[unknown] = unknowns;
        weight[unknown] = sign / std::sqrt(static_cast<double>(images.size()));
      }
      ++unknowns;
    }
  }
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd root_mass = Eigen::VectorXd::Zero(unknowns);  // turned into square roots below
  for (Eigen::Index j = 0; j < stiffness.outerSize(); ++j) {
    const auto jj = static_cast<std::size_t>(j);
    if (place[jj] < 0) continue;
    root_mass[place[jj]] += weight[jj] * weight[jj] * body.masses()[jj / 3];
    for (StiffnessMatrix::InnerIterator it(stiffness, j); it; ++it) {
      const auto ii = static_cast<std::size_t>(it.row());
      if (place[ii] >= 0) K(place[ii], place[jj]) += weight[ii] * weight[jj] * it.value();
    }
  }
  root_mass = root_mass.cwiseSqrt();
  K = root_mass.cwiseInverse().asDiagonal() * K * root_mass.cwiseInverse().asDiagonal();
  K = 0.5 * (K + K.transpose()).eval();
  K.diagonal().array() += scale * scale;
  const Eigen::LLT<Eigen::MatrixXd> inverse(K);

  const Eigen::Index block = std::min<Eigen::Index>(2 * count, unknowns);
  Eigen::MatrixXd V(unknowns, block);
  for (Eigen::Index j = 0; j < block; ++j)
    for (Eigen::Index i = 0; i < unknowns; ++i)
      V(i, j) = std::sin(1.7 * static_cast<double>((i + 1) * (j + 2)) + static_cast<double>(i % (j + 3)));
  Eigen::VectorXd values = Eigen::VectorXd::Zero(block);
  for (int iteration = 0; iteration < 100; ++iteration) {
    V = inverse.solve(V);
    V = Eigen::HouseholderQR<Eigen::MatrixXd>(V).householderQ() * Eigen::MatrixXd::Identity(unknowns, block);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(V.transpose() * K.selfadjointView<Eigen::Lower>() * V);
    V = (V * ritz.eigenvectors()).eval();
    const double change =
        (ritz.eigenvalues() - values).head(count).cwiseQuotient(ritz.eigenvalues().head(count)).cwiseAbs().maxCoeff();
    values = ritz.eigenvalues();
    if (change < 1e-11) break;
  }
  std::vector<Mode> modes(static_cast<std::size_t>(count));
  for (Eigen::Index m = 0; m < count; ++m) {
    Mode& mode = modes[static_cast<std::size_t>(m)];
    mode.frequency = std::sqrt(std::max(values[m] - scale * scale, 0.0));
    mode.shape.assign(X.size(), Vector4::Zero());
    for (std::size_t k = 0; k < place.size(); ++k)
      if (place[k] >= 0)
        mode.shape[k / 3][static_cast<Eigen::Index>(k % 3)] = weight[k] * V(place[k], m) / root_mass[place[k]];
  }
  return modes;
}

}  // namespace tactoid::verification
