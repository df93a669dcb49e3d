#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/core/quad.hpp>
#include <tactoid/quadrature/point_table.hpp>
#include <tactoid/quadrature/row_share.hpp>

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
/// The fit is pᵀ M⁻¹ Σ w p μ with the monomials p = (1, X_I − X_q) of a pair, which are made anew each time: S is bound by the memory that it reads, and so a pair is
/// but its particle and its weight, and a row the factor of M⁻¹ = Lᵀ L. L p are the values of an orthonormal affine basis.
class AffineResidual {
 public:
  AffineResidual(const PointTable& table, std::vector<double> weights);

  /// Contribution of the pair to the diagonal of S.
  [[nodiscard]] double diagonal(std::size_t q, std::size_t e) const {
    const double w = weights_[e], V = table_.volume[q];
    return V * V * w * (1.0 - w * basis(q, e).squaredNorm());
  }

  /// f(particle, weight, orthonormal affine basis there) for the entries of row q that have a weight.
  template <class F>
  void for_each_weighted(std::size_t q, const F& f) const {
    for (std::size_t e = table_.offsets[q]; e < table_.offsets[q + 1]; ++e)
      if (weights_[e] > 0.0) f(particle_[e], weights_[e], basis(q, e));
  }

  /// sink(e, its particle, factor · w (μ − affine fit of μ)) for every entry of row q.
  template <class Sink>
  void row_residual(std::size_t q, double factor, const Field& mu, const Sink& sink) const {
    const std::size_t begin = table_.offsets[q], end = table_.offsets[q + 1];
    if (begin == end) return;
    const Row& row = rows_[q];
    const auto L = [&](std::size_t i, std::size_t k) { return row.factor(i, k); };
    const Octet X = join(place(q), place(q));
    Octet s0{}, s1{}, s2{}, s3{};
    for (std::size_t e = begin; e < end; e += 2) {  // rows have an even length
      const Octet d = offsets(X, e), weighted = join(weights_[e] * quad(mu[particle_[e]].data()), weights_[e + 1] * quad(mu[particle_[e + 1]].data()));
      s0 += weighted;
      s1 += spread<0>(d) * weighted;
      s2 += spread<1>(d) * weighted;
      s3 += spread<2>(d) * weighted;
    }
    Quad m0 = low(s0) + high(s0), m1 = low(s1) + high(s1), m2 = low(s2) + high(s2), m3 = low(s3) + high(s3);
    const Quad f0 = L(0, 0) * m0;
    const Quad f1 = L(1, 0) * m0 + L(1, 1) * m1;
    const Quad f2 = L(2, 0) * m0 + L(2, 1) * m1 + L(2, 2) * m2;
    const Quad f3 = L(3, 0) * m0 + L(3, 1) * m1 + L(3, 2) * m2 + L(3, 3) * m3;
    m0 = L(0, 0) * f0 + L(1, 0) * f1 + L(2, 0) * f2 + L(3, 0) * f3;
    m1 = L(1, 1) * f1 + L(2, 1) * f2 + L(3, 1) * f3;
    m2 = L(2, 2) * f2 + L(3, 2) * f3;
    m3 = L(3, 3) * f3;
    s0 = join(m0, m0), s1 = join(m1, m1), s2 = join(m2, m2), s3 = join(m3, m3);
    for (std::size_t e = begin; e < end; e += 2) {
      const Octet d = offsets(X, e);
      Octet r = join(quad(mu[particle_[e]].data()), quad(mu[particle_[e + 1]].data()));
      r -= s0;
      r -= spread<0>(d) * s1;
      r -= spread<1>(d) * s2;
      r -= spread<2>(d) * s3;
      sink(e, particle_[e], (factor * weights_[e]) * low(r));
      sink(e + 1, particle_[e + 1], (factor * weights_[e + 1]) * high(r));
    }
  }

  /// S μ, at the particles of all rows that are here; `share` is null where these are all.
  void apply(const Field& mu, Field& result, const RowShare* share) const;

