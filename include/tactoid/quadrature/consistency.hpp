#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/quadrature/coarse_space.hpp>
#include <tactoid/quadrature/coloring.hpp>
#include <tactoid/quadrature/point_table.hpp>

namespace tactoid {

/// What the integration-consistent correction did.
struct ConsistencyReport {
  int iterations = 0;          ///< of the conjugate gradients
  double residual = 0.0;       ///< of the column conditions, relative to its value before the correction
  double relative_size = 0.0;  ///< root mean square of the correction over that of the gradients
};

namespace detail {

/// The operator S of make_consistent: per row, V_q² w (μ − weighted affine fit of μ), added to the particles.
///
/// The fit is a projection on an orthonormal affine basis of the row, (b₀, b₁, b₂, b₃)(X_I), with b₀ constant: a pair is its
/// three other values and its weight, and no row needs a solve.
class AffineResidual {
 public:
  AffineResidual(const PointTable& table, std::span<const double> weights)
      : table_(table), pair_(table.pairs()), particle_(table.pairs()), constant_(table.points()) {
    const int n = table.dimension + 1;
    parallel_for(table.points(), [&](std::size_t q) {
      const std::size_t begin = table.offsets[q], end = table.offsets[q + 1];
      double length = 0.0;
      for (std::size_t e = begin; e < end; ++e)
        if (weights[e] > 0.0) length = std::max(length, offset(q, e).norm());
      // L Lᵀ = Σ w p pᵀ, in plain loops: Eigen's factorisations cost every program seconds to compile. The factor of a direction
      // in which the row has no extent is left out.
      double L[4][4] = {};
      Vector4 inverse = Vector4::Zero();  // of L's diagonal
      for (std::size_t e = begin; e < end; ++e) {
        const Vector4 p = monomials(q, e, length);
        for (int i = 0; i < n; ++i)
          for (int j = 0; j <= i; ++j) L[i][j] += weights[e] * p[i] * p[j];
      }
      for (int j = 0; j < n; ++j) {
        for (int i = j; i < n; ++i)
          for (int k = 0; k < j; ++k) L[i][j] -= L[i][k] * L[j][k];
        inverse[j] = L[j][j] > 0.0 ? 1.0 / std::sqrt(L[j][j]) : 0.0;
        for (int i = j; i < n; ++i) L[i][j] *= inverse[j];
      }
      for (std::size_t e = begin; e < end; ++e) {
        const Vector4 of = monomials(q, e, length);
        Vector4 p = Vector4::Zero();
        for (int i = 0; i < n; ++i) {
          p[i] = of[i];
          for (int k = 0; k < i; ++k) p[i] -= L[i][k] * p[k];
          p[i] *= inverse[i];
        }
        constant_[q] = p[0];
        pair_[e] = {p[1], p[2], p[3], weights[e]};
        particle_[e] = table.entries[e].particle;
      }
    });
  }

  /// Contribution of the pair to the diagonal of S.
  [[nodiscard]] double diagonal(std::size_t q, std::size_t e) const {
    const double w = pair_[e][3], V = table_.volume[q];
    return V * V * w * (1.0 - w * (constant_[q] * constant_[q] + pair_[e].head<3>().squaredNorm()));
  }

  /// f(particle, weight, orthonormal affine basis there) for the entries of row q that have a weight.
  template <class F>
  void for_each_weighted(std::size_t q, const F& f) const {
    for (std::size_t e = table_.offsets[q]; e < table_.offsets[q + 1]; ++e)
      if (pair_[e][3] > 0.0) f(particle_[e], pair_[e][3], Vector4(constant_[q], pair_[e][0], pair_[e][1], pair_[e][2]));
  }

  /// sink(e, factor · w (μ − affine fit of μ)) for every entry of row q.
  template <class Sink>
  void row_residual(std::size_t q, double factor, const Field& mu, const Sink& sink) const {
    const std::size_t begin = table_.offsets[q], end = table_.offsets[q + 1];
    Vector4 f0 = Vector4::Zero(), f1 = f0, f2 = f0, f3 = f0;
    for (std::size_t e = begin; e < end; ++e) {
      const Vector4& b = pair_[e];
      const Vector4 weighted = b[3] * mu[particle_[e]];
      f0 += weighted;
      f1 += b[0] * weighted;
      f2 += b[1] * weighted;
      f3 += b[2] * weighted;
    }
    f0 *= constant_[q] * constant_[q];
    for (std::size_t e = begin; e < end; ++e) {
      const Vector4& b = pair_[e];
      Vector4 r = mu[particle_[e]] - f0;
      r -= b[0] * f1;
      r -= b[1] * f2;
      r -= b[2] * f3;
      sink(e, Vector4((factor * b[3]) * r));
    }
  }

  void apply(const Field& mu, Field& result) const {
    std::fill(result.begin(), result.end(), Vector4::Zero());
    for_each_chunk(table_, [&](const PointChunk& chunk, std::size_t) {
      for (std::size_t q = chunk.begin; q < chunk.end; ++q)
        row_residual(q, table_.volume[q] * table_.volume[q], mu,
                     [&](std::size_t e, const Vector4& r) { result[particle_[e]] += r; });
    });
  }

