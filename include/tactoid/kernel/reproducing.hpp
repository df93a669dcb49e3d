#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Cholesky>

#include <tactoid/core/errors.hpp>
#include <tactoid/kernel/basis.hpp>
#include <tactoid/kernel/kernel.hpp>
#include <tactoid/kernel/windows.hpp>

namespace tactoid::detail {

/// What RKPM and MLS share: shape functions φ_I(X) = ω_I p(z_I)ᵀ M⁻¹ p(0) with z_I = (X_I − X) / s,
/// M = Σ_I ω_I p(z_I) p(z_I)ᵀ, and weights ω_I = w(|X_I − X| / a_I), times ΔV_I for RKPM. The length s, the
/// largest support around, keeps the moment matrix free of dimensions and well scaled; results do not depend on it.
template <int D, int Order, Window W, bool WithVolumes>
class Reproducing {
 public:
  using Vector = BasisVector<D, Order>;
  using Matrix = BasisMatrix<D, Order>;
  static constexpr int size = monomial_count<D, Order>;

  explicit Reproducing(std::span<const KernelNeighbor<D>> neighbors);

  [[nodiscard]] double condition() const { return condition_; }

  void shape_functions(ShapeFunctions<D>& out) const;

  /// φ_I(X) alone; zero where the moment matrix is singular.
  void values(std::vector<double>& out) const;

  void direct_gradient(std::vector<Point<D>>& out) const;

 private:
  [[nodiscard]] static double weight(const KernelNeighbor<D>& n) {
    const double w = W::value(n.offset.norm() / n.support);
    return WithVolumes ? w * n.volume : w;
  }

  // ∂ω/∂X; the offset is X_I − X, so |X_I − X| has the gradient −(X_I − X) / |X_I − X|.
  [[nodiscard]] static Point<D> weight_gradient(const KernelNeighbor<D>& n) {
    const double r = n.offset.norm();
    if (!(r > 0.0)) return Point<D>::Zero();
    const double slope = W::slope(r / n.support) / n.support;
    return (-(WithVolumes ? slope * n.volume : slope) / r) * n.offset;
  }

  // One step of iterative refinement: the reproducing conditions then hold to round-off.
  [[nodiscard]] Vector solve(const Vector& right) const {
    Vector x = substitute(right);
    x += substitute(right - moment_ * x);
    return x;
  }
  // For vectors alone: each other type of right side is another solver to compile.
  [[nodiscard]] Vector substitute(const Vector& right) const;

