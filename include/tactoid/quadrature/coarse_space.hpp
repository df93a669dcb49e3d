#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <tactoid/core/parallel.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/quadrature/point_table.hpp>
#include <tactoid/quadrature/row_share.hpp>

namespace tactoid::detail {

/// Smooth fields of a body, in few unknowns: quadratic B-splines on a regular grid around its particles, several spacings wide.
/// They hold the affine functions exactly.
class CoarseSpace {
 public:
  /// Grid cells of about `particles_per_cell` particles, larger ones where there would be more than `max_nodes` nodes. `share` is null where this process has all particles.
  CoarseSpace(const PointTable& table, double particles_per_cell, std::size_t max_nodes, RowShare* share);

  [[nodiscard]] std::size_t size() const { return nodes_; }  ///< number of splines

  /// Coefficients of the affine functions that are periodic as the body is, of the nodes where `used` is not 0, orthonormal: a column for each.
  [[nodiscard]] Eigen::MatrixXd affine(const Eigen::VectorXd& used) const;

  /// The splines that do not vanish at a place: 3 in every direction.
  struct Splines {
    int first[3] = {0, 0, 0};  ///< number of the first one in each direction
    double value[3][3] = {{1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  };
  [[nodiscard]] Splines at(const Vector3& X) const;
  /// f(node, value) for each of them.
  template <class F>
  void for_each(const Splines& splines, const F& f) const {
    for (int c = 0; c < (dimension_ > 2 ? 3 : 1); ++c)
      for (int b = 0; b < (dimension_ > 1 ? 3 : 1); ++b) {
        const int row = count_[0] * (wrapped(1, splines.first[1] + b) + count_[1] * wrapped(2, splines.first[2] + c));
        const double value = splines.value[1][b] * splines.value[2][c];
        for (int a = 0; a < 3; ++a)
          f(static_cast<std::size_t>(row + wrapped(0, splines.first[0] + a)), splines.value[0][a] * value);
      }
  }

 private:
  [[nodiscard]] int wrapped(int k, int i) const { return i < count_[k] ? i : i - count_[k]; }

  int dimension_;
  Vector3 origin_ = Vector3::Zero();
  double length_[3] = {1.0, 1.0, 1.0};
  int cells_[3] = {1, 1, 1}, count_[3] = {1, 1, 1};
  bool periodic_[3] = {false, false, false};
  std::size_t nodes_ = 0;
};

/// Rows that stand for all of a table: smooth fields feel neighbouring rows alike.
template <class Operator>
struct SampledRows {
  const Operator& S;          ///< AffineResidual of the rows
  const PointTable& table;    ///< that they are of
  std::vector<Index> points;  ///< of that table, ascending
  double weight = 1.0;        ///< for how many rows each stands
};
/// The first of every `step` numbers of a list.
[[nodiscard]] inline std::vector<Index> every(std::size_t step, const std::vector<Index>& list) {
  std::vector<Index> chosen;
  for (std::size_t k = 0; k < list.size(); k += step) chosen.push_back(list[k]);
  return chosen;
}

/// The part of a preconditioner that acts on smooth fields: P E⁻¹ Pᵀ, with P from splines to particles and E near Pᵀ S P, between
/// projections that leave out the affine functions: these are in the null space of S, where E⁻¹ would make much of round-off.
/// Several processes make the same E, each for itself, and add up Pᵀ r together; where each has a part of the cloud, they add up E, too.
class CoarseCorrection {
 public:
  /// Of the operator S of a table; `share` is null where this process has all of its rows.
  template <class Operator>
  CoarseCorrection(const PointTable& table, const SampledRows<Operator>& rows, RowShare* share)
      : table_(table), share_(share), space_(table, particles_per_cell, most_nodes, share), coarse_(space_.size()) {
    if (share == nullptr)
      for (const Vector4& X : table.particle_position) splines_.push_back(space_.at(X.head<3>()));
    Couplings E = assemble(rows);
    if (in_parts()) add_up(E);
    factorize(E);
    affine_ = space_.affine(scale_);
    find_parts();
  }

  [[nodiscard]] bool usable() const { return solver_.info() == Eigen::Success; }  ///< E could be factorised

  /// z ← z + P E⁻¹ Pᵀ r, all three components, at the particles of this process. Of r, which several processes share, the values at other particles are lost.
  void add(Field& r, Field& z);

