#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <mpi.h>

#include <tactoid/core/fingerprint.hpp>
#include <tactoid/mpi/chunk_graph.hpp>
#include <tactoid/mpi/owned_values.hpp>
#include <tactoid/mpi/parcels.hpp>
#include <tactoid/mpi/part_of_body.hpp>
#include <tactoid/simulation/decomposition.hpp>

namespace tactoid::mpi {

/// The bodies of a simulation, divided among ranks. Every rank has composed all of them, whole or but for the rows of other ranks; rank 0 partitions.
class DividedBodies final : public Decomposition {
 public:
  /// Collective. Throws ParameterError on all ranks where these have not composed the same bodies.
  DividedBodies(Ranks& ranks, MPI_Comm comm, std::vector<SharedBody> bodies, const Partitioner& partitioner)
      : ranks_(ranks), comm_(comm), bodies_(std::move(bodies)) {
    require_same_bodies();
    std::vector<std::vector<std::vector<Index>>> touched(bodies_.size());
    ChunkGraph graph;  // of the bodies that every rank has made whole
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (bodies_[b].made != nullptr) continue;
      touched[b] = touched_particles(*bodies_[b].table);
      add_chunks(graph, bodies_[b].table->particles, touched[b], costs_of_chunks(bodies_[b]));
    }
    const std::vector<int> owner = graph.size() > 0 ? partition(ranks_, graph, partitioner) : std::vector<int>();
    auto next = owner.begin();
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const PointTable& table = *bodies_[b].table;
      if (const RowShare* made = bodies_[b].made; made != nullptr) {
        parts_.push_back(std::make_shared<PartOfBody>(comm_, ranks_.sum_order, bodies_[b], made->chunk_owner, made->particle_owner, bodies_[b].part));
      } else {
        const auto begin = std::exchange(next, next + static_cast<std::ptrdiff_t>(table.chunks.size()));
        const std::vector<int> of_chunks(begin, next);
        parts_.push_back(std::make_shared<PartOfBody>(comm_, ranks_.sum_order, bodies_[b], of_chunks, owners_of_particles(table, of_chunks, touched[b])));
      }
      if (ranks_.sum_order == SumOrder::of_ranks) sums_.emplace_back(SumByRank(comm_, parts_.back()->own));
      else sums_.emplace_back(SumInOrder(comm_, parts_.back()->particle_owner));
      evaluated_pairs_ += parts_.back()->evaluated_pairs(table);
    }
    const auto is_known = [](const SharedBody& body, Index i) { return body.known_to_all[i] != 0; };
    known_ = std::make_unique<ParcelsToAll>(comm_, parcels_of_owners(&SharedBody::known, is_known));
    find_neighbors();
    for (SharedBody& body : bodies_) body.made = nullptr;  // its body gets the share that is here
  }
  ~DividedBodies() override { finish_exchange(); }

  [[nodiscard]] std::shared_ptr<BodyShare> share(std::size_t body) const override { return parts_[body]; }
  [[nodiscard]] const std::vector<int>& owners(std::size_t body) const override { return parts_[body]->particle_owner; }

  void begin_exchange() override {
    finish_exchange();
    neighbors_->begin();
    exchanging_ = true;
    known_->begin();
    known_->end();
  }
  void end_exchange() override {
    neighbors_->end();
    exchanging_ = false;
  }
  void complete() override {
    if (!whole_) whole_ = std::make_unique<ParcelsToAll>(comm_, parcels_of_owners(&SharedBody::whole, [](const SharedBody& body, Index) { return body.part == nullptr; }));
    whole_->begin();
    whole_->end();
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (parts_[b]->part)
        for (Field* field : bodies_[b].whole) parts_[b]->tell_all(*field);
    // Buffers of whole bodies would be most of what a rank holds; implicit steps ask for them all the time.
    if (std::none_of(bodies_.begin(), bodies_.end(), [](const SharedBody& body) { return body.keep_rows; })) whole_.reset();
  }
  [[nodiscard]] double sum(std::size_t body, std::span<const double> terms) override { return sums_[body](terms); }
  [[nodiscard]] std::string told_by_owner(std::size_t body, std::size_t point, const std::string& text) override {
    const int owner = parts_[body]->point_owner[point];
    return "rank " + std::to_string(owner) + ": " + ranks_.text_of(owner, text);
  }

  /// Pairs that this rank evaluates in every step, those that another rank evaluates, too, included.
  [[nodiscard]] std::size_t evaluated_pairs() const { return evaluated_pairs_; }
  /// Numbers of the motion that this rank sends to its neighbours in every step; forces that go back are not counted.
  [[nodiscard]] std::size_t sent_to_neighbors() const { return neighbors_->sent(); }

 private:
  /// A hash of what every rank must have composed alike: volumes, gradients, and the state; of a body whose rows each has made for itself, what it needs no rows for; of one of which each has
  /// a part, how many particles it has.
  void require_same_bodies() {
    Fingerprint fingerprint;
    for (const SharedBody& body : bodies_) {
      if (body.part) {
        fingerprint.add(std::uint64_t{body.part->whole}), fingerprint.add(std::uint64_t{body.part->surface}), fingerprint.add(body.part->support);
        fingerprint.add(std::uint64_t{body.region_cost.size()});
        for (Index i = 0; body.part->surface && i < body.table->particles && body.known_to_all[i]; ++i)  // the first ones
          for (int k = 0; k < 3; ++k) fingerprint.add(body.table->particle_position[i][k]);
        continue;
      }
      fingerprint.add(std::uint64_t{body.table->particles});
      for (const double V : body.table->volume) fingerprint.add(V);
      for (std::size_t e = 0; e < body.table->size() && body.made == nullptr; ++e) {
        const TableEntry entry = body.table->entry(e);
        fingerprint.add(std::uint64_t{entry.particle}), fingerprint.add(entry.gradient[0]);
      }
      for (const Field* field : body.made == nullptr ? body.whole : body.motion)
        for (const Vector4& x : *field)
          for (int k = 0; k < 3; ++k) fingerprint.add(x[k]);
    }
    ranks_.require_same("simulation", fingerprint.text());
    for (const SharedBody& body : bodies_) {
      if (!body.part) continue;
      double particles = static_cast<double>(body.part->own.size());
      reduce(comm_, {&particles, 1}, {});
      if (particles != static_cast<double>(body.part->whole))
        throw ParameterError(fmt::format("The parts of a cloud have {:.0f} particles of their own together, and the whole has {}: they are not of one division.", particles, body.part->whole));
    }
  }
  /// For each rank the particles that it owns, of those that are included; of a body in parts these must be the same on all ranks, in the same order.
  template <class Include>
  [[nodiscard]] std::vector<Parcel> parcels_of_owners(std::vector<Field*> SharedBody::*fields, const Include& include) const {
    std::vector<Parcel> parcels(static_cast<std::size_t>(ranks_.size()));
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      for (Parcel& parcel : parcels) parcel.pieces.push_back({bodies_[b].*fields, {}});
      for (Index i = 0; i < bodies_[b].table->particles; ++i)
        if (include(bodies_[b], i)) parcels[static_cast<std::size_t>(parts_[b]->particle_owner[i])].pieces.back().particles.push_back(i);
    }
    return parcels;
  }

  /// Each rank knows what it needs, and tells the owners.
  void find_neighbors() {
    const auto n = static_cast<std::size_t>(ranks_.size());
    std::vector<Parcel> in(n), out(n);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      std::vector<std::vector<Index>> asked(n);
      const PartOfBody& part = *parts_[b];
      for (Index i = 0; i < part.needed.size(); ++i)
        if (part.needed[i] && part.particle_owner[i] != ranks_.rank() && !bodies_[b].known_to_all[i])
          asked[static_cast<std::size_t>(part.particle_owner[i])].push_back(i);
      std::vector<std::vector<Index>> wanted = part.named_by_others(asked);
      for (std::size_t r = 0; r < n; ++r) {
        in[r].pieces.push_back({bodies_[b].motion, std::move(asked[r])});
        out[r].pieces.push_back({bodies_[b].motion, std::move(wanted[r])});
      }
    }
    neighbors_ = std::make_unique<ParcelsToNeighbors>(comm_, std::move(out), std::move(in));
  }
  /// A step that broke down may have left an exchange under way.
  void finish_exchange() {
    if (std::exchange(exchanging_, false)) neighbors_->end();
  }

  Ranks& ranks_;
  MPI_Comm comm_;
  std::vector<SharedBody> bodies_;
  std::vector<std::shared_ptr<PartOfBody>> parts_;
  std::vector<std::function<double(std::span<const double>)>> sums_;
  std::unique_ptr<ParcelsToAll> known_, whole_;
  std::unique_ptr<ParcelsToNeighbors> neighbors_;
  std::size_t evaluated_pairs_ = 0;
  bool exchanging_ = false;
};

}  // namespace tactoid::mpi