 private:
  /// The lower triangle of L, row after row.
  struct Row {
    std::array<double, 10> lower{};
    [[nodiscard]] double& factor(std::size_t i, std::size_t k) { return lower[i * (i + 1) / 2 + k]; }
    [[nodiscard]] double factor(std::size_t i, std::size_t k) const { return lower[i * (i + 1) / 2 + k]; }
  };
  [[nodiscard]] Quad place(std::size_t q) const {
    const Vector3& X = table_.position[q];
    return Quad{X[0], X[1], X[2], 0.0};
  }
  /// X_I − X of pairs e and e + 1, m; X twice.
  [[nodiscard]] Octet offsets(const Octet& X, std::size_t e) const {
    Octet d = join(quad(table_.particle_position[particle_[e]].data()), quad(table_.particle_position[particle_[e + 1]].data())) - X;
    if (periodic_)
      for (int k = 0; k < 8; ++k)
        if (const double period = k % 4 < 3 ? table_.period[k % 4] : 0.0; period > 0.0) d[k] -= period * std::round(d[k] / period);
    return d;
  }
  [[nodiscard]] Vector4 monomials(std::size_t q, std::size_t e) const {
    const int first = e % 2 == table_.offsets[q] % 2 ? 0 : 4;
    const Octet d = offsets(join(place(q), place(q)), e - static_cast<std::size_t>(first / 4));
    return {1.0, d[first], d[first + 1], d[first + 2]};
  }
  [[nodiscard]] Vector4 basis(std::size_t q, std::size_t e) const {
    const Vector4 p = monomials(q, e);
    Vector4 b = Vector4::Zero();
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k <= i; ++k) b[static_cast<Eigen::Index>(i)] += rows_[q].factor(i, k) * p[static_cast<Eigen::Index>(k)];
    return b;
  }

  const PointTable& table_;
  bool periodic_;
  std::vector<double> weights_;
  std::vector<Index> particle_;  // of each pair
  std::vector<Row> rows_;
};

/// From so many particles on, a coarse space pays.
inline constexpr std::size_t particles_for_coarse_space = 5000;

/// Of how many rows of a table one is sampled to make its operator.
[[nodiscard]] inline std::size_t sampling_step(std::size_t points) { return std::max<std::size_t>(8, points / 100000); }

}  // namespace detail

/// How several processes make the rows of a table consistent together.
struct SharedRows {
  RowShare& share;              ///< the rows that this one has
  PointTable samples;           ///< every sampling_step(points)-th row, on all of them, where there is a coarse space and all have the whole cloud; released early
  std::vector<double> weights;  ///< of the kernel, beside the entries of the samples; released early
};

/// Fits boundary integrals b_I (m²) to the volumes of a table, by the least change that makes them integrals of affine fields,
///   Σ_I b_I = 0,   Σ_I b_I ⊗ X_I = Σ_q V_q 1,
/// without which the column conditions of make_consistent have no solution. `normals` are ∮ N_I n dA: where they vanish, inside, nothing
/// changes; elsewhere by (α + A X_I) |normal_I|. Exact nodal volumes need no fit. (One fit for the
/// whole cloud: a body in several pieces needs exact volumes.) Throws GeometryError where the facets enclose a volume that is more than
/// 5 % off: then they are no longer the surface of the body.
template <int D>
void fit_boundary(const PointTable& table, const std::vector<Point<D>>& normals, Field& boundary);

/// Corrects the gradients of a value-based table, whose rows have an even length (lay_out_rows), so that rows and columns hold together:
///   Σ_I G_qI = 0,  Σ_I G_qI ⊗ X_I = 1   (linear exactness; must hold on entry and is kept), and
///   Σ_q V_q G_qI = b_I = ∮ N_I n dA      (integration by parts holds for the discrete integral),
/// by the change of least weighted norm,
///   dG_qI = V_q w_qI (μ_I − a_q(X_I)),   a_q the w-weighted affine fit of μ over the row of q.
/// The multipliers μ solve, for each component of the gradient, S μ = b − Σ V G, where S is symmetric, positive
/// semi-definite and has the affine functions as its null space; conjugate gradients with Jacobi's
/// preconditioner and, in bodies of many particles, a correction in a space of smooth fields (CoarseCorrection), which keeps the
/// iterations near a hundred where they would grow with the square of the particles along an edge. With it constant stress gives no force on any particle inside: the patch test holds to the
/// accuracy of the solve. `weights` are the kernel weights beside the entries (0 for padding); what is moved here is released early.
/// Throws GeometryError for a row of odd length, and ComputationError when the column conditions cannot be met. Where several processes have the rows (`shared`), all of them call it, and get the same bits as one, unless each has a part of the cloud;
/// the report's relative_size is then of the rows that are here.
/// Background: J.-S. Chen, M. Hillman, M. Rüter, Int. J. Numer. Meth. Engng 2013, 95, 387 (variational
/// consistency); the least-norm form keeps the operator symmetric.
ConsistencyReport make_consistent(PointTable& table, std::vector<double> weights, const Field& boundary,
                                         double tolerance = 1e-13, int max_iterations = 20000, SharedRows* shared = nullptr);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/quadrature/consistency.ipp>
#endif