 private:
  using Factor = Eigen::SparseMatrix<double>;
  /// Of each node those that are coupled to it and have no smaller number, itself included, in no order.
  using Couplings = std::vector<std::vector<std::pair<int, double>>>;
  static constexpr double particles_per_cell = 64.0;
  static constexpr std::size_t most_nodes = 6000;
  static constexpr double regularization = 1e-6;  // of E, over its diagonal: affine functions are in its null space

  [[nodiscard]] bool in_parts() const { return share_ != nullptr && share_->part; }
  /// Particles that are added up here: all of them, unless they are in parts.
  [[nodiscard]] OwnParticles summed() const { return {in_parts() ? share_ : nullptr, table_.particles}; }
  void add_up(Couplings& E) const;
  void take_off_affine();
  void find_parts();
  /// Those at particle i.
  [[nodiscard]] CoarseSpace::Splines splines(std::size_t i) const { return splines_.empty() ? space_.at(table_.particle_position[i].head<3>()) : splines_[i]; }

  template <class Operator>
  [[nodiscard]] Couplings assemble(const SampledRows<Operator>& rows) const {
    Couplings E(space_.size());
    std::vector<std::size_t> place(space_.size(), 0);  // of a node among the couplings of another
    std::vector<int> local(space_.size(), -1);         // number of a node in the row
    std::vector<int> nodes;
    std::vector<double> block;          // Pᵀ W P of the row
    std::vector<Vector4> fits;          // Pᵀ W B
    std::array<std::pair<int, double>, 27> of_particle;
    for (const Index q : rows.points) {
      nodes.clear();
      rows.S.for_each_weighted(q, [&](Index particle, double, const Vector4&) {
        space_.for_each(splines(particle), [&](std::size_t node, double) {
          if (local[node] < 0) local[node] = static_cast<int>(nodes.size()), nodes.push_back(static_cast<int>(node));
        });
      });
      const std::size_t m = nodes.size();
      block.assign(m * m, 0.0);
      fits.assign(m, Vector4::Zero());
      rows.S.for_each_weighted(q, [&](Index particle, double w, const Vector4& basis) {
        std::size_t count = 0;
        space_.for_each(splines(particle), [&](std::size_t node, double value) { of_particle[count++] = {local[node], value}; });
        for (std::size_t a = 0; a < count; ++a) {
          const double weighted = w * of_particle[a].second;
          fits[static_cast<std::size_t>(of_particle[a].first)] += weighted * basis;
          double* row = block.data() + static_cast<std::size_t>(of_particle[a].first) * m;
          for (std::size_t b = 0; b < count; ++b) row[of_particle[b].first] += weighted * of_particle[b].second;
        }
      });
      const double factor = rows.weight * rows.table.volume[q] * rows.table.volume[q];
      for (std::size_t a = 0; a < m; ++a) {
        auto& coupled = E[static_cast<std::size_t>(nodes[a])];
        for (std::size_t k = 0; k < coupled.size(); ++k) place[static_cast<std::size_t>(coupled[k].first)] = k;
        for (std::size_t b = 0; b < m; ++b) {
          if (nodes[b] < nodes[a]) continue;
          std::size_t& k = place[static_cast<std::size_t>(nodes[b])];
          if (k >= coupled.size() || coupled[k].first != nodes[b]) {
            k = coupled.size();
            coupled.emplace_back(nodes[b], 0.0);
          }
          coupled[k].second += factor * (block[a * m + b] - fits[a].dot(fits[b]));
        }
      }
      for (const int node : nodes) local[static_cast<std::size_t>(node)] = -1;
    }
    return E;
  }

  /// E x = coarse_, all components in one sweep over the factors.
  void solve();

  void factorize(const Couplings& E);

  const PointTable& table_;
  RowShare* share_;
  CoarseSpace space_;
  std::vector<CoarseSpace::Splines> splines_;  // of the particles; empty where they are made anew each time
  Eigen::MatrixXd affine_;
  Eigen::VectorXd scale_;
  Field coarse_, ordered_;  // values at the nodes, in their order and in that of the factors
  std::vector<Index> part_nodes_;          // that the particles of each part of a sum (sum_part) reach, part after part
  std::vector<std::size_t> part_offsets_;  // of each part in them
  std::vector<std::vector<int>> part_places_;  // of each part that is summed here, and each node: where it is in part_nodes_, or −1
  Field part_sums_;                            // beside part_nodes_
  Eigen::SimplicialLDLT<Factor> solver_;
};

}  // namespace tactoid::detail

#if !defined(TACTOID_COMPILED)
#include <tactoid/quadrature/coarse_space.ipp>
#endif
