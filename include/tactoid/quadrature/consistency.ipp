#pragma once

#include <optional>

#include <Eigen/Cholesky>

#include <tactoid/core/compiled.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/quadrature/coarse_space.hpp>
#include <tactoid/quadrature/coloring.hpp>
#include <tactoid/quadrature/consistency.hpp>

namespace tactoid::detail {

TACTOID_INLINE AffineResidual::AffineResidual(const PointTable& table, std::span<const double> weights)
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

TACTOID_INLINE void AffineResidual::apply(const Field& mu, Field& result) const {
  std::fill(result.begin(), result.end(), Vector4::Zero());
  for_each_chunk(table_, [&](const PointChunk& chunk, std::size_t) {
    for (std::size_t q = chunk.begin; q < chunk.end; ++q)
      row_residual(q, table_.volume[q] * table_.volume[q], mu,
                   [&](std::size_t e, const Vector4& r) { result[particle_[e]] += r; });
  });
}

TACTOID_INLINE Vector3 AffineResidual::offset(std::size_t q, std::size_t e) const {
  Vector3 d = table_.particle_position[table_.entries[e].particle].head<3>() - table_.position[q];
  for (int k = 0; k < 3; ++k)
    if (table_.period[k] > 0.0) d[k] -= table_.period[k] * std::round(d[k] / table_.period[k]);
  return d;
}

}  // namespace tactoid::detail

namespace tactoid {

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

TACTOID_INLINE ConsistencyReport make_consistent(PointTable& table, std::span<const double> weights,
                                                 const Field& boundary, double tolerance, int max_iterations) {
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
    parallel_for(n, [&](std::size_t i) { z[i] = diagonal[i] > 0.0 ? Vector4(residual[i] / diagonal[i]) : Vector4::Zero(); });
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
    parallel_for(n, [&](std::size_t i) {
      mu[i] += alpha.cwiseProduct(direction[i]);
      residual[i] -= alpha.cwiseProduct(image[i]);
    });
    precondition();
    const Vector4 next = detail::componentwise_dot(residual, z);
    for (int k = 0; k < 3; ++k)
      if (rho[k] > 0.0) beta[k] = next[k] / rho[k];
    parallel_for(n, [&](std::size_t i) { direction[i] = z[i] + beta.cwiseProduct(direction[i]); });
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

#if defined(TACTOID_COMPILED)
namespace tactoid {
template void fit_boundary<1>(const PointTable& table, const std::vector<Point<1>>& normals, Field& boundary);
template void fit_boundary<2>(const PointTable& table, const std::vector<Point<2>>& normals, Field& boundary);
template void fit_boundary<3>(const PointTable& table, const std::vector<Point<3>>& normals, Field& boundary);
}  // namespace tactoid
#endif
