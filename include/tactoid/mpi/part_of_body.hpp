#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <mpi.h>

#include <tactoid/mpi/owned_values.hpp>
#include <tactoid/simulation/decomposition.hpp>

namespace tactoid::mpi {

/// One body, divided among ranks: who owns which particle, and which rows this rank evaluates.
class PartOfBody final : public BodyShare {
 public:
  std::vector<int> particle_owner;  ///< per particle
  std::vector<int> point_owner;     ///< per point: the rank of its chunk
  std::vector<char> needed;         ///< per particle: 1 where a row that is evaluated here touches it

  /// Collective. `chunk_owner`: a rank per chunk; `touched` as touched_particles gives it. All the same on all ranks; `ranks` must outlive it.
  PartOfBody(MPI_Comm ranks, SumOrder sum_order, const SharedBody& body, const std::vector<int>& chunk_owner, const std::vector<std::vector<Index>>& touched)
      : ranks_(ranks), keep_rows_(body.keep_rows), chunk_values_(ranks, chunk_owner) {
    order = sum_order;
    int rank = 0;
    MPI_Comm_rank(ranks, &rank);
    const PointTable& table = *body.table;
    point_owner.assign(table.points(), 0);
    for (std::size_t c = 0; c < table.chunks.size(); ++c)
      for (std::size_t q = table.chunks[c].begin; q < table.chunks[c].end; ++q) point_owner[q] = chunk_owner[c];
    // A particle goes where its first point is; one without a point, where some row touches it.
    particle_owner.assign(table.particles, -1);
    for (std::size_t q = 0; q < table.points(); ++q) {
      int& owner = particle_owner[table.owner[q]];
      if (owner < 0) owner = point_owner[q];
    }
    for (std::size_t c = 0; c < touched.size(); ++c)
      for (const Index i : touched[c])
        if (particle_owner[i] < 0) particle_owner[i] = chunk_owner[c];
    for (int& owner : particle_owner) owner = std::max(owner, 0);

    evaluated.assign(table.points(), 0);
    needed.assign(table.particles, 0);
    for (std::size_t q = 0; q < table.points(); ++q) {
      const auto row = table.row(q);
      evaluated[q] = point_owner[q] == rank || (order == SumOrder::of_one_process && std::any_of(row.begin(), row.end(), [&](const TableEntry& e) {
                       return particle_owner[e.particle] == rank;
                     }));
      if (!evaluated[q]) continue;
      needed[table.owner[q]] = 1;
      for (const TableEntry& entry : row) needed[entry.particle] = 1;
    }
    for (Index i = 0; i < table.particles; ++i)
      if (needed[i] || particle_owner[i] == rank || body.known_to_all[i]) local.push_back(i);
    point_values_ = OwnedValues(ranks, point_owner);
    if (order == SumOrder::of_ranks) find_ways_back(body, rank);
  }

  /// Pairs of the rows that are evaluated here.
  [[nodiscard]] std::size_t evaluated_pairs(const PointTable& table) const {
    std::size_t pairs = 0;
    for (std::size_t q = 0; q < evaluated.size(); ++q)
      if (evaluated[q]) pairs += table.row(q).size();
    return pairs;
  }