 private:
  [[nodiscard]] Vector3 offset(std::size_t q, std::size_t e) const {
    Vector3 d = table_.particle_position[table_.entries[e].particle].head<3>() - table_.position[q];
    for (int k = 0; k < 3; ++k)
      if (table_.period[k] > 0.0) d[k] -= table_.period[k] * std::round(d[k] / table_.period[k]);
    return d;
  }
  [[nodiscard]] Vector4 monomials(std::size_t q, std::size_t e, double length) const {
    const Vector3 d = offset(q, e) / length;
    return {1.0, d[0], d[1], d[2]};
  }
  const PointTable& table_;
  std::vector<Vector4> pair_;  // b₁, b₂, b₃, w
  std::vector<Index> particle_;
  std::vector<double> constant_;  // b₀ of each row
};

/// From so many particles on, a coarse space pays.
inline constexpr std::size_t particles_for_coarse_space = 5000;

[[nodiscard]] inline Vector4 componentwise_dot(const Field& a, const Field& b) {
  Vector4 sum = Vector4::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].cwiseProduct(b[i]);
  return sum;
}

}  // namespace detail

/// Fits boundary integrals b_I (m²) to the volumes of a table, by the least change that makes them integrals of affine fields,
///   Σ_I b_I = 0,   Σ_I b_I ⊗ X_I = Σ_q V_q 1,
/// without which the column conditions of make_consistent have no solution. `normals` are ∮ N_I n dA: where they vanish, inside, nothing
/// changes; elsewhere by (α + A X_I) |normal_I|. Exact nodal volumes need no fit. (One fit for the
/// whole cloud: a body in several pieces needs exact volumes.) Throws GeometryError where the facets enclose a volume that is more than
/// 5 % off: then they are no longer the surface of the body.
template <int D>
void fit_boundary(const PointTable& table, const std::vector<Point<D>>& normals, Field& boundary) {
  constexpr int n = D + 1;
  Vector3 middle = Vector3::Zero();
  double total = 0.0, volume = 0.0, length = 0.0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    middle += normals[i].norm() * table.particle_position[i].template head<3>();
    total += normals[i].norm();
  }
  middle /= total;
  for (const Vector4& X : table.particle_position) length = std::max(length, (X.head<3>() - middle).norm());
  for (const double V : table.volume) volume += V;
  double enclosed = 0.0;
  for (std::size_t i = 0; i < normals.size(); ++i)
    enclosed += boundary[i].template head<D>().dot((table.particle_position[i].template head<3>() - middle).template head<D>()) / D;
  if (!(std::abs(enclosed / volume - 1.0) < 0.05))
    throw GeometryError(fmt::format("The facets enclose {:.4g} times the volume of the points: they have folded, or points have left them.", enclosed / volume));
  using Row = Eigen::Matrix<double, n, 1>;
  const auto monomials = [&](std::size_t i) {
    Row p;
    p[0] = 1.0;
    p.template tail<D>() = (table.particle_position[i].template head<3>() - middle).template head<D>() / length;
    return p;
  };
  Eigen::Matrix<double, n, n> moments = Eigen::Matrix<double, n, n>::Zero();
  Eigen::Matrix<double, n, D> defect = Eigen::Matrix<double, n, D>::Zero();
  for (int k = 0; k < D; ++k) defect(k + 1, k) = volume / length;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Row p = monomials(i);
    moments += normals[i].norm() * p * p.transpose();
    defect -= p * boundary[i].template head<D>().transpose();
  }
  const Eigen::Matrix<double, n, D> change = moments.ldlt().solve(defect);
  for (std::size_t i = 0; i < normals.size(); ++i)
    boundary[i].template head<D>() += normals[i].norm() * change.transpose() * monomials(i);
}

