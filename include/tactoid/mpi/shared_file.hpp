#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>

#include <mpi.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/core/shared_file.hpp>
#include <tactoid/core/text.hpp>
#include <tactoid/mpi/parcels.hpp>

namespace tactoid::mpi {

/// A file that all ranks write by MPI-IO, each for itself: what a rank writes is one long piece already, and collective writes of Open MPI 4.1
/// say nothing of a disc that is full, or wait for ever.
class FileOfRanks final : public SharedFile {
 public:
  /// Opens a file that exists. `communicator` and `ranks` must outlive it. Collective; throws FileError on all ranks.
  FileOfRanks(Ranks& ranks, MPI_Comm communicator, std::filesystem::path path) : ranks_(ranks), path_(std::move(path)) {
    note(MPI_File_open(communicator, path_.c_str(), MPI_MODE_WRONLY, MPI_INFO_NULL, &file_));
    tell();
  }
  ~FileOfRanks() override {
    if (file_ != MPI_FILE_NULL) MPI_File_close(&file_);
  }
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes) override {
    if (bytes.empty()) return;
    MPI_Status status;
    int written = 0;
    note(MPI_File_write_at(file_, static_cast<MPI_Offset>(offset), bytes.data(), as_count(bytes.size()), MPI_BYTE, &status));
    note(MPI_Get_count(&status, MPI_BYTE, &written));
    if (failure_.empty() && static_cast<std::size_t>(written) != bytes.size()) fail("only a part of it went there; is the disc full?");
  }
  void close() override {
    note(MPI_File_sync(file_));
    note(MPI_File_close(&file_));
    tell();
  }

 private:
  /// Keeps the first failure of this rank.
  void note(int result) {
    if (result == MPI_SUCCESS || !failure_.empty()) return;
    char text[MPI_MAX_ERROR_STRING];
    int length = 0;
    MPI_Error_string(result, text, &length);
    fail(std::string(text, static_cast<std::size_t>(length)) + ".");
  }
  void fail(const std::string& why) { failure_ = "Cannot write " + in_quotes(path_.string()) + ": " + why; }
  void tell() {
    if (const std::string first = ranks_.first_failure(failure_); !first.empty()) throw FileError(first);
  }

  Ranks& ranks_;
  std::filesystem::path path_;
  MPI_File file_ = MPI_FILE_NULL;
  std::string failure_;
};

}  // namespace tactoid::mpi
