#pragma once

#include <algorithm>

#include <Eigen/SparseCholesky>

#include <tactoid/core/compiled.hpp>
#include <tactoid/boundary/essential_conditions.hpp>

namespace tactoid {

struct EssentialConditions::Solver : Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> {
  using SimplicialLDLT::SimplicialLDLT;
};

TACTOID_INLINE EssentialConditions::EssentialConditions(std::vector<PrescribedMotion> motions,
                                                        const ParticleValues& values, const Field& reference,
                                                        const std::vector<double>& masses)
    : motions_(std::move(motions)), masses_(&masses), identity_(values.identity()) {
  for (int c = 0; c < 3; ++c) {
    auto& direction = directions_[static_cast<std::size_t>(c)];
    std::vector<char> taken(reference.size(), 0);
    for (std::size_t m = 0; m < motions_.size(); ++m) {
      if (!motions_[m].components[static_cast<std::size_t>(c)]) continue;
      for (Index particle : motions_[m].particles) {
        if (particle >= reference.size())
          throw ParameterError(fmt::format("PrescribedMotion: particle {} does not exist; the body has {} particles.", particle,
                                           reference.size()));
        if (taken[particle]++)
          throw ParameterError(fmt::format("PrescribedMotion: component {} of particle {} is prescribed twice.", c, particle));
        direction.conditions.push_back({particle, m, reference[particle].head<3>()});
      }
    }
    direction.last.resize(direction.conditions.size());
    if (!identity_ && !direction.conditions.empty()) factorize(direction, values);
  }
  if (!motions_.empty()) forces_.assign(reference.size(), Vector4::Zero());
  reactions_.assign(motions_.size(), Vector3::Zero());
}

TACTOID_INLINE double EssentialConditions::impose(double time, double time_step, double step_before,
                                                  Field& displacement, Field& velocity, RowShare* share) {
  double work = 0.0;
  const double to_force = time_step > 0.0 ? 1.0 / (0.5 * (step_before + time_step) * time_step) : 0.0;
  std::fill(reactions_.begin(), reactions_.end(), Vector3::Zero());
  std::fill(forces_.begin(), forces_.end(), Vector4::Zero());
  for (int c = 0; c < 3; ++c) {
    auto& direction = directions_[static_cast<std::size_t>(c)];
    const std::size_t n = direction.conditions.size();
    if (n == 0) continue;
    Eigen::VectorXd defect(static_cast<Eigen::Index>(n));
    Eigen::VectorXd target(static_cast<Eigen::Index>(n));
    for (std::size_t k = 0; k < n; ++k) {
      const Condition& condition = direction.conditions[k];
      const Index particle = condition.particle;
      const auto row = static_cast<Eigen::Index>(k);
      target[row] = prescribed(condition, time)[c];
      defect[row] = target[row] - (identity_ ? displacement[particle][c] : direction.interpolate(k, displacement, c));
    }
    Eigen::VectorXd multiplier(defect.size());
    if (identity_) {
      for (std::size_t k = 0; k < n; ++k) {
        const Index particle = direction.conditions[k].particle;
        const auto row = static_cast<Eigen::Index>(k);
        multiplier[row] = (*masses_)[particle] * defect[row];
        displacement[particle][c] = target[row];
        if (time_step > 0.0) velocity[particle][c] += defect[row] / time_step;
        forces_[particle][c] = to_force * multiplier[row];
      }
    } else {
      // Twice: the second pass removes the round-off of the first.
      multiplier.setZero();
      for (int pass = 0; pass < 2; ++pass) {
        const Eigen::VectorXd lambda = direction.solver->solve(defect);
        multiplier += lambda;
        const Eigen::VectorXd change = direction.rows.transpose() * lambda;
        for (std::size_t j = 0; j < displacement.size(); ++j) {
          const double du = change[static_cast<Eigen::Index>(j)] / (*masses_)[j];
          displacement[j][c] += du;
          if (time_step > 0.0) velocity[j][c] += du / time_step;
          forces_[j][c] += to_force * change[static_cast<Eigen::Index>(j)];
        }
        for (std::size_t k = 0; k < n; ++k)
          defect[static_cast<Eigen::Index>(k)] =
              target[static_cast<Eigen::Index>(k)] - direction.interpolate(k, displacement, c);
      }
    }
    for (std::size_t k = 0; k < n; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const auto& [particle, motion, place] = direction.conditions[k];
      auto& last = direction.last[k];
      if (time_step > 0.0) {
        // The impulse acts from the middle of the last step to that of this one; the rest of this step, which the
        // next reaction will account for, is taken with the present one.
        const double force = to_force * multiplier[row], rate = (target[row] - last.value) / time_step;
        const double ahead = 0.5 * force * time_step * rate;
        work += multiplier[row] / time_step * 0.5 * (last.rate + rate) + ahead - last.ahead;
        reactions_[motion][c] += force;
        last = {target[row], rate, ahead, force};
      } else {
        last = {target[row], identity_ ? velocity[particle][c] : direction.interpolate(k, velocity, c), 0.0, 0.0};
      }
    }
  }
  if (share != nullptr) {
    std::vector<double> sums(1, work);
    for (const Vector3& reaction : reactions_) sums.insert(sums.end(), reaction.data(), reaction.data() + 3);
    share->reduce(sums, {});
    work = sums[0];
    for (std::size_t m = 0; m < reactions_.size(); ++m) reactions_[m] = Vector3(sums[3 * m + 1], sums[3 * m + 2], sums[3 * m + 3]);
  }
  return work;
}

TACTOID_INLINE StateRows EssentialConditions::condition_rows(int c, const CloudPart& part, RowShare* share) const {
  std::vector<double> keys;
  for (const auto& [particle, motion, place] : conditions(c)) keys.push_back(static_cast<double>(motion * part.whole + part.number[particle]));
  std::vector<double> all = share != nullptr ? share->join(keys) : keys;
  std::sort(all.begin(), all.end());
  StateRows rows{.size = keys.size(), .length = all.size(), .here = {}, .number = {}};
  for (std::size_t k = 0; k < keys.size(); ++k) rows.add(k, static_cast<std::size_t>(std::lower_bound(all.begin(), all.end(), keys[k]) - all.begin()));
  return rows;
}

TACTOID_INLINE double EssentialConditions::accept(double time, double time_step, const Field& holding, bool from_rest) {
  double work = 0.0;
  std::fill(reactions_.begin(), reactions_.end(), Vector3::Zero());
  std::fill(forces_.begin(), forces_.end(), Vector4::Zero());
  for_each_value([&](int c, std::size_t k, const Condition& condition) {
    auto& last = directions_[static_cast<std::size_t>(c)].last[k];
    const double value = prescribed(condition, time)[c], force = holding[condition.particle][c];
    work += 0.5 * ((from_rest ? force : last.force) + force) * (value - last.value);
    last = {value, time_step > 0.0 ? (value - last.value) / time_step : last.rate, 0.0, force};
    reactions_[condition.motion][c] += force;
    forces_[condition.particle][c] = force;
  });
  return work;
}

TACTOID_INLINE double EssentialConditions::Direction::interpolate(std::size_t k, const Field& u, int c) const {
  double sum = 0.0;
  for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(rows, static_cast<Eigen::Index>(k)); it; ++it)
    sum += it.value() * u[static_cast<std::size_t>(it.col())][c];
  return sum;
}

TACTOID_INLINE void EssentialConditions::factorize(Direction& direction, const ParticleValues& values) const {
  const ValueRows& all = values.rows();
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < direction.conditions.size(); ++k) {
    const Index particle = direction.conditions[k].particle;
    for (std::size_t e = all.offsets[particle]; e < all.offsets[particle + 1]; ++e)
      entries.emplace_back(static_cast<int>(k), static_cast<int>(all.particles[e]), all.values[e]);
  }
  direction.rows.resize(static_cast<Eigen::Index>(direction.conditions.size()), static_cast<Eigen::Index>(masses_->size()));
  direction.rows.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseMatrix<double, Eigen::RowMajor> scaled = direction.rows;
  for (Eigen::Index r = 0; r < scaled.outerSize(); ++r)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(scaled, r); it; ++it)
      it.valueRef() /= (*masses_)[static_cast<std::size_t>(it.col())];
  const Eigen::SparseMatrix<double> matrix = (scaled * direction.rows.transpose()).pruned();
  direction.solver = std::make_shared<Solver>(matrix);
  if (direction.solver->info() != Eigen::Success)
    throw ParameterError("PrescribedMotion: the conditions are not independent for the interpolated field; prescribe fewer particles.");
}

}  // namespace tactoid