/// Corrects the gradients of a value-based table so that rows and columns hold together:
///   Σ_I G_qI = 0,  Σ_I G_qI ⊗ X_I = 1   (linear exactness; must hold on entry and is kept), and
///   Σ_q V_q G_qI = b_I = ∮ N_I n dA      (integration by parts holds for the discrete integral),
/// by the change of least weighted norm,
///   dG_qI = V_q w_qI (μ_I − a_q(X_I)),   a_q the w-weighted affine fit of μ over the row of q.
/// The multipliers μ solve, for each component of the gradient, S μ = b − Σ V G, where S is symmetric, positive
/// semi-definite and has the affine functions as its null space; conjugate gradients with Jacobi's
/// preconditioner and, in bodies of many particles, a correction in a space of smooth fields (CoarseCorrection), which keeps the
/// iterations near a hundred where they would grow with the square of the particles along an edge. With it constant stress gives no force on any particle inside: the patch test holds to the
/// accuracy of the solve. `weights` are the kernel weights beside the entries (0 for padding).
/// Throws ComputationError when the column conditions cannot be met.
/// Background: J.-S. Chen, M. Hillman, M. Rüter, Int. J. Numer. Meth. Engng 2013, 95, 387 (variational
/// consistency); the least-norm form keeps the operator symmetric.
inline ConsistencyReport make_consistent(PointTable& table, std::span<const double> weights, const Field& boundary,
                                         double tolerance = 1e-13, int max_iterations = 20000) {
  const detail::AffineResidual S(table, weights);
  const std::size_t n = table.particles;
  Field residual = boundary;
  std::vector<double> diagonal(n, 0.0), gross(n, 0.0);  // gross: sums of the sizes of what Σ V G adds
  Vector4 size = Vector4::Zero();
  for (std::size_t q = 0; q < table.points(); ++q)
    for (std::size_t e = table.offsets[q]; e < table.offsets[q + 1]; ++e) {
      const TableEntry& entry = table.entries[e];
      const Vector4 g(entry.gradient[0], entry.gradient[1], entry.gradient[2], 0.0);
      residual[entry.particle] -= table.volume[q] * g;
      gross[entry.particle] += table.volume[q] * g.norm();
      diagonal[entry.particle] += S.diagonal(q, e);
      size += g.cwiseAbs2();
    }
  Field mu(n, Vector4::Zero()), z(n), direction(n), image(n);
  const Vector4 initial = detail::componentwise_dot(residual, residual);
  // Round-off of the sums b and Σ V G themselves: below it there is nothing to correct.
  double floor = 0.0;
  for (std::size_t i = 0; i < n; ++i) floor = std::max(floor, std::max(gross[i], boundary[i].norm()));
  floor = 1e-30 * floor * floor * static_cast<double>(n);
  std::optional<detail::CoarseCorrection> coarse;
  if (n >= detail::particles_for_coarse_space) coarse.emplace(table, S);
  if (coarse && !coarse->usable()) coarse.reset();
  const Field first_residual = coarse ? residual : Field();
  auto precondition = [&] {
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = diagonal[i] > 0.0 ? Vector4(residual[i] / diagonal[i]) : Vector4::Zero();
    }
    if (coarse) coarse->add(residual, z);
  };
  precondition();
  direction = z;
  Vector4 rho = detail::componentwise_dot(residual, z);
  Vector4 norm = initial;
  ConsistencyReport report;
  double least = initial.sum();
  int last_progress = 0;  // the iteration in which the residual had halved again
  auto active = [&](int k) { return !(norm[k] <= tolerance * tolerance * initial[k] || norm[k] <= floor); };
  while (active(0) || active(1) || active(2)) {
    if (report.iterations == max_iterations || !norm.allFinite())
      throw ComputationError(fmt::format(
          "The integration-consistent correction of the gradients did not converge: residual {:.1e} after {} iterations; "
          "the likely cause is a cloud whose facets do not close its cells.",
          std::sqrt((norm.array() / initial.array().max(floor)).maxCoeff()), report.iterations));
    S.apply(direction, image);
    const Vector4 curvature = detail::componentwise_dot(direction, image);
    Vector4 alpha = Vector4::Zero(), beta = Vector4::Zero();
    for (int k = 0; k < 3; ++k)
      if (active(k) && curvature[k] > 0.0) alpha[k] = rho[k] / curvature[k];
    for (std::size_t i = 0; i < n; ++i) {
      mu[i] += alpha.cwiseProduct(direction[i]);
      residual[i] -= alpha.cwiseProduct(image[i]);
    }
    precondition();
    const Vector4 next = detail::componentwise_dot(residual, z);
    for (int k = 0; k < 3; ++k)
      if (rho[k] > 0.0) beta[k] = next[k] / rho[k];
    for (std::size_t i = 0; i < n; ++i) direction[i] = z[i] + beta.cwiseProduct(direction[i]);
    rho = next;
    norm = detail::componentwise_dot(residual, residual);
    ++report.iterations;
    // A body in pieces has more affine functions than are taken out, and their round-off may grow: then begin again without.
    if (norm.sum() < 0.25 * least) {
      least = norm.sum();
      last_progress = report.iterations;
    } else if (coarse && report.iterations > last_progress + 100) {
      coarse.reset();
      std::fill(mu.begin(), mu.end(), Vector4::Zero());
      residual = first_residual;
      norm = initial;
      precondition();
      direction = z;
      rho = detail::componentwise_dot(residual, z);
    }
  }
  double change = 0.0;
  for (std::size_t q = 0; q < table.points(); ++q)
    S.row_residual(q, table.volume[q], mu, [&](std::size_t e, const Vector4& d) {
      for (int k = 0; k < 3; ++k) table.entries[e].gradient[k] += d[k];
      change += d.squaredNorm();
    });
  report.residual = std::sqrt(norm.head<3>().sum() / std::max(initial.head<3>().sum(), floor));
  report.relative_size = std::sqrt(change / size.sum());
  return report;
}

}  // namespace tactoid
