#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/shared_file.hpp>
#include <tactoid/core/tensor.hpp>

namespace tactoid {

class Decomposition;  // simulation/decomposition.hpp
class RowShare;       // quadrature/row_share.hpp
struct CloudPart;     // geometry/point_cloud.hpp
struct PointTable;    // quadrature/point_table.hpp
struct SharedBody;    // simulation/decomposition.hpp
struct TableOutline;  // quadrature/row_share.hpp

/// How the ranks add up what several of them contribute to: forces on particles at their borders, energies.
enum class SumOrder {
  /// In the order of one process: the same bits for any number of ranks. A row at a border is evaluated by each rank that needs it.
  of_one_process,
  /// Rank after rank: each row is evaluated once, and forces go back to the ranks that own their particles. The same bits for the same division; for
  /// another number of ranks the same but for round-off.
  of_ranks
};

/// Which rows of a body's table a rank makes when the body is composed.
enum class SetUp {
  /// All; those of other ranks are dropped when the simulation is composed.
  whole,
  /// Those that touch its own particles, of quadratures that can (NodalCentroids): set-up takes less time and memory on each rank, and ends with the same
  /// bits. Such bodies take explicit integrators.
  divided
};

/// The processes (ranks, in the words of MPI) that compute one simulation together. The library knows them by this interface
/// alone; <tactoid/mpi.hpp> implements it. Calls are a few per step, never per particle, so that they may be virtual.
/// *Collective* functions must be called by all ranks, in the same order.
class Ranks {
 public:
  Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  virtual ~Ranks() = default;

  SumOrder sum_order = SumOrder::of_one_process;  ///< of simulations, as it is when they are composed; the same on all ranks
  SetUp set_up = SetUp::whole;                    ///< of bodies, as it is when they are composed; the same on all ranks
  /// In the order of the ranks, contacts are divided of bodies with at least so many particles, and of surfaces with at least so many sampled points; what is smaller is computed by each rank in
  /// less time than it takes to tell. As it is when simulations are composed; the same on all ranks.
  std::size_t divided_contacts_from = 8192;

  [[nodiscard]] virtual int rank() const = 0;  ///< of this process, in [0, size())
  [[nodiscard]] virtual int size() const = 0;  ///< number of processes

  /// The largest of the numbers that the ranks give. Collective.
  [[nodiscard]] virtual long largest(long number) = 0;
  /// What rank `of` gives, for all. Collective.
  [[nodiscard]] virtual std::string text_of(int of, const std::string& text) = 0;
  /// Numbers of which each rank knows some, for all: those of rank r are values[first[r]] .. values[first[r + 1] − 1]. Collective.
  ///@{
  virtual void gather(std::span<double> values, std::span<const std::size_t> first) = 0;
  virtual void gather(std::span<Index> values, std::span<const std::size_t> first) = 0;
  ///@}
  /// As many numbers of each rank, for all: those of rank 0 first. Collective.
  [[nodiscard]] std::vector<double> gather_from_each(std::span<const double> numbers) {
    const auto count = static_cast<std::size_t>(size());
    std::vector<double> values(count * numbers.size());
    std::vector<std::size_t> first(count + 1);
    for (std::size_t r = 0; r <= count; ++r) first[r] = r * numbers.size();
    std::copy(numbers.begin(), numbers.end(), values.begin() + static_cast<std::ptrdiff_t>(first[static_cast<std::size_t>(rank())]));
    gather(values, first);
    return values;
  }
  /// One list for each rank, which gets it; what comes from each of them. Collective.
  [[nodiscard]] virtual std::vector<std::vector<double>> exchange(std::vector<std::vector<double>> lists) = 0;
  /// Opens a file that exists, for all ranks to write into. Collective; throws FileError on all of them.
  [[nodiscard]] virtual std::unique_ptr<SharedFile> open_shared(const std::filesystem::path& path) = 0;
  /// Throws ParameterError on all ranks, with the first rank that differs from rank 0 and what of it, unless all give the same
  /// text. Collective.
  void require_same(std::string_view what, const std::string& text) {
    const long differs = largest(text_of(0, text) == text ? 0 : size() - rank());
    if (differs > 0)
      throw ParameterError("Rank " + std::to_string(size() - differs) + " has another " + std::string(what) +
                           " than rank 0: all ranks must run the same program with the same options.");
  }

  /// Throws as require_same() where ranks do not set up their bodies alike. Collective; to be the first that a rank asks the others about a body.
  void require_same_set_up() { require_same("set-up of bodies", set_up == SetUp::whole ? "whole" : "divided"); }
  /// The failure of the first rank that has one, on all ranks; empty without any. Collective.
  [[nodiscard]] std::string first_failure(const std::string& failure) {
    const long first = size() - largest(failure.empty() ? 0 : size() - rank());
    return first < size() ? text_of(static_cast<int>(first), failure) : std::string();
  }

  /// Does what each rank does for itself. What it throws on the first rank that fails is thrown on all: a ParameterError, or else a GeometryError. Collective.
  template <class F>
  void together(const F& work) {
    std::string failure;
    try {
      work();
    } catch (const ParameterError& error) {
      failure = std::string("P") + error.what();
    } catch (const std::exception& error) {
      failure = std::string("G") + error.what();
    }
    const std::string first = first_failure(failure);
    if (first.empty()) return;
    if (first.front() == 'P') throw ParameterError(first.substr(1));
    throw GeometryError(first.substr(1));
  }

  /// Divides a table among the ranks before its rows are made. Collective.
  [[nodiscard]] virtual std::shared_ptr<RowShare> divide(const TableOutline& outline) = 0;
  /// The share of this rank in a body of which each rank has a part of the cloud: `table` has the points and chunks of this part. Collective.
  [[nodiscard]] virtual std::shared_ptr<RowShare> share_of(const PointTable& table, std::shared_ptr<const CloudPart> part) = 0;
  /// Divides bodies among the ranks. Collective; throws ParameterError on all ranks where these have not composed the same.
  [[nodiscard]] virtual std::unique_ptr<Decomposition> decompose(std::vector<SharedBody> bodies) = 0;

  /// To be called where a program is about to end by a failure. Where all ranks fail alike, true on the one that reports it.
  /// A failure of this rank alone would leave the others waiting: then it is written to the error output behind the number of the
  /// rank, and all ranks are ended with this exit status. Not collective.
  [[nodiscard]] virtual bool reports_failure(std::string_view text, int status) = 0;

  /// The ranks of this process; null without a session, and then everything is computed here. A session object sets it and clears
  /// it. It is the one global of the library: MPI itself is one per process, and so simulations find it without an argument, in
  /// programs that are written for one process.
  static inline Ranks* current = nullptr;
};

/// Whether this process writes files and reports: the first of the ranks, or the only one.
[[nodiscard]] inline bool is_first_rank() { return Ranks::current == nullptr || Ranks::current->rank() == 0; }

}  // namespace tactoid
