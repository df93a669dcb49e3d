#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <functional>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <metis.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/simulation/decomposition.hpp>

namespace tactoid::mpi {

/// What is partitioned: the chunks of points of all bodies, body by body. Chunks of one body that share particles are neighbours.
struct ChunkGraph {
  std::vector<std::size_t> first;      ///< neighbours of chunk c: [first[c], first[c + 1]) of the lists below
  std::vector<std::size_t> neighbors;  ///< numbers of chunks
  std::vector<std::size_t> shared;     ///< beside `neighbors`: particles that both touch
  std::vector<double> cost;            ///< of a step, per chunk, in pairs

  [[nodiscard]] std::size_t size() const { return cost.size(); }  ///< number of chunks
};

/// A rank in [0, ranks) for every chunk.
using Partitioner = std::function<std::vector<int>(const ChunkGraph& graph, int ranks)>;

/// The particles that each chunk of a table touches, ascending.
[[nodiscard]] inline std::vector<std::vector<Index>> touched_particles(const PointTable& table) {
  std::vector<std::vector<Index>> touched(table.chunks.size());
  for (std::size_t c = 0; c < table.chunks.size(); ++c) {
    auto& list = touched[c];
    for (std::size_t e = table.offsets[table.chunks[c].begin]; e < table.offsets[table.chunks[c].end]; ++e) list.push_back(table.entry(e).particle);
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return touched;
}

/// Adds the chunks of a body with so many particles to a graph: what each touches, and its cost.
inline void add_chunks(ChunkGraph& graph, std::size_t particles, const std::vector<std::vector<Index>>& touched, const std::vector<double>& cost) {
  const std::size_t before = graph.size();
  std::vector<std::vector<std::size_t>> chunks_of(particles);
  for (std::size_t c = 0; c < touched.size(); ++c)
    for (const Index i : touched[c]) chunks_of[i].push_back(c);
  std::vector<std::size_t> common(touched.size(), 0);
  if (graph.first.empty()) graph.first.push_back(0);
  for (std::size_t c = 0; c < touched.size(); ++c) {
    std::vector<std::size_t> near;
    for (const Index i : touched[c])
      for (const std::size_t other : chunks_of[i])
        if (other != c && common[other]++ == 0) near.push_back(other);
    std::sort(near.begin(), near.end());
    for (const std::size_t other : near) {
      graph.neighbors.push_back(before + other);
      graph.shared.push_back(std::exchange(common[other], 0));
    }
    graph.first.push_back(graph.neighbors.size());
  }
  graph.cost.insert(graph.cost.end(), cost.begin(), cost.end());
}

/// Of the chunks of a body, in pairs.
[[nodiscard]] inline std::vector<double> costs_of_chunks(const SharedBody& body) {
  std::vector<double> costs;
  for (const PointChunk& chunk : body.table->chunks)
    costs.push_back(static_cast<double>(body.table->offsets[chunk.end] - body.table->offsets[chunk.begin]) +
                    body.region_cost[chunk.region] * static_cast<double>(chunk.end - chunk.begin));
  return costs;
}

/// By METIS: equal costs, and few particles that several ranks need. Between two exchanges a rank works on all its chunks without
/// waiting, so that it is the sum over bodies and regions that is balanced. Where there are no more chunks than ranks, each is on its own.
[[nodiscard]] inline std::vector<int> partition_by_metis(const ChunkGraph& graph, int ranks) {
  std::vector<int> owner(graph.size(), 0);
  if (ranks <= 1) return owner;
  if (graph.size() <= static_cast<std::size_t>(ranks)) {
    std::iota(owner.begin(), owner.end(), 0);
    return owner;
  }
  idx_t vertices = static_cast<idx_t>(graph.size()), constraints = 1, parts = ranks, cut = 0;
  std::vector<idx_t> first(graph.first.begin(), graph.first.end()), neighbors(graph.neighbors.begin(), graph.neighbors.end()),
      shared(graph.shared.begin(), graph.shared.end()), weights, part(graph.size(), 0);
  const double most = *std::max_element(graph.cost.begin(), graph.cost.end());
  for (const double cost : graph.cost) weights.push_back(std::max<idx_t>(1, static_cast<idx_t>(1000.0 * cost / most)));
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  // Few parts are balanced best by bisection.
  const auto partition = ranks <= 8 ? METIS_PartGraphRecursive : METIS_PartGraphKway;
  if (partition(&vertices, &constraints, first.data(), neighbors.data(), weights.data(), nullptr, shared.data(), &parts, nullptr, nullptr, options, &cut,
                part.data()) != METIS_OK)
    throw ComputationError("METIS could not partition the bodies.");
  std::copy(part.begin(), part.end(), owner.begin());
  return owner;
}

/// A rank for every chunk of a graph, as rank 0 partitions it. Collective; where the partitioner fails, ParameterError on all ranks.
[[nodiscard]] inline std::vector<int> partition(Ranks& ranks, const ChunkGraph& graph, const Partitioner& partitioner) {
  std::vector<int> owner;
  std::string failure;
  if (ranks.rank() == 0) {
    try {
      owner = partitioner(graph, ranks.size());
      const bool valid = owner.size() == graph.size() && std::all_of(owner.begin(), owner.end(), [&](int r) { return r >= 0 && r < ranks.size(); });
      if (!valid) failure = "A Partitioner gives a rank, from 0 on, for each chunk.";
    } catch (const std::exception& error) {  // all ranks shall know
      failure = error.what();
    }
  }
  failure = ranks.text_of(0, failure);
  if (!failure.empty()) throw ParameterError(failure);
  std::vector<Index> told(graph.size());
  std::copy(owner.begin(), owner.end(), told.begin());
  std::vector<std::size_t> first(static_cast<std::size_t>(ranks.size()) + 1, told.size());
  first[0] = 0;
  ranks.gather(told, first);
  return {told.begin(), told.end()};
}

}  // namespace tactoid::mpi
