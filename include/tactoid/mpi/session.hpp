#pragma once

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <mpi.h>

#include <tactoid/core/ranks.hpp>
#include <tactoid/core/version.hpp>
#include <tactoid/mpi/chunk_graph.hpp>
#include <tactoid/mpi/divided_bodies.hpp>
#include <tactoid/mpi/parcels.hpp>
#include <tactoid/mpi/part_of_body.hpp>
#include <tactoid/mpi/shared_file.hpp>

namespace tactoid::mpi {

/// How a Session works.
struct SessionOptions {
  Partitioner partitioner = partition_by_metis;  ///< which rank computes which chunks of points
  double patience = 10.0;                        ///< s: how long a rank that fails waits for the others to fail alike
  bool always = false;                           ///< start MPI even where no launcher is known to have started the program
};

/// Whether mpirun, srun or one of their kind has started this program: they say so in its environment.
[[nodiscard]] inline bool started_by_launcher() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_RANK", "PMI_SIZE", "PMIX_RANK", "MPI_LOCALNRANKS", "MV2_COMM_WORLD_SIZE", "SLURM_PROCID", "PALS_RANKID",
                           "ALPS_APP_PE", "FLUX_TASK_RANK", "JSM_NAMESPACE_RANK"})
    if (std::getenv(name) != nullptr) return true;
  return false;
}

/// Makes the processes that mpirun started compute each simulation together, as long as it lives:
///
///   int main(int argc, char** argv) {
///     tactoid::mpi::Session session(argc, argv);
///     …                                            // the same program, on every rank
///   }
///
/// One per program, which outlives all simulations. A program that no launcher has started is the only rank: MPI is not even
/// started, and everything is as without a session.
class Session final : public Ranks {
 public:
  /// Starts MPI. Collective. Throws ParameterError where there is a session already.
  Session(int& argc, char**& argv, SessionOptions options = {}) : options_(std::move(options)) {
    if (Ranks::current != nullptr) throw ParameterError("A program has one mpi::Session at a time.");
    Ranks::current = this;
    if (!options_.always && !started_by_launcher()) return;
    int provided = 0;
    succeeded(MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided));
    succeeded(MPI_Comm_dup(MPI_COMM_WORLD, &ranks_));
    succeeded(MPI_Comm_dup(MPI_COMM_WORLD, &failures_));
    MPI_Comm_rank(ranks_, &rank_);
    MPI_Comm_size(ranks_, &size_);
  }
  /// Ends MPI, when all ranks have come here.
  ~Session() override {
    Ranks::current = nullptr;
    if (ranks_ == MPI_COMM_NULL) return;
    MPI_Comm_free(&ranks_);
    MPI_Comm_free(&failures_);
    MPI_Finalize();
  }

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }
  [[nodiscard]] long largest(long number) override {
    if (size_ == 1) return number;
    MPI_Request request = MPI_REQUEST_NULL;
    succeeded(MPI_Iallreduce(MPI_IN_PLACE, &number, 1, MPI_LONG, MPI_MAX, ranks_, &request));
    wait(request);
    return number;
  }
  [[nodiscard]] std::string text_of(int of, const std::string& text) override {
    if (size_ == 1) return text;
    std::string result = text;
    long length = static_cast<long>(text.size());
    MPI_Request request = MPI_REQUEST_NULL;
    succeeded(MPI_Ibcast(&length, 1, MPI_LONG, of, ranks_, &request));
    wait(request);
    result.resize(static_cast<std::size_t>(length));
    succeeded(MPI_Ibcast(result.data(), as_count(result.size()), MPI_CHAR, of, ranks_, &request));
    wait(request);
    return result;
  }
  void gather(std::span<double> values, std::span<const std::size_t> first) override { gather(values.data(), first, MPI_DOUBLE); }
  void gather(std::span<Index> values, std::span<const std::size_t> first) override { gather(values.data(), first, MPI_UINT32_T); }
  [[nodiscard]] std::vector<std::vector<double>> exchange(std::vector<std::vector<double>> lists) override { return size_ == 1 ? lists : exchange_lists(ranks_, lists); }
  [[nodiscard]] std::unique_ptr<SharedFile> open_shared(const std::filesystem::path& path) override {
    if (size_ == 1) return std::make_unique<FileOfOne>(path);
    return std::make_unique<FileOfRanks>(*this, ranks_, path);
  }
  [[nodiscard]] std::shared_ptr<RowShare> divide(const TableOutline& outline) override {
    ChunkGraph graph;
    add_chunks(graph, outline.table->particles, outline.touched, outline.cost);
    const std::vector<int> owner = partition(*this, graph, options_.partitioner);
    return std::make_shared<PartOfBody>(ranks_, *outline.table, owner, owners_of_particles(*outline.table, owner, outline.touched));
  }
  [[nodiscard]] std::shared_ptr<RowShare> share_of(const PointTable& table, std::shared_ptr<const CloudPart> part) override {
    std::vector<int> owner;
    for (const PointChunk& chunk : table.chunks) owner.push_back(part->is_own(table.owner[chunk.begin]) ? rank_ : -1);
    std::vector<int> of_particles = part->owner;
    return std::make_shared<PartOfBody>(ranks_, table, std::move(owner), std::move(of_particles), std::move(part));
  }
  [[nodiscard]] std::unique_ptr<Decomposition> decompose(std::vector<SharedBody> bodies) override {
    require_same_set_up();
    require_same("version of Tactoid", version);
    require_same("order of sums", std::to_string(static_cast<int>(sum_order)));
    return std::make_unique<DividedBodies>(*this, ranks_, std::move(bodies), options_.partitioner);
  }
  [[nodiscard]] bool reports_failure(std::string_view text, int status) override {
    if (size_ == 1) return true;
    if (all_are_here()) return rank_ == 0;
    std::fflush(stdout);
    std::fprintf(stderr, "rank %d: %.*s\n", rank_, static_cast<int>(text.size()), text.data());
    std::fflush(stderr);
    MPI_Abort(MPI_COMM_WORLD, status);
    std::abort();
  }

 private:
  template <class T>
  void gather(T* values, std::span<const std::size_t> first, MPI_Datatype type) {
    if (size_ == 1) return;
    std::vector<int> counts, places;
    for (std::size_t r = 0; r + 1 < first.size(); ++r) {
      counts.push_back(as_count(first[r + 1] - first[r]));
      places.push_back(as_count(first[r]));
    }
    MPI_Request request = MPI_REQUEST_NULL;
    succeeded(MPI_Iallgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, values, counts.data(), places.data(), type, ranks_, &request));
    wait(request);
  }
  /// Whether all ranks call this within options_.patience.
  [[nodiscard]] bool all_are_here() {
    MPI_Request request = MPI_REQUEST_NULL;
    if (MPI_Ibarrier(failures_, &request) != MPI_SUCCESS) return false;
    const auto start = std::chrono::steady_clock::now();
    int here = 0;
    while (MPI_Test(&request, &here, MPI_STATUS_IGNORE) == MPI_SUCCESS && !here) {
      if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > options_.patience) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return here != 0;
  }

  SessionOptions options_;
  MPI_Comm ranks_ = MPI_COMM_NULL, failures_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
};

}  // namespace tactoid::mpi
