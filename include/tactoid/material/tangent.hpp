#pragma once

#include <Eigen/Core>

#include <tactoid/material/history.hpp>
#include <tactoid/material/material.hpp>

namespace tactoid {

/// ∂P_iK/∂F_jL in row 3 i + K and column 3 j + L, Pa.
using Tangent = Eigen::Matrix<double, 9, 9>;

/// Tangent ∂P/∂F of any law at a point, by forward differentiation; second derivatives of the energy for a law that has
/// only that. By default Ḟ and the time step are taken as zero, so viscous stresses do not enter, and a law with memory answers as
/// to a sudden change of F on top of `history` (which is not advanced). With a `rate_factor` (1/s) they are those of `point`, and Ḟ
/// moves with F, ∂Ḟ/∂F = rate_factor, as in an implicit step. The director is held fixed in space.
template <Material M>
[[nodiscard]] Tangent tangent(const M& material, const PointState<double>& point, const HistoryOf<M, double>& history,
                              double rate_factor = 0.0) {
  using D = Dual<double, 9>;
  PointState<D> q;
  const bool in_step = rate_factor > 0.0;
  if (in_step) q.time_step = point.time_step;
  for (int i = 0; i < 3; ++i) {
    q.director(i) = D(point.director(i));
    for (int K = 0; K < 3; ++K) {
      q.deformation_gradient(i, K) = D::variable(point.deformation_gradient(i, K), 3 * i + K);
      q.deformation_rate(i, K) = D(in_step ? point.deformation_rate(i, K) : 0.0);
      q.deformation_rate(i, K).derivative[static_cast<std::size_t>(3 * i + K)] = rate_factor;
      q.director_gradient(i, K) = D(point.director_gradient(i, K));
    }
  }
  HistoryOf<M, D> q_history = convert_history<M, D, double>(history);
  const Tensor<D> P = respond(material, q, q_history).stress;
  Tangent A;
  for (int i = 0; i < 3; ++i)
    for (int K = 0; K < 3; ++K)
      for (int c = 0; c < 9; ++c) A(3 * i + K, c) = P(i, K).derivative[static_cast<std::size_t>(c)];
  return A;
}

/// Tangent at the deformation gradient F, with the history at rest and without a director.
template <Material M>
[[nodiscard]] Tangent tangent(const M& material, const Tensor3& F) {
  PointState<double> point;
  point.deformation_gradient = F;
  return tangent(material, point, HistoryOf<M, double>{});
}

}  // namespace tactoid
