#pragma once

#include <map>

#include <tactoid/core/compiled.hpp>
#include <tactoid/quadrature/coarse_space.hpp>

namespace tactoid::detail {

TACTOID_INLINE CoarseSpace::CoarseSpace(const PointTable& table, double particles_per_cell, std::size_t max_nodes, RowShare* share)
    : dimension_(table.dimension) {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vector4& X : table.particle_position) {
    low = low.cwiseMin(X.head<3>());
    high = high.cwiseMax(X.head<3>());
  }
  double particles = static_cast<double>(table.particles);
  if (share != nullptr && share->part) {
    particles = static_cast<double>(share->part->whole);
    low = -low;
    share->reduce({}, {low.data(), 3});
    share->reduce({}, {high.data(), 3});
    low = -low;
  }
  double box = 1.0;
  for (int k = 0; k < dimension_; ++k) {
    periodic_[k] = table.period[k] > 0.0;
    length_[k] = periodic_[k] ? table.period[k] : high[k] - low[k];
    box *= length_[k];
  }
  origin_ = low;
  double width = std::pow(box * particles_per_cell / particles, 1.0 / dimension_);
  do {
    nodes_ = 1;
    for (int k = 0; k < dimension_; ++k) {
      cells_[k] = std::max(periodic_[k] ? 3 : 1, static_cast<int>(std::lround(length_[k] / width)));
      count_[k] = cells_[k] + (periodic_[k] ? 0 : 2);
      nodes_ *= static_cast<std::size_t>(count_[k]);
    }
    width *= 1.1;
  } while (nodes_ > max_nodes && cells_[0] * cells_[1] * cells_[2] > 1);
}

TACTOID_INLINE Eigen::MatrixXd CoarseSpace::affine(const Eigen::VectorXd& used) const {
  int columns = 1;
  Eigen::MatrixXd A = Eigen::MatrixXd::Ones(static_cast<Eigen::Index>(nodes_), 4);
  for (int k = 0; k < dimension_; ++k)
    if (!periodic_[k]) {
      const std::size_t stride = static_cast<std::size_t>(k == 0 ? 1 : k == 1 ? count_[0] : count_[0] * count_[1]);
      for (std::size_t i = 0; i < nodes_; ++i) A(static_cast<Eigen::Index>(i), columns) = static_cast<double>(i / stride % static_cast<std::size_t>(count_[k]));
      ++columns;
    }
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    if (used[i] == 0.0) A.row(i).setZero();
  for (int j = 0; j < columns; ++j) {
    for (int k = 0; k < j; ++k) A.col(j) -= A.col(k).dot(A.col(j)) * A.col(k);
    A.col(j) /= A.col(j).norm();
  }
  return A.leftCols(columns);
}

TACTOID_INLINE CoarseSpace::Splines CoarseSpace::at(const Vector3& X) const {
  Splines splines;
  for (int k = 0; k < dimension_; ++k) {
    double s = (X[k] - origin_[k]) / length_[k] * cells_[k];
    if (periodic_[k]) s -= cells_[k] * std::floor(s / cells_[k]);
    splines.first[k] = std::clamp(static_cast<int>(s), 0, cells_[k] - 1);
    const double t = s - splines.first[k];
    splines.value[k][0] = 0.5 * (1.0 - t) * (1.0 - t);
    splines.value[k][1] = 0.5 + t * (1.0 - t);
    splines.value[k][2] = 0.5 * t * t;
  }
  return splines;
}

TACTOID_INLINE void CoarseCorrection::add_up(Couplings& E) const {
  std::vector<double> list;  // node, node, value
  for (std::size_t a = 0; a < E.size(); ++a)
    for (const auto& [b, value] : E[a]) list.insert(list.end(), {static_cast<double>(a), static_cast<double>(b), value});
  list = share_->join(list);
  std::vector<std::map<int, double>> sums(E.size());
  for (std::size_t k = 0; k < list.size(); k += 3) sums[static_cast<std::size_t>(list[k])][static_cast<int>(list[k + 1])] += list[k + 2];
  for (std::size_t a = 0; a < E.size(); ++a) E[a].assign(sums[a].begin(), sums[a].end());
}

TACTOID_INLINE void CoarseCorrection::find_parts() {
  std::vector<std::vector<int>> places(sum_parts, std::vector<int>(space_.size(), -1));
  parallel_for(sum_parts, [&](std::size_t p) {
    const auto [first, last] = sum_part(summed().size(), p);
    for (std::size_t k = first; k < last; ++k) space_.for_each(splines(summed()[k]), [&](std::size_t node, double) { places[p][node] = 0; });
  });
  part_offsets_.assign(1, 0);
  part_places_.resize(sum_parts);
  for (std::size_t p = 0; p < sum_parts; ++p) {
    for (Index node = 0; node < space_.size(); ++node)
      if (places[p][node] == 0) {
        places[p][node] = static_cast<int>(part_nodes_.size());
        part_nodes_.push_back(node);
      }
    part_offsets_.push_back(part_nodes_.size());
    if (share_ == nullptr || in_parts() || share_->sums(p)) part_places_[p] = std::move(places[p]);
  }
  part_sums_.resize(part_nodes_.size());
}

