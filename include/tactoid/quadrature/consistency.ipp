#pragma once

#include <numeric>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

#include <tactoid/core/compiled.hpp>
#include <tactoid/core/pages.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/quadrature/coarse_space.hpp>
#include <tactoid/quadrature/coloring.hpp>
#include <tactoid/quadrature/consistency.hpp>

namespace tactoid::detail {

TACTOID_INLINE AffineResidual::AffineResidual(const PointTable& table, std::vector<double> weights)
    : table_(table), periodic_(table.period.any()), weights_(std::move(weights)), particle_(table.size()), rows_(table.points()) {
  const auto n = static_cast<std::size_t>(table.dimension) + 1;
  parallel_for(table.points(), [&](std::size_t q) {
    const std::size_t begin = table.offsets[q], end = table.offsets[q + 1];
    double length = 0.0;
    for (std::size_t e = begin; e < end; ++e) particle_[e] = table.entries[e].particle;
    for (std::size_t e = begin; e < end; ++e)
      if (weights_[e] > 0.0) length = std::max(length, monomials(q, e).tail<3>().norm());
    const double unit = length > 0.0 ? 1.0 / length : 1.0;  // of the offsets, until L is known
    Row& row = rows_[q];
    // C Cᵀ = Σ w p pᵀ and L = C⁻¹, in plain loops: Eigen's factorisations cost every program seconds to compile. The factor of a direction
    // in which the row has no extent is left out.
    double C[4][4] = {};
    for (std::size_t e = begin; e < end; ++e) {
      Vector4 p = monomials(q, e);
      p.tail<3>() *= unit;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j <= i; ++j) C[i][j] += weights_[e] * p[static_cast<Eigen::Index>(i)] * p[static_cast<Eigen::Index>(j)];
    }
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t i = j; i < n; ++i)
        for (std::size_t k = 0; k < j; ++k) C[i][j] -= C[i][k] * C[j][k];
      const double inverse = C[j][j] > 0.0 ? 1.0 / std::sqrt(C[j][j]) : 0.0;
      for (std::size_t i = j; i < n; ++i) C[i][j] *= inverse;
      row.factor(j, j) = inverse;
      for (std::size_t k = 0; k < j; ++k) {
        double sum = 0.0;
        for (std::size_t l = k; l < j; ++l) sum += C[j][l] * row.factor(l, k);
        row.factor(j, k) = -inverse * sum;
      }
    }
    for (std::size_t i = 1; i < n; ++i)
      for (std::size_t k = 1; k <= i; ++k) row.factor(i, k) *= unit;
  });
}

