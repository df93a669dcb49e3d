#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tactoid/core/hdf5.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/core/shared_file.hpp>
#include <tactoid/core/state.hpp>

namespace tactoid::detail {

/// How the processes that share a simulation go through a list in a file together: round after round, in each of which each of them has
/// `at_a_time` rows in its hands, one process behind the other.
class RowRounds {
 public:
  RowRounds(std::size_t length, std::size_t at_a_time)
      : length_(length), at_a_time_(at_a_time), ranks_(Ranks::current != nullptr ? static_cast<std::size_t>(Ranks::current->size()) : 1),
        rank_(Ranks::current != nullptr ? static_cast<std::size_t>(Ranks::current->rank()) : 0) {}
  [[nodiscard]] std::size_t rounds() const { return (length_ + at_a_time_ * ranks_ - 1) / (at_a_time_ * ranks_); }
  [[nodiscard]] std::size_t begin(std::size_t round, std::size_t rank) const { return std::min(length_, (round * ranks_ + rank) * at_a_time_); }
  [[nodiscard]] std::size_t begin(std::size_t round) const { return begin(round, rank_); }    ///< of this process
  [[nodiscard]] std::size_t end(std::size_t round) const { return begin(round, rank_ + 1); }  ///< of this process
  [[nodiscard]] std::size_t ranks() const { return ranks_; }

 private:
  std::size_t length_, at_a_time_, ranks_, rank_;
};

/// lists[r] goes to process r; what came from each. Collective.
[[nodiscard]] inline std::vector<std::vector<double>> exchange(std::vector<std::vector<double>> lists) {
  return Ranks::current != nullptr ? Ranks::current->exchange(std::move(lists)) : lists;
}

/// The places of the rows that are here, by their numbers in the whole.
[[nodiscard]] inline std::vector<std::size_t> places_in_order(const StateArray& array) {
  std::vector<std::size_t> order(array.rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return array.rows[a] < array.rows[b]; });
  return order;
}
[[nodiscard]] inline std::size_t width_of(const StateArray& array) { return array.shape.size() > 1 ? array.shape[1] : 1; }

/// Writes a list of which several processes have rows each, from byte `offset` of the file on; what nobody has is 0. Collective.
inline void write_rows(SharedFile& file, std::uint64_t offset, const StateArray& array, std::size_t at_a_time = rows_at_a_time) {
  const std::size_t width = width_of(array);
  const std::vector<std::size_t> order = places_in_order(array);
  const RowRounds turn(array.length, at_a_time);
  std::vector<double> piece;
  std::vector<std::int64_t> whole;
  auto next = order.begin();
  for (std::size_t round = 0; round < turn.rounds(); ++round) {
    std::vector<std::vector<double>> lists(turn.ranks());
    for (std::size_t r = 0; r < turn.ranks(); ++r)
      for (; next != order.end() && array.rows[*next] < turn.begin(round, r + 1); ++next) {
        lists[r].push_back(static_cast<double>(array.rows[*next]));
        const auto values = array.values.begin() + static_cast<std::ptrdiff_t>(*next * width);
        lists[r].insert(lists[r].end(), values, values + static_cast<std::ptrdiff_t>(width));
      }
    const std::size_t begin = turn.begin(round);
    piece.assign((turn.end(round) - begin) * width, 0.0);
    for (const std::vector<double>& list : exchange(std::move(lists)))
      for (std::size_t k = 0; k < list.size(); k += width + 1)
        std::copy_n(list.data() + k + 1, width, piece.data() + (static_cast<std::size_t>(list[k]) - begin) * width);
    std::span<const std::byte> bytes = std::as_bytes(std::span(piece));
    if (array.whole) {
      whole.assign(piece.begin(), piece.end());
      bytes = std::as_bytes(std::span(whole));
    }
    file.write_at(offset + begin * width * sizeof(double), bytes);
  }
}

/// Reads the rows of a data set that `array` names. Collective; throws FileError on all processes where one cannot read.
inline void read_rows(hid_t set, StateArray& array, std::size_t at_a_time = rows_at_a_time) {
  const std::size_t width = width_of(array);
  array.values.resize(array.rows.size() * width);
  const std::vector<std::size_t> order = places_in_order(array);
  const RowRounds turn(array.length, at_a_time);
  std::string failure;
  std::vector<double> piece;
  auto next = order.begin();
  for (std::size_t round = 0; round < turn.rounds(); ++round) {
    std::vector<std::vector<double>> wanted(turn.ranks());
    std::vector<std::vector<std::size_t>> places(turn.ranks());
    for (std::size_t r = 0; r < turn.ranks(); ++r)
      for (; next != order.end() && array.rows[*next] < turn.begin(round, r + 1); ++next) {
        wanted[r].push_back(static_cast<double>(array.rows[*next]));
        places[r].push_back(*next);
      }
    const std::size_t begin = turn.begin(round), count = turn.end(round) - begin;
    piece.assign(count * width, 0.0);
    try {
      if (count > 0) SetRows(begin, count, width, array.shape.size() > 1).transfer(set, H5Dread, H5T_NATIVE_DOUBLE, piece.data());
    } catch (const std::exception& error) {  // the others wait for this one's rows
      failure = error.what();
    }
    std::vector<std::vector<double>> told(turn.ranks());
    const auto asked = exchange(std::move(wanted));
    for (std::size_t r = 0; r < asked.size(); ++r)
      for (const double row : asked[r]) {
        const auto values = piece.begin() + static_cast<std::ptrdiff_t>((static_cast<std::size_t>(row) - begin) * width);
        told[r].insert(told[r].end(), values, values + static_cast<std::ptrdiff_t>(width));
      }
    const auto answers = exchange(std::move(told));
    for (std::size_t r = 0; r < answers.size(); ++r)
      for (std::size_t k = 0; k < places[r].size(); ++k) std::copy_n(answers[r].data() + k * width, width, array.values.data() + places[r][k] * width);
  }
  if (Ranks::current != nullptr) failure = Ranks::current->first_failure(failure);
  if (!failure.empty()) throw FileError(failure);
}

}  // namespace tactoid::detail
