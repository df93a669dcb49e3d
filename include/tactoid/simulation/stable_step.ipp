#pragma once

#include <Eigen/Eigenvalues>

#include <tactoid/core/compiled.hpp>
#include <tactoid/quadrature/coloring.hpp>
#include <tactoid/simulation/stable_step.hpp>

namespace tactoid {

TACTOID_INLINE double StableStep::largest_eigenvalue(const Operator& of, const Particles& particles) {
  BodyShare* const share = particles.share;
  const OwnParticles own(share, of.masses.size());
  const std::size_t width = of.per_particle;
  ParticleSums sum(share, of.masses.size());
  // Of vectors with the numbers of the particles of this process, one after the other.
  std::vector<double> terms(of.masses.size());
  const auto inner = [&](const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
    parallel_for(own.size(), [&](std::size_t k) {
      const auto begin = static_cast<Eigen::Index>(k * width), n = static_cast<Eigen::Index>(width);
      terms[own[k]] = of.masses[own[k]] * x.segment(begin, n).dot(y.segment(begin, n));
    });
    return sum([&](std::size_t i) { return Vector4(terms[i], 0.0, 0.0, 0.0); })[0];
  };
  const auto size = static_cast<Eigen::Index>(own.size() * width);
  Eigen::VectorXd mode(size), before = Eigen::VectorXd::Zero(size), next(size);
  // Arbitrary: nothing is orthogonal to it.
  for (std::size_t k = 0; k < own.size(); ++k)
    for (std::size_t d = 0; d < width; ++d)
      mode[static_cast<Eigen::Index>(k * width + d)] = std::sin(12.9898 * static_cast<double>(particles.number(own[k]) * width + d + 1) * 1.61803398875);
  mode /= std::sqrt(inner(mode, mode));
  std::vector<double> diagonal, beside;
  double largest = 0.0;
  constexpr int least = 10, most = 60;
  for (int iteration = 0; iteration < most; ++iteration) {
    of.multiply(mode, next);
    for (std::size_t k = 0; k < own.size(); ++k) next.segment(static_cast<Eigen::Index>(k * width), static_cast<Eigen::Index>(width)) /= of.masses[own[k]];
    diagonal.push_back(inner(mode, next));
    if (!std::isfinite(diagonal.back())) return std::numeric_limits<double>::quiet_NaN();
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
                                                      const std::vector<double>& point_masses, Index r, const Particles& particles) {
  BodyShare* const share = particles.share;
  Field waves(masses.size(), Vector4::Zero()), result(waves);  // their first components
  const OwnParticles own(share, masses.size());
  return largest_eigenvalue({1, masses, [&](const Eigen::VectorXd& mode, Eigen::VectorXd& image) {
    for (std::size_t k = 0; k < own.size(); ++k) waves[own[k]][0] = mode[static_cast<Eigen::Index>(k)];
    if (share != nullptr) share->exchange(waves);
    std::fill(result.begin(), result.end(), Vector4::Zero());
    for_each_chunk(table, [&](const PointChunk& chunk, std::size_t) {
      if (chunk.region != r) return;
      for (std::size_t q = chunk.begin; q < chunk.end; ++q) {
        Vector3 gradient = Vector3::Zero();
        for (const TableEntry& entry : table.row(q)) gradient += waves[entry.particle][0] * entry.vector();
        gradient *= point_masses[q];
        for (const TableEntry& entry : table.row(q)) result[entry.particle][0] += gradient.dot(entry.vector());
      }
    });
    for (std::size_t k = 0; k < own.size(); ++k) image[static_cast<Eigen::Index>(k)] = result[own[k]][0];
  }}, particles);
}

TACTOID_INLINE double StableStep::largest_eigenvalue(int D, const std::vector<double>& masses, Field& field, double size,
                                                     const std::function<const Field&()>& internal_forces, const Particles& particles) {
  BodyShare* const share = particles.share;
  const Field start = field, rest = internal_forces();
  const OwnParticles own(share, masses.size());
  return largest_eigenvalue({static_cast<std::size_t>(D), masses, [&](const Eigen::VectorXd& mode, Eigen::VectorXd& result) {
    double most = mode.size() > 0 ? mode.cwiseAbs().maxCoeff() : 0.0;
    if (share != nullptr) most = share->largest(most);
    const double step = size / most;
    for (std::size_t k = 0; k < own.size(); ++k)
      for (int d = 0; d < D; ++d) field[own[k]][d] = start[own[k]][d] + step * mode[static_cast<Eigen::Index>(k) * D + d];
    if (share != nullptr) share->exchange(field);
    const Field& force = internal_forces();
    for (std::size_t k = 0; k < own.size(); ++k)
      for (int d = 0; d < D; ++d) result[static_cast<Eigen::Index>(k) * D + d] = (1.0 / step) * (rest[own[k]][d] - force[own[k]][d]);
  }}, particles);
}

}  // namespace tactoid