  std::span<const KernelNeighbor<D>> neighbors_;
  double scale_ = 0.0;
  double condition_ = std::numeric_limits<double>::infinity();
  Matrix moment_ = Matrix::Zero();
  Eigen::LDLT<Matrix> factor_;
};

template <int D, int Order, Window W, bool WithVolumes>
Reproducing<D, Order, W, WithVolumes>::Reproducing(std::span<const KernelNeighbor<D>> neighbors)
    : neighbors_(neighbors) {
  for (const auto& n : neighbors) scale_ = std::max(scale_, n.support);
  if (!(scale_ > 0.0)) return;
  int reached = 0;
  for (const auto& n : neighbors) {
    const double w = weight(n);
    if (w > 0.0) ++reached;
    const Vector p = monomials<D, Order>(n.offset / scale_);
    moment_.noalias() += w * p * p.transpose();
  }
  if (reached < size || !moment_.allFinite()) return;
  factor_.compute(moment_);
  const auto pivots = factor_.vectorD();
  if (!(pivots.minCoeff() > size * std::numeric_limits<double>::epsilon() * pivots.maxCoeff())) return;
  // In the norm of largest column sums: within a factor `size` of the ratio of the eigenvalues, at a fraction of the cost.
  Matrix inverse;
  for (int k = 0; k < size; ++k) inverse.col(k) = substitute(Vector::Unit(k));
  condition_ = moment_.cwiseAbs().colwise().sum().maxCoeff() * inverse.cwiseAbs().colwise().sum().maxCoeff();
}

template <int D, int Order, Window W, bool WithVolumes>
void Reproducing<D, Order, W, WithVolumes>::shape_functions(ShapeFunctions<D>& out) const {
  out.value.assign(neighbors_.size(), 0.0);
  out.gradient.assign(neighbors_.size(), Point<D>::Zero());
  out.condition = condition_;
  if (!std::isfinite(condition_)) return;
  const Vector c = solve(Vector::Unit(0));
  // In a basis that stays fixed in space, P(Y) = p((Y − X) / s), only p(0) → P(X) and the weights vary with X:
  // ∂_k(M⁻¹ P(X)) = M⁻¹ (e_k / s − ∂_k M c), ∂_k M = Σ ∂_k ω_I p p^T.
  Eigen::Matrix<double, size, D> right = Eigen::Matrix<double, size, D>::Zero();
  for (int k = 0; k < D; ++k) right(1 + k, k) = 1.0 / scale_;
  for (std::size_t i = 0; i < neighbors_.size(); ++i) {
    const Vector p = monomials<D, Order>(neighbors_[i].offset / scale_);
    right.noalias() -= p * (p.dot(c) * weight_gradient(neighbors_[i])).transpose();
  }
  Eigen::Matrix<double, size, D> slope;
  for (int k = 0; k < D; ++k) slope.col(k) = solve(right.col(k));
  for (std::size_t i = 0; i < neighbors_.size(); ++i) {
    const Vector p = monomials<D, Order>(neighbors_[i].offset / scale_);
    const double w = weight(neighbors_[i]);
    out.value[i] = w * p.dot(c);
    out.gradient[i] = p.dot(c) * weight_gradient(neighbors_[i]) + w * (slope.transpose() * p);
  }
}

template <int D, int Order, Window W, bool WithVolumes>
void Reproducing<D, Order, W, WithVolumes>::values(std::vector<double>& out) const {
  out.assign(neighbors_.size(), 0.0);
  if (!std::isfinite(condition_)) return;
  const Vector c = solve(Vector::Unit(0));
  for (std::size_t i = 0; i < neighbors_.size(); ++i)
    out[i] = weight(neighbors_[i]) * monomials<D, Order>(neighbors_[i].offset / scale_).dot(c);
}

template <int D, int Order, Window W, bool WithVolumes>
void Reproducing<D, Order, W, WithVolumes>::direct_gradient(std::vector<Point<D>>& out) const {
  out.assign(neighbors_.size(), Point<D>::Zero());
  if (!std::isfinite(condition_)) return;
  Eigen::Matrix<double, size, D> rows;  // rows 1 … D of M⁻¹, transposed
  for (int k = 0; k < D; ++k) rows.col(k) = solve(Vector::Unit(1 + k));
  for (std::size_t i = 0; i < neighbors_.size(); ++i) {
    const Vector p = monomials<D, Order>(neighbors_[i].offset / scale_);
    out[i] = (weight(neighbors_[i]) / scale_) * (rows.transpose() * p);
  }
}

template <int D, int Order, Window W, bool WithVolumes>
auto Reproducing<D, Order, W, WithVolumes>::substitute(const Vector& right) const -> Vector {
  return factor_.solve(right);
}

#if defined(TACTOID_COMPILED)
extern template class Reproducing<2, 1, CubicBSpline, true>;
extern template class Reproducing<2, 1, CubicBSpline, false>;
extern template class Reproducing<3, 1, CubicBSpline, true>;
extern template class Reproducing<3, 1, CubicBSpline, false>;
#endif

/// Throws ParameterError for a support with which no cloud gives every point enough particles.
inline void validate_support(const char* name, double support, int order) {
  const double least = order == 1 ? 1.0 : 1.5;
  if (!(support > least) || !std::isfinite(support))
    reject(name, support, "spacings", order == 1 ? "above 1 and finite" : "above 1.5 and finite");
}

}  // namespace tactoid::detail
