#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <tactoid/core/pages.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/quadrature/point_table.hpp>

namespace tactoid {

/// A table before it has rows, as all ranks know it.
struct TableOutline {
  const PointTable* table = nullptr;        ///< with its points and coloured chunks
  std::vector<std::vector<Index>> touched;  ///< per chunk: the particles of its rows, ascending
  std::vector<double> cost;                 ///< of a step, per chunk, in pairs
};

/// The rows of a table that this rank makes, or evaluates. Each chunk of points belongs to one rank, and each particle too. Numbers of particles and points are those of the
/// table: of the whole body; or, where the rank has a part of the cloud, of that, and nobody has the whole.
class RowShare {
 public:
  RowShare() = default;
  RowShare(const RowShare&) = delete;
  RowShare& operator=(const RowShare&) = delete;
  virtual ~RowShare() = default;

  std::shared_ptr<const CloudPart> part;  ///< of the cloud that this rank has; null: all have the whole
  std::vector<int> chunk_owner;     ///< per chunk: its rank; where the rank has a part, those of other ranks are all −1
  std::vector<int> particle_owner;  ///< per particle: its rank
  std::vector<char> evaluated;      ///< per point: 1 where the row is here
  std::vector<Index> own;           ///< particles of this rank, ascending
  std::vector<Index> here;          ///< those, and what the rows that are here touch; ascending

  /// Takes note of the rows that a table has. Collective.
  virtual void follow_rows(const PointTable& table) = 0;
  /// What this rank is.
  [[nodiscard]] virtual int rank() const = 0;
  /// Tells the values of own particles to the ranks whose rows touch them, three components. Collective.
  virtual void exchange(Field& field) = 0;
  /// Tells the values of own particles to all ranks that have them, three components; where each has a part of the cloud. Collective.
  virtual void tell_all(Field& field) = 0;
  /// Tells the values of own particles to all ranks that have them. Collective.
  virtual void complete(std::span<double> values) = 0;
  /// Whether this rank adds up part p of sums over the particles of the whole (sum_part).
  [[nodiscard]] virtual bool sums(std::size_t p) const = 0;
  /// Tells the values of own particles to the ranks that add up their parts, three components. Collective.
  virtual void bring_to_parts(Field& field) = 0;
  /// Sums over the ranks, in any order: of numbers that all but one of them give as 0 they are exact. Collective.
  virtual void combine(std::span<double> values) = 0;
  /// Sums and maxima over the ranks, of what each gives; sums rank after rank. Collective.
  virtual void reduce(std::span<double> sums, std::span<double> maxima) = 0;
  /// The largest of the numbers that the ranks give. Collective.
  [[nodiscard]] double largest(double number) {
    reduce({}, {&number, 1});
    return number;
  }
  /// The sum of the numbers that the ranks give. Collective.
  [[nodiscard]] double sum(double number) {
    reduce({&number, 1}, {});
    return number;
  }
  /// The lists of all ranks, one behind the other. Collective.
  [[nodiscard]] virtual std::vector<double> join(std::span<const double> list) = 0;
  /// Entries of the rows of all ranks, each row once. Collective.
  [[nodiscard]] virtual std::size_t count_pairs(const PointTable& table) = 0;
};

/// The particles of a table that belong to this process.
class OwnParticles {
 public:
  /// Of `particles` particles; `share` is null where all of them belong to this process.
  OwnParticles(const RowShare* share, std::size_t particles) : own_(share != nullptr ? &share->own : nullptr), size_(share != nullptr ? share->own.size() : particles) {}
  [[nodiscard]] std::size_t size() const { return size_; }                                               ///< how many
  [[nodiscard]] std::size_t operator[](std::size_t k) const { return own_ != nullptr ? (*own_)[k] : k; }  ///< number of the particle

 private:
  const std::vector<Index>* own_;
  std::size_t size_;
};

/// Sums over the particles of a table that one process or several have: with the same bits, but for bodies of which each process has a part of the cloud.
class ParticleSums {
 public:
  /// Of `particles` particles; `share` is null where this process has all of them.
  ParticleSums(RowShare* share, std::size_t particles) : share_(share), particles_(particles), own_(share, particles) {
    if (share == nullptr || share->part) return;
    terms_.assign(particles, Vector4::Zero());
    give_back_unused(terms_, share->own);
  }
  /// Σ_i term(i), a Vector4 of which three components count where there are several processes. Collective.
  template <class Term>
  [[nodiscard]] Vector4 operator()(const Term& term) {
    const auto zero = Vector4(Vector4::Zero());
    if (share_ == nullptr) return parallel_sum(particles_, [&](std::size_t i) -> Vector4 { return term(i); }, zero);
    if (share_->part) {
      Vector4 sum = parallel_sum(own_.size(), [&](std::size_t k) -> Vector4 { return term(own_[k]); }, zero);
      share_->reduce({sum.data(), 4}, {});
      return sum;
    }
    for_each_own([&](std::size_t i) { terms_[i] = term(i); });
    share_->bring_to_parts(terms_);
    std::array<Vector4, sum_parts> parts;
    parallel_for(sum_parts, [&](std::size_t p) {
      parts[p].setZero();
      if (!share_->sums(p)) return;
      const auto [first, last] = sum_part(particles_, p);
      for (std::size_t i = first; i < last; ++i) parts[p] += terms_[i];
    });
    share_->combine({parts[0].data(), 4 * sum_parts});
    Vector4 total = zero;
    for (const Vector4& part : parts) total += part;
    return total;
  }
  /// Calls f(i) for the particles of this process, on all threads.
  template <class F>
  void for_each_own(const F& f) const {
    parallel_for(own_.size(), [&](std::size_t k) { f(own_[k]); });
  }

 private:
  RowShare* share_;
  std::size_t particles_;
  OwnParticles own_;
  Field terms_;
};

}  // namespace tactoid
