#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <mpi.h>

#include <tactoid/mpi/owned_values.hpp>
#include <tactoid/simulation/decomposition.hpp>

namespace tactoid::mpi {

/// The rank of each point: that of its chunk.
[[nodiscard]] inline std::vector<int> owners_of_points(const PointTable& table, const std::vector<int>& chunk_owner) {
  std::vector<int> owners(table.points(), 0);
  for (std::size_t c = 0; c < table.chunks.size(); ++c)
    for (std::size_t q = table.chunks[c].begin; q < table.chunks[c].end; ++q) owners[q] = chunk_owner[c];
  return owners;
}

/// The rank of each particle: where its first point is; of one without a point, where some row touches it. `touched` is as touched_particles gives it.
[[nodiscard]] inline std::vector<int> owners_of_particles(const PointTable& table, const std::vector<int>& chunk_owner, const std::vector<std::vector<Index>>& touched) {
  const std::vector<int> of_point = owners_of_points(table, chunk_owner);
  std::vector<int> owners(table.particles, -1);
  for (std::size_t q = 0; q < table.points(); ++q) {
    int& owner = owners[table.owner[q]];
    if (owner < 0) owner = of_point[q];
  }
  for (std::size_t c = 0; c < touched.size(); ++c)
    for (const Index i : touched[c])
      if (owners[i] < 0) owners[i] = chunk_owner[c];
  for (int& owner : owners) owner = std::max(owner, 0);
  return owners;
}

/// One body, divided among ranks: which rows this rank evaluates, and what it tells the others.
class PartOfBody final : public BodyShare {
 public:
  std::vector<int> point_owner;  ///< per point: the rank of its chunk
  std::vector<char> needed;      ///< per particle: 1 where a row that is evaluated here touches it

  /// Of a table that is about to get its rows, in the order of one process; follow_rows() completes it. A rank for each chunk and each particle, the same on all ranks;
  /// of a part of a cloud (`of`), only on this one. `ranks` must outlive it.
  PartOfBody(MPI_Comm ranks, const PointTable& table, std::vector<int> chunk_ranks, std::vector<int> particle_ranks, std::shared_ptr<const CloudPart> of = nullptr) : ranks_(ranks) {
    MPI_Comm_rank(ranks, &rank_);
    MPI_Comm_size(ranks, &size_);
    part = std::move(of);
    chunk_owner = std::move(chunk_ranks);
    particle_owner = std::move(particle_ranks);
    point_owner = owners_of_points(table, chunk_owner);
    if (!part) {
      chunk_values_ = OwnedValues(ranks, chunk_owner);
      summing_ = summing_ranks(particle_owner, size_);
    }
    for (Index i = 0; i < particle_owner.size(); ++i)
      if (particle_owner[i] == rank_) own.push_back(i);
    local.resize(particle_owner.size());
    std::iota(local.begin(), local.end(), Index{0});
  }
  /// Of a body that is composed. Collective.
  PartOfBody(MPI_Comm ranks, SumOrder sum_order, const SharedBody& body, std::vector<int> chunk_ranks, std::vector<int> particle_ranks, std::shared_ptr<const CloudPart> of = nullptr)
      : PartOfBody(ranks, *body.table, std::move(chunk_ranks), std::move(particle_ranks), std::move(of)) {
    order = sum_order;
    keep_rows_ = body.keep_rows;
    follow_rows(*body.table);
    local.clear();
    for (Index i = 0; i < body.table->particles; ++i)
      if (needed[i] || particle_owner[i] == rank_ || body.known_to_all[i]) local.push_back(i);
    if (order == SumOrder::of_ranks) find_ways_back(body);
  }

  /// Pairs of the rows that are evaluated here.
  [[nodiscard]] std::size_t evaluated_pairs(const PointTable& table) const {
    std::size_t pairs = 0;
    for (std::size_t q = 0; q < evaluated.size(); ++q)
      if (evaluated[q]) pairs += table.row(q).size();
    return pairs;
  }

  /// Lists of particles that this rank names to each other one, to which they belong, and gets: with the numbers that they have there. Collective.
  [[nodiscard]] std::vector<std::vector<Index>> named_by_others(std::vector<std::vector<Index>> lists) const {
    if (!part) return exchange_lists(ranks_, lists);
    for (auto& list : lists)
      for (Index& i : list) i = part->number[i];
    lists = exchange_lists(ranks_, lists);
    std::vector<Index> by_number = part->own;
    std::sort(by_number.begin(), by_number.end(), [&](Index a, Index b) { return part->number[a] < part->number[b]; });
    double strange = 0.0;  // particles that belong to another rank
    for (auto& list : lists)
      for (Index& i : list) {
        const auto at = std::lower_bound(by_number.begin(), by_number.end(), i, [&](Index a, Index number) { return part->number[a] < number; });
        if (at == by_number.end() || part->number[*at] != i) ++strange;
        else i = *at;
      }
    mpi::reduce(ranks_, {&strange, 1}, {});
    if (strange > 0.0) throw ParameterError(fmt::format("The parts of the cloud are not of one division: {:.0f} particles are said to belong to ranks that have them not.", strange));
    return lists;
  }