TACTOID_INLINE void AffineResidual::apply(const Field& mu, Field& result, const RowShare* share) const {
  if (share == nullptr) std::fill(result.begin(), result.end(), Vector4::Zero());
  else
    for (const Index i : share->here) result[i].setZero();
  for_each_chunk(table_, [&](const PointChunk& chunk, std::size_t) {
    for (std::size_t q = chunk.begin; q < chunk.end; ++q)
      row_residual(q, table_.volume[q] * table_.volume[q], mu,
                   [&](std::size_t, Index i, const Quad& r) { quad(result[i].data()) += r; });
  });
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

TACTOID_INLINE ConsistencyReport make_consistent(PointTable& table, std::vector<double> weights,
                                                 const Field& boundary, double tolerance, int max_iterations, SharedRows* shared) {
  for (std::size_t q = 0; q < table.points(); ++q)
    if ((table.offsets[q + 1] - table.offsets[q]) % 2 != 0)
      throw GeometryError(fmt::format("make_consistent: the row of point {} has an odd number of entries, {}; lay_out_rows makes them even.", q, table.offsets[q + 1] - table.offsets[q]));
  RowShare* const share = shared != nullptr ? &shared->share : nullptr;
  const detail::AffineResidual S(table, std::move(weights));
  const std::size_t n = table.particles, whole = share != nullptr && share->part ? share->part->whole : n;
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
  ParticleSums sum(share, n);
  const auto dot = [&](const Field& a, const Field& b) { return sum([&](std::size_t i) -> Vector4 { return a[i].cwiseProduct(b[i]); }); };
  Field mu(n, Vector4::Zero()), z(mu), direction(mu), image(mu);
  if (share != nullptr)
    for (Field* field : {&mu, &z, &direction, &image, &residual}) give_back_unused(*field, share->here);
  const Vector4 initial = dot(residual, residual);
  // Round-off of the sums b and Σ V G themselves: below it there is nothing to correct.
  double floor = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    if (share == nullptr || share->particle_owner[i] == share->rank()) floor = std::max(floor, std::max(gross[i], boundary[i].norm()));
  if (share != nullptr) floor = share->largest(floor);
  floor = 1e-30 * floor * floor * static_cast<double>(whole);
  std::optional<detail::CoarseCorrection> coarse;
  if (whole >= detail::particles_for_coarse_space) {
    using Samples = detail::SampledRows<detail::AffineResidual>;
    const bool in_parts = share != nullptr && share->part;
    std::vector<Index> points;  // that this process evaluates for all
    for (Index q = 0; q < table.points(); ++q)
      if (!in_parts || share->part->is_own(table.owner[q])) points.push_back(q);
    const std::size_t step = detail::sampling_step(in_parts ? static_cast<std::size_t>(share->sum(static_cast<double>(points.size()))) : points.size());
    if (shared == nullptr || in_parts) {
      coarse.emplace(table, Samples{S, table, detail::every(step, points), static_cast<double>(step)}, share);
    } else {
      const detail::AffineResidual of_samples(shared->samples, std::move(shared->weights));
      points.resize(shared->samples.points());
      std::iota(points.begin(), points.end(), Index{0});
      coarse.emplace(table, Samples{of_samples, shared->samples, points, static_cast<double>(step)}, share);
      shared->samples = {};
    }
  }
  if (coarse && !coarse->usable()) coarse.reset();
  Field first_residual = coarse ? residual : Field();
  if (share != nullptr) give_back_unused(first_residual, share->own);
  auto precondition = [&] {
    sum.for_each_own([&](std::size_t i) { z[i] = diagonal[i] > 0.0 ? Vector4(residual[i] / diagonal[i]) : Vector4::Zero(); });
    if (coarse) coarse->add(residual, z);
  };
  precondition();
  sum.for_each_own([&](std::size_t i) { direction[i] = z[i]; });
  Vector4 rho = dot(residual, z);
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
    if (share != nullptr) share->exchange(direction);
    S.apply(direction, image, share);
    const Vector4 curvature = dot(direction, image);
    Vector4 alpha = Vector4::Zero(), beta = Vector4::Zero();
    for (int k = 0; k < 3; ++k)
      if (active(k) && curvature[k] > 0.0) alpha[k] = rho[k] / curvature[k];
    sum.for_each_own([&](std::size_t i) {
      mu[i] += alpha.cwiseProduct(direction[i]);
      residual[i] -= alpha.cwiseProduct(image[i]);
    });
    precondition();
    const Vector4 next = dot(residual, z);
    for (int k = 0; k < 3; ++k)
      if (rho[k] > 0.0) beta[k] = next[k] / rho[k];
    sum.for_each_own([&](std::size_t i) { direction[i] = z[i] + beta.cwiseProduct(direction[i]); });
    rho = next;
    norm = dot(residual, residual);
    ++report.iterations;
    // A body in pieces has more affine functions than are taken out, and their round-off may grow: then begin again without.
    if (norm.sum() < 0.25 * least) {
      least = norm.sum();
      last_progress = report.iterations;
    } else if (coarse && report.iterations > last_progress + 100) {
      coarse.reset();
      std::fill(mu.begin(), mu.end(), Vector4::Zero());
      sum.for_each_own([&](std::size_t i) { residual[i] = first_residual[i]; });
      norm = initial;
      precondition();
      sum.for_each_own([&](std::size_t i) { direction[i] = z[i]; });
      rho = dot(residual, z);
    }
  }
  if (share != nullptr) share->exchange(mu);
  double change = 0.0;
  for (std::size_t q = 0; q < table.points(); ++q)
    S.row_residual(q, table.volume[q], mu, [&](std::size_t e, Index, const Quad& d) {
      for (int k = 0; k < 3; ++k) {
        table.entries[e].gradient[k] += d[k];
        change += d[k] * d[k];
      }
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
