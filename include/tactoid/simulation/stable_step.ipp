#pragma once

#include <Eigen/Eigenvalues>

#include <tactoid/core/compiled.hpp>
#include <tactoid/quadrature/coloring.hpp>
#include <tactoid/simulation/stable_step.hpp>

namespace tactoid {

TACTOID_INLINE double StableStep::largest_eigenvalue(const Eigen::VectorXd& masses, const Multiply& multiply) {
  const auto inner = [&](const Eigen::VectorXd& x, const Eigen::VectorXd& y) { return x.dot(masses.cwiseProduct(y)); };
  Eigen::VectorXd mode(masses.size()), before = Eigen::VectorXd::Zero(masses.size()), next(masses.size());
  // Arbitrary: nothing is orthogonal to it.
  for (Eigen::Index i = 0; i < mode.size(); ++i) mode[i] = std::sin(12.9898 * static_cast<double>(i + 1) * 1.61803398875);
  mode /= std::sqrt(inner(mode, mode));
  std::vector<double> diagonal, beside;
  double largest = 0.0;
  constexpr int least = 10, most = 60;
  for (int iteration = 0; iteration < most; ++iteration) {
    multiply(mode, next);
    if (!next.allFinite()) return std::numeric_limits<double>::quiet_NaN();
    next.array() /= masses.array();
    diagonal.push_back(inner(mode, next));
    next -= diagonal.back() * mode;
    if (!beside.empty()) next -= beside.back() * before;
    const double norm = std::sqrt(inner(next, next));
    const auto n = static_cast<Eigen::Index>(diagonal.size());
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
    ritz.computeFromTridiagonal(Eigen::Map<Eigen::VectorXd>(diagonal.data(), n),
                                Eigen::Map<Eigen::VectorXd>(beside.data(), n - 1), Eigen::EigenvaluesOnly);
    const double previous = largest;
    largest = ritz.eigenvalues()[n - 1];
    const bool settled = iteration >= least && std::abs(largest - previous) < 1e-3 * largest;
    if (settled || !(largest > 0.0) || !(norm > 1e-12 * largest)) break;
    beside.push_back(norm);
    before.swap(mode);
    mode = next / norm;
  }
  return 1.02 * std::max(largest, 0.0);
}

TACTOID_INLINE double StableStep::largest_wave_number(const PointTable& table, const std::vector<double>& masses,
                                                      const std::vector<double>& point_masses, Index r) {
  const auto diagonal = Eigen::Map<const Eigen::VectorXd>(masses.data(), static_cast<Eigen::Index>(masses.size()));
  return largest_eigenvalue(diagonal, [&](const Eigen::VectorXd& mode, Eigen::VectorXd& result) {
    result.setZero();
    for_each_chunk(table, [&](const PointChunk& chunk, std::size_t) {
      if (chunk.region != r) return;
      for (std::size_t q = chunk.begin; q < chunk.end; ++q) {
        Vector3 gradient = Vector3::Zero();
        for (const TableEntry& entry : table.row(q)) gradient += mode[entry.particle] * entry.vector();
        gradient *= point_masses[q];
        for (const TableEntry& entry : table.row(q)) result[entry.particle] += gradient.dot(entry.vector());
      }
    });
  });
}

TACTOID_INLINE double StableStep::largest_eigenvalue(int D, const std::vector<double>& masses, Field& field, double size,
                                                     const std::function<const Field&()>& internal_forces) {
  const Field start = field, rest = internal_forces();
  const std::size_t n = masses.size();
  Eigen::VectorXd diagonal(static_cast<Eigen::Index>(n) * D);
  for (std::size_t i = 0; i < n; ++i) diagonal.segment(static_cast<Eigen::Index>(i) * D, D).setConstant(masses[i]);
  return largest_eigenvalue(diagonal, [&](const Eigen::VectorXd& mode, Eigen::VectorXd& result) {
    const double step = size / mode.cwiseAbs().maxCoeff();
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < D; ++k) field[i][k] = start[i][k] + step * mode[static_cast<Eigen::Index>(i) * D + k];
    const Field& force = internal_forces();
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < D; ++k) result[static_cast<Eigen::Index>(i) * D + k] = (1.0 / step) * (rest[i][k] - force[i][k]);
  });
}

}  // namespace tactoid
