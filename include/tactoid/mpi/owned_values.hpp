#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <mpi.h>

#include <tactoid/core/parallel.hpp>
#include <tactoid/mpi/parcels.hpp>

namespace tactoid::mpi {

/// Items that each belong to one rank, and numbers of them that all ranks gather.
class OwnedValues {
 public:
  OwnedValues() = default;
  /// `owner` of each item, the same on all ranks. `ranks` must outlive it.
  OwnedValues(MPI_Comm ranks, const std::vector<int>& owner) : ranks_(ranks) {
    int size = 1;
    MPI_Comm_size(ranks_, &size);
    MPI_Comm_rank(ranks_, &rank_);
    first_.assign(static_cast<std::size_t>(size) + 1, 0);
    for (const int r : owner) ++first_[static_cast<std::size_t>(r) + 1];
    for (std::size_t r = 0; r + 1 < first_.size(); ++r) first_[r + 1] += first_[r];
    items_.resize(owner.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < owner.size(); ++i) items_[next[static_cast<std::size_t>(owner[i])]++] = static_cast<Index>(i);
  }

  /// `width` numbers per item: those of own items in, those of all out. Collective.
  void gather(std::span<double> values, std::size_t width) {
    std::vector<double> own, all(std::max<std::size_t>(items_.size() * width, 1));
    std::vector<int> counts, places;
    for (std::size_t r = 0; r + 1 < first_.size(); ++r) {
      counts.push_back(as_count((first_[r + 1] - first_[r]) * width));
      places.push_back(as_count(first_[r] * width));
    }
    const auto me = static_cast<std::size_t>(rank_);
    own.reserve(static_cast<std::size_t>(counts[me]) + 1);
    for (std::size_t k = first_[me]; k < first_[me + 1]; ++k)
      for (std::size_t j = 0; j < width; ++j) own.push_back(values[items_[k] * width + j]);
    MPI_Request request = MPI_REQUEST_NULL;
    succeeded(MPI_Iallgatherv(own.data(), counts[me], MPI_DOUBLE, all.data(), counts.data(), places.data(), MPI_DOUBLE, ranks_, &request));
    wait(request);
    for (std::size_t k = 0; k < items_.size(); ++k) std::copy_n(all.data() + k * width, width, values.data() + items_[k] * width);
  }

 private:
  MPI_Comm ranks_ = MPI_COMM_NULL;
  int rank_ = 0;
  std::vector<Index> items_;        // rank by rank
  std::vector<std::size_t> first_;  // of each rank in items_
};

/// Sums and maxima over the ranks of what each gives; sums rank after rank, so that all have the same bits. Collective.
inline void reduce(MPI_Comm ranks, std::span<double> sums, std::span<double> maxima) {
  int size = 1;
  MPI_Comm_size(ranks, &size);
  const std::size_t width = sums.size() + maxima.size();
  std::vector<double> own(sums.begin(), sums.end()), all(width * static_cast<std::size_t>(size));
  own.insert(own.end(), maxima.begin(), maxima.end());
  MPI_Request request = MPI_REQUEST_NULL;
  succeeded(MPI_Iallgather(own.data(), as_count(width), MPI_DOUBLE, all.data(), as_count(width), MPI_DOUBLE, ranks, &request));
  wait(request);
  std::fill(sums.begin(), sums.end(), 0.0);
  for (std::size_t r = 0; r < static_cast<std::size_t>(size); ++r) {
    const double* of_rank = all.data() + r * width;
    for (double& sum : sums) sum += *of_rank++;
    for (double& most : maxima) most = std::max(most, *of_rank++);
  }
}

/// Sums over the ranks of numbers that all but one of them give as 0: exact, since adding zeros is. Collective.
inline void combine(MPI_Comm ranks, std::span<double> values) {
  MPI_Request request = MPI_REQUEST_NULL;
  succeeded(MPI_Iallreduce(MPI_IN_PLACE, values.data(), as_count(values.size()), MPI_DOUBLE, MPI_SUM, ranks, &request));
  wait(request);
}

/// The lists of all ranks, one behind the other. Collective.
[[nodiscard]] inline std::vector<double> join(MPI_Comm ranks, std::span<const double> list) {
  int size = 1;
  MPI_Comm_size(ranks, &size);
  const int own = as_count(list.size());
  std::vector<int> counts(static_cast<std::size_t>(size)), places(static_cast<std::size_t>(size) + 1, 0);
  MPI_Request request = MPI_REQUEST_NULL;
  succeeded(MPI_Iallgather(&own, 1, MPI_INT, counts.data(), 1, MPI_INT, ranks, &request));
  wait(request);
  std::size_t all = 0;
  for (std::size_t r = 0; r < counts.size(); ++r) all += static_cast<std::size_t>(counts[r]), places[r + 1] = as_count(all);
  std::vector<double> joined(all);
  succeeded(MPI_Iallgatherv(list.data(), own, MPI_DOUBLE, joined.data(), counts.data(), places.data(), MPI_DOUBLE, ranks, &request));
  wait(request);
  return joined;
}

/// Sums over items that each belong to one rank: each rank its own, then rank after rank.
class SumByRank {
 public:
  /// `own`: the items of this rank. `ranks` must outlive it.
  SumByRank(MPI_Comm ranks, std::vector<Index> own) : ranks_(ranks), own_(std::move(own)) {}
  /// Σ terms over all items, each rank giving those that it owns. Collective.
  [[nodiscard]] double operator()(std::span<const double> terms) const {
    double sum = parallel_sum(own_.size(), [&](std::size_t k) { return terms[own_[k]]; });
    reduce(ranks_, {&sum, 1}, {});
    return sum;
  }