TACTOID_INLINE void CoarseCorrection::add(Field& r, Field& z) {
  const bool together = share_ != nullptr && !in_parts();
  if (together) share_->bring_to_parts(r);
  parallel_for(sum_parts, [&](std::size_t p) {
    std::fill(part_sums_.begin() + static_cast<std::ptrdiff_t>(part_offsets_[p]), part_sums_.begin() + static_cast<std::ptrdiff_t>(part_offsets_[p + 1]), Vector4::Zero());
    if (part_places_[p].empty()) return;
    const OwnParticles particles = summed();
    const auto [first, last] = sum_part(particles.size(), p);
    for (std::size_t k = first; k < last; ++k) {
      const std::size_t i = particles[k];
      space_.for_each(splines(i), [&](std::size_t node, double value) { part_sums_[static_cast<std::size_t>(part_places_[p][node])] += value * r[i]; });
    }
  });
  if (together) share_->combine({part_sums_[0].data(), 4 * part_sums_.size()});
  std::fill(coarse_.begin(), coarse_.end(), Vector4::Zero());
  for (std::size_t k = 0; k < part_nodes_.size(); ++k) coarse_[part_nodes_[k]] += part_sums_[k];
  if (in_parts()) share_->combine({coarse_[0].data(), 4 * coarse_.size()});
  take_off_affine();
  solve();
  take_off_affine();
  const auto correct = [&](std::size_t i) {
    Vector4 sum = z[i];
    space_.for_each(splines(i), [&](std::size_t node, double value) { sum += value * coarse_[node]; });
    z[i] = sum;
  };
  const OwnParticles own(share_, z.size());
  parallel_for(own.size(), [&](std::size_t k) { correct(own[k]); });
}

TACTOID_INLINE void CoarseCorrection::take_off_affine() {
  for (Eigen::Index k = 0; k < affine_.cols(); ++k) {
    Vector4 part = Vector4::Zero();
    for (std::size_t i = 0; i < coarse_.size(); ++i) part += affine_(static_cast<Eigen::Index>(i), k) * coarse_[i];
    for (std::size_t i = 0; i < coarse_.size(); ++i) coarse_[i] -= affine_(static_cast<Eigen::Index>(i), k) * part;
  }
}

TACTOID_INLINE void CoarseCorrection::solve() {
  const auto& order = solver_.permutationP().indices();
  const auto& L = solver_.matrixL().nestedExpression();
  const auto& D = solver_.vectorD();
  const auto n = static_cast<Eigen::Index>(coarse_.size());
  ordered_.resize(coarse_.size());
  const auto x = [&](Eigen::Index i) -> Vector4& { return ordered_[static_cast<std::size_t>(i)]; };
  for (Eigen::Index i = 0; i < n; ++i) x(order[i]) = scale_[i] * coarse_[static_cast<std::size_t>(i)];
  for (Eigen::Index j = 0; j < n; ++j) {
    const Vector4 known = x(j);
    for (Factor::InnerIterator it(L, j); it; ++it)
      if (it.row() > j) x(it.row()) -= it.value() * known;
  }
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    Vector4 sum = x(j) / D[j];
    for (Factor::InnerIterator it(L, j); it; ++it)
      if (it.row() > j) sum -= it.value() * x(it.row());
    x(j) = sum;
  }
  for (Eigen::Index i = 0; i < n; ++i) coarse_[static_cast<std::size_t>(i)] = scale_[i] * x(order[i]);
}

TACTOID_INLINE void CoarseCorrection::factorize(const Couplings& E) {
  const auto n = static_cast<Eigen::Index>(E.size());
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (const auto& [i, value] : E[static_cast<std::size_t>(j)])
      if (i == j) diagonal[j] = value;
  const double largest = diagonal.maxCoeff();
  // Splines that reach hardly any particle are left out.
  scale_ = diagonal.unaryExpr([&](double d) { return d > 1e-2 * largest ? 1.0 / std::sqrt(d) : 0.0; });
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index j = 0; j < n; ++j) {
    entries.emplace_back(static_cast<int>(j), static_cast<int>(j), 1.0 + regularization);
    for (const auto& [i, e] : E[static_cast<std::size_t>(j)]) {
      const double value = scale_[i] * e * scale_[j];
      if (i != j && value != 0.0) entries.emplace_back(i, static_cast<int>(j), value);
    }
  }
  Factor scaled(n, n);
  scaled.setFromTriplets(entries.begin(), entries.end());
  solver_.compute(scaled);
}

}  // namespace tactoid::detail
