#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
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

  /// `chunk_owner`: a rank per chunk; `touched` as touched_particles gives it. All the same on all ranks; `ranks` must outlive it.
  PartOfBody(MPI_Comm ranks, const SharedBody& body, const std::vector<int>& chunk_owner, const std::vector<std::vector<Index>>& touched)
      : keep_rows_(body.keep_rows), chunk_values_(ranks, chunk_owner) {
    int rank = 0;
    MPI_Comm_rank(ranks, &rank);
    const PointTable& table = *body.table;
    point_owner.assign(table.points(), 0);
    for (std::size_t c = 0; c < table.chunks.size(); ++c) {
      own_chunk.push_back(chunk_owner[c] == rank ? 1 : 0);
      for (std::size_t q = table.chunks[c].begin; q < table.chunks[c].end; ++q) point_owner[q] = chunk_owner[c];
    }
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
      evaluated[q] = point_owner[q] == rank || std::any_of(row.begin(), row.end(), [&](const TableEntry& e) { return particle_owner[e.particle] == rank; });
      if (!evaluated[q]) continue;
      needed[table.owner[q]] = 1;
      for (const TableEntry& entry : row) needed[entry.particle] = 1;
    }
    for (Index i = 0; i < table.particles; ++i)
      if (needed[i] || particle_owner[i] == rank || body.known_to_all[i]) local.push_back(i);
    point_values_ = OwnedValues(ranks, point_owner);
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
    const std::vector<std::size_t> rows = std::exchange(table.offsets, {0}), bonds = table.bond_offsets;
    table.offsets.reserve(rows.size());
    if (!bonds.empty()) table.bond_offsets.assign(1, 0);
    std::size_t kept = 0, kept_bonds = 0;
    for (std::size_t q = 0; q + 1 < rows.size(); ++q) {
      if (evaluated[q]) {
        for (std::size_t e = rows[q]; e < rows[q + 1]; ++e, ++kept) {
          if (table.single_entries.empty()) table.entries[kept] = table.entries[e];
          else table.single_entries[kept] = table.single_entries[e];
          if (!table.point_values.empty()) table.point_values[kept] = table.point_values[e];
        }
        if (!bonds.empty())
          for (std::size_t e = bonds[q]; e < bonds[q + 1]; ++e, ++kept_bonds) table.bond_weights[kept_bonds] = table.bond_weights[e];
      }
      table.offsets.push_back(kept);
      if (!bonds.empty()) table.bond_offsets.push_back(kept_bonds);
    }
    (table.single_entries.empty() ? table.entries.resize(kept) : table.single_entries.resize(kept));
    table.entries.shrink_to_fit();
    table.single_entries.shrink_to_fit();
    if (!table.point_values.empty()) table.point_values.resize(kept);
    table.point_values.shrink_to_fit();
    if (!bonds.empty()) table.bond_weights.resize(kept_bonds);
    table.bond_weights.shrink_to_fit();
    table.pairs_elsewhere = pairs - kept;
  }
  void gather_chunks(std::span<double> values, std::size_t per_chunk) override { chunk_values_.gather(values, per_chunk); }
  void gather_points(std::span<double> values, std::size_t per_point) override { point_values_.gather(values, per_point); }

 private:
  bool keep_rows_;
  OwnedValues chunk_values_, point_values_;
};

}  // namespace tactoid::mpi