 private:
  MPI_Comm ranks_;
  std::vector<Index> own_;
};

/// Per part of a sum over items: the rank that owns most of them.
[[nodiscard]] inline std::vector<int> summing_ranks(const std::vector<int>& owner, int ranks) {
  std::vector<int> result;
  for (std::size_t p = 0; p < sum_parts; ++p) {
    const auto [first, last] = sum_part(owner.size(), p);
    std::vector<std::size_t> owned(static_cast<std::size_t>(ranks), 0);
    for (std::size_t i = first; i < last; ++i) ++owned[static_cast<std::size_t>(owner[i])];
    result.push_back(static_cast<int>(std::max_element(owned.begin(), owned.end()) - owned.begin()));
  }
  return result;
}

/// Sums over items that each belong to one rank, with the bits of parallel_sum: each of its parts is summed, in its order, by the
/// rank that owns most of it, to which the other ones send their terms.
class SumInOrder {
 public:
  SumInOrder() = default;
  /// `owner` of each item, the same on all ranks. `ranks` must outlive it.
  SumInOrder(MPI_Comm ranks, const std::vector<int>& owner) : ranks_(ranks) {
    int size = 1, rank = 0;
    MPI_Comm_size(ranks_, &size);
    MPI_Comm_rank(ranks_, &rank);
    const auto n = static_cast<std::size_t>(size);
    sent_counts_.assign(n, 0), received_counts_.assign(n, 0);
    std::vector<std::vector<Index>> sent(n);
    std::vector<std::size_t> of_rank;  // owner's rank of each term that arrives here
    const std::vector<int> summing = summing_ranks(owner, size);
    for (std::size_t p = 0; p < sum_parts; ++p) {
      const auto [first, last] = sum_part(owner.size(), p);
      const auto here = static_cast<std::size_t>(summing[p]);
      const bool mine = summing[p] == rank;
      for (std::size_t i = first; i < last; ++i) {
        if (owner[i] == rank) sent[here].push_back(static_cast<Index>(i));
        if (mine) of_rank.push_back(static_cast<std::size_t>(owner[i]));
      }
      end_of_part_[p] = of_rank.size();
    }
    for (const std::size_t r : of_rank) ++received_counts_[r];
    sent_places_ = received_places_ = std::vector<int>(n, 0);
    for (std::size_t r = 0; r < n; ++r) {
      sent_counts_[r] = as_count(sent[r].size());
      if (r > 0) sent_places_[r] = sent_places_[r - 1] + sent_counts_[r - 1], received_places_[r] = received_places_[r - 1] + received_counts_[r - 1];
      sent_.insert(sent_.end(), sent[r].begin(), sent[r].end());
    }
    std::vector<int> next = received_places_;
    for (const std::size_t r : of_rank) place_.push_back(static_cast<std::size_t>(next[r]++));
    out_.resize(sent_.size() + 1);
    in_.resize(of_rank.size() + 1);
  }

  /// Σ terms over all items, each rank giving those that it owns. Collective.
  [[nodiscard]] double operator()(std::span<const double> terms) {
    for (std::size_t k = 0; k < sent_.size(); ++k) out_[k] = terms[sent_[k]];
    MPI_Request request = MPI_REQUEST_NULL;
    succeeded(MPI_Ialltoallv(out_.data(), sent_counts_.data(), sent_places_.data(), MPI_DOUBLE, in_.data(), received_counts_.data(),
                             received_places_.data(), MPI_DOUBLE, ranks_, &request));
    wait(request);
    std::array<double, sum_parts> sums{};
    for (std::size_t p = 0, k = 0; p < sum_parts; ++p)
      for (; k < end_of_part_[p]; ++k) sums[p] += in_[place_[k]];
    combine(ranks_, sums);
    double total = 0.0;
    for (const double sum : sums) total += sum;
    return total;
  }

 private:
  MPI_Comm ranks_ = MPI_COMM_NULL;
  std::vector<Index> sent_;                         // own items, by the rank that they are sent to
  std::vector<std::size_t> place_;                  // of the terms of the parts that are summed here, in the order of the sum
  std::array<std::size_t, sum_parts> end_of_part_{};    // in place_
  std::vector<int> sent_counts_, sent_places_, received_counts_, received_places_;
  std::vector<double> out_, in_;
};

}  // namespace tactoid::mpi