  [[nodiscard]] int rank() const override { return rank_; }
  void follow_rows(const PointTable& table) override {
    evaluated.assign(table.points(), 0);
    needed.assign(table.particles, 0);
    for (std::size_t q = 0; q < table.points(); ++q) {
      const auto row = table.row(q);
      evaluated[q] = point_owner[q] == rank_ || (order == SumOrder::of_one_process && std::any_of(row.begin(), row.end(), [&](const TableEntry& e) {
                       return particle_owner[e.particle] == rank_;
                     }));
      if (!evaluated[q]) continue;
      needed[table.owner[q]] = 1;
      for (const TableEntry& entry : row) needed[entry.particle] = 1;
    }
    here.clear();
    for (Index i = 0; i < table.particles; ++i)
      if (needed[i] || particle_owner[i] == rank_) here.push_back(i);
    ghosts_.reset();
  }
  void exchange(Field& field) override {
    if (!ghosts_) ghosts_ = from_owners(here);
    send(*ghosts_, field);
  }
  void complete(std::span<double> values) override {
    if (!part) return OwnedValues(ranks_, particle_owner).gather(values, 1);
    Field field(values.size(), Vector4::Zero());
    for (const Index i : own) field[i][0] = values[i];
    tell_all(field);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = field[i][0];
  }
  void tell_all(Field& field) override {
    if (!copies_) {
      std::vector<Index> all(particle_owner.size());
      std::iota(all.begin(), all.end(), Index{0});
      copies_ = from_owners(all);
    }
    send(*copies_, field);
  }
  [[nodiscard]] bool sums(std::size_t p) const override { return summing_[p] == rank_; }
  void bring_to_parts(Field& field) override {
    if (!to_parts_) {
      std::vector<std::vector<Index>> out = lists(), in = lists();
      for (std::size_t p = 0; p < sum_parts; ++p) {
        const auto [first, last] = sum_part(particle_owner.size(), p);
        for (std::size_t i = first; i < last; ++i) {
          if (particle_owner[i] == summing_[p]) continue;
          if (particle_owner[i] == rank_) out[static_cast<std::size_t>(summing_[p])].push_back(static_cast<Index>(i));
          if (summing_[p] == rank_) in[static_cast<std::size_t>(particle_owner[i])].push_back(static_cast<Index>(i));
        }
      }
      to_parts_ = std::make_unique<ParcelsToNeighbors>(ranks_, parcels_of(1, out), parcels_of(1, in));
    }
    send(*to_parts_, field);
  }
  void combine(std::span<double> values) override { mpi::combine(ranks_, values); }
  [[nodiscard]] std::vector<double> join(std::span<const double> list) override { return mpi::join(ranks_, list); }
  [[nodiscard]] std::size_t count_pairs(const PointTable& table) override {
    double pairs = 0.0;
    for (std::size_t q = 0; q < table.points(); ++q)
      if (point_owner[q] == rank_) pairs += static_cast<double>(table.row(q).size());
    reduce({&pairs, 1}, {});
    return static_cast<std::size_t>(pairs);
  }

  void drop_rows(PointTable& table) const override {
    if (keep_rows_) return;
    const std::size_t pairs = table.pairs();
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
  void gather_points(std::span<double> values, std::size_t per_point) override {
    if (!point_values_) point_values_ = std::make_unique<OwnedValues>(ranks_, point_owner);
    point_values_->gather(values, per_point);
  }

 private:
  /// One empty list for each rank.
  [[nodiscard]] std::vector<std::vector<Index>> lists() const { return std::vector<std::vector<Index>>(static_cast<std::size_t>(size_)); }
  /// Parcels of so many fields, which carry() names.
  [[nodiscard]] static std::vector<Parcel> parcels_of(std::size_t fields, const std::vector<std::vector<Index>>& lists) {
    std::vector<Parcel> parcels;
    for (const auto& list : lists) parcels.push_back({{Piece{std::vector<Field*>(fields, nullptr), list}}});
    return parcels;
  }
  /// One field of those particles that belong to other ranks, from these. Collective.
  [[nodiscard]] std::unique_ptr<ParcelsToNeighbors> from_owners(const std::vector<Index>& particles) const {
    std::vector<std::vector<Index>> asked = lists();
    for (const Index i : particles)
      if (particle_owner[i] != rank_) asked[static_cast<std::size_t>(particle_owner[i])].push_back(i);
    return std::make_unique<ParcelsToNeighbors>(ranks_, parcels_of(1, named_by_others(asked)), parcels_of(1, asked));
  }
  static void send(ParcelsToNeighbors& parcels, Field& field) {
    parcels.carry(std::array{&field});
    parcels.begin();
    parcels.end();
  }
  /// Which forces, and which rates of points, go to other ranks, and which come.
  void find_ways_back(const SharedBody& body) {
    std::vector<std::vector<Index>> particles = lists(), points = lists();
    for (Index i = 0; i < needed.size(); ++i)
      if (needed[i] && particle_owner[i] != rank_) {
        abroad.push_back(i);
        particles[static_cast<std::size_t>(particle_owner[i])].push_back(i);
      }
    for (Index q = 0; q < point_owner.size(); ++q) {
      const int particle = particle_owner[body.table->owner[q]];
      if (point_owner[q] == rank_ && particle != rank_) points[static_cast<std::size_t>(particle)].push_back(q);
    }
    const std::size_t fields = body.motion.size() - 1;  // forces belong to u and v, and a flux to the director
    back_ = std::make_unique<ParcelsToNeighbors>(ranks_, parcels_of(fields, particles), parcels_of(fields, named_by_others(particles)), Arrival::adds);
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
  int rank_ = 0, size_ = 1;
  bool keep_rows_ = false;
  OwnedValues chunk_values_;
  std::vector<int> summing_;                                // the rank of each part of a sum
  std::unique_ptr<OwnedValues> point_values_;               // made when it is first needed, as the next three
  std::unique_ptr<ParcelsToNeighbors> ghosts_, copies_, to_parts_;
  std::unique_ptr<ParcelsToNeighbors> back_;               // of forces
  std::vector<std::size_t> given_counts_, taken_counts_;  // per rank
  bool points_travel_ = false;                           // on any rank
};

}  // namespace tactoid::mpi