  void drop_rows(PointTable& table) const override {
    if (keep_rows_) return;
    const std::size_t pairs = table.size();
    keep_evaluated(table.entries, table.offsets);
    keep_evaluated(table.single_entries, table.offsets);
    keep_evaluated(table.point_values, table.offsets);
    keep_evaluated(table.bond_weights, table.bond_offsets);
    close_up(table.offsets);
    close_up(table.bond_offsets);
    table.pairs_elsewhere = pairs - table.size();
  }
  void gather_chunks(std::span<double> values, std::size_t per_chunk) override { chunk_values_.gather(values, per_chunk); }
  void return_forces(std::span<Field* const> fields) override {
    back_->carry(fields);
    back_->begin();
    back_->end();
  }
  void exchange_points(std::span<const double> given, std::span<double> taken, std::size_t per_point) override {
    if (!points_travel_) return;
    const auto n = given_counts_.size();
    std::vector<int> out(n), out_places(n, 0), in(n), in_places(n, 0);
    for (std::size_t r = 0; r < n; ++r) {
      out[r] = as_count(given_counts_[r] * per_point), in[r] = as_count(taken_counts_[r] * per_point);
      if (r > 0) out_places[r] = out_places[r - 1] + out[r - 1], in_places[r] = in_places[r - 1] + in[r - 1];
    }
    MPI_Request request = MPI_REQUEST_NULL;
    succeeded(MPI_Ialltoallv(given.data(), out.data(), out_places.data(), MPI_DOUBLE, taken.data(), in.data(), in_places.data(), MPI_DOUBLE, ranks_, &request));
    wait(request);
  }
  void reduce(std::span<double> sums, std::span<double> maxima) override { mpi::reduce(ranks_, sums, maxima); }
  void gather_points(std::span<double> values, std::size_t per_point) override { point_values_.gather(values, per_point); }

 private:
  /// Which forces, and which rates of points, go to other ranks, and which come.
  void find_ways_back(const SharedBody& body, int rank) {
    int size = 1;
    MPI_Comm_size(ranks_, &size);
    std::vector<std::vector<Index>> particles(static_cast<std::size_t>(size)), points(particles);
    for (Index i = 0; i < needed.size(); ++i)
      if (needed[i] && particle_owner[i] != rank) {
        abroad.push_back(i);
        particles[static_cast<std::size_t>(particle_owner[i])].push_back(i);
      }
    for (Index q = 0; q < point_owner.size(); ++q) {
      const int particle = particle_owner[body.table->owner[q]];
      if (point_owner[q] == rank && particle != rank) points[static_cast<std::size_t>(particle)].push_back(q);
    }
    const std::size_t fields = body.motion.size() - 1;  // forces belong to u and v, and a flux to the director
    const auto parcels = [&](const std::vector<std::vector<Index>>& lists) {
      std::vector<Parcel> result;
      for (const auto& list : lists) result.push_back({{Piece{std::vector<Field*>(fields, nullptr), list}}});
      return result;
    };
    back_ = std::make_unique<ParcelsToNeighbors>(ranks_, parcels(particles), parcels(exchange_lists(ranks_, particles)), Arrival::adds);
    const auto arriving = exchange_lists(ranks_, points);
    for (const auto& list : points) given_counts_.push_back(list.size()), given_points.insert(given_points.end(), list.begin(), list.end());
    for (const auto& list : arriving) taken_counts_.push_back(list.size()), taken_points.insert(taken_points.end(), list.begin(), list.end());
    double travelling = static_cast<double>(given_points.size());
    mpi::reduce(ranks_, {&travelling, 1}, {});
    points_travel_ = travelling > 0.0;
  }
  /// Of a list with the rows that `offsets` tell of, those that are evaluated here.
  template <class T>
  void keep_evaluated(std::vector<T>& list, const std::vector<std::size_t>& offsets) const {
    if (list.empty()) return;
    std::size_t kept = 0;
    for (std::size_t q = 0; q < evaluated.size(); ++q)
      if (evaluated[q])
        for (std::size_t e = offsets[q]; e < offsets[q + 1]; ++e, ++kept) list[kept] = list[e];
    list.resize(kept);
    list.shrink_to_fit();
  }
  /// And the offsets of the rows that are left; the others are empty.
  void close_up(std::vector<std::size_t>& offsets) const {
    if (offsets.empty()) return;
    std::size_t begin = offsets[0], kept = 0;
    for (std::size_t q = 0; q < evaluated.size(); ++q) {
      const std::size_t end = offsets[q + 1];
      if (evaluated[q]) kept += end - begin;
      begin = end;
      offsets[q + 1] = kept;
    }
  }

  MPI_Comm ranks_;
  bool keep_rows_;
  OwnedValues chunk_values_, point_values_;
  std::unique_ptr<ParcelsToNeighbors> back_;             // of forces
  std::vector<std::size_t> given_counts_, taken_counts_;  // per rank
  bool points_travel_ = false;                           // on any rank
};

}  // namespace tactoid::mpi
