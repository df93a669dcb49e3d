#pragma once

#include <cmath>
#include <span>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/parallel.hpp>
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
  AffineResidual(const PointTable& table, std::span<const double> weights);

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

  void apply(const Field& mu, Field& result) const;

 private:
  [[nodiscard]] Vector3 offset(std::size_t q, std::size_t e) const;
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
  return parallel_sum(a.size(), [&](std::size_t i) -> Vector4 { return a[i].cwiseProduct(b[i]); }, Vector4(Vector4::Zero()));
}

}  // namespace detail

/// Fits boundary integrals b_I (m²) to the volumes of a table, by the least change that makes them integrals of affine fields,
///   Σ_I b_I = 0,   Σ_I b_I ⊗ X_I = Σ_q V_q 1,
/// without which the column conditions of make_consistent have no solution. `normals` are ∮ N_I n dA: where they vanish, inside, nothing
/// changes; elsewhere by (α + A X_I) |normal_I|. Exact nodal volumes need no fit. (One fit for the
/// whole cloud: a body in several pieces needs exact volumes.) Throws GeometryError where the facets enclose a volume that is more than
/// 5 % off: then they are no longer the surface of the body.
template <int D>
void fit_boundary(const PointTable& table, const std::vector<Point<D>>& normals, Field& boundary);

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
ConsistencyReport make_consistent(PointTable& table, std::span<const double> weights, const Field& boundary,
                                         double tolerance = 1e-13, int max_iterations = 20000);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/quadrature/consistency.ipp>
#endif
