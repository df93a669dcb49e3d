#pragma once

// Needs MPI: link tactoid::mpi. Neither <tactoid/tactoid.hpp> nor a header of another room includes this room.

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <mpi.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/tensor.hpp>

namespace tactoid::mpi {

/// Throws ComputationError with MPI's own words unless a call succeeded.
inline void succeeded(int result) {
  if (result == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  MPI_Error_string(result, text, &length);
  throw ComputationError("MPI failed: " + std::string(text, static_cast<std::size_t>(length)) + ".");
}

/// Waits for a request: at first awake, then with short sleeps, so that a rank that waits long leaves its processor to others.
inline void wait(MPI_Request& request) {
  for (int tries = 0, done = 0;; ++tries) {
    succeeded(MPI_Test(&request, &done, MPI_STATUS_IGNORE));
    if (done) return;
    if (tries >= 500) std::this_thread::sleep_for(std::chrono::microseconds(20));
  }
}

/// A number of items as MPI takes it. Throws ComputationError above 2³¹ − 1.
[[nodiscard]] inline int as_count(std::size_t n) {
  if (n > 0x7FFFFFFFu) throw ComputationError("MPI cannot send more than 2147483647 numbers at once: use more ranks.");
  return static_cast<int>(n);
}

/// Particles of one body, and fields of them of which three components each are sent.
struct Piece {
  std::vector<Field*> fields;    ///< must outlive the piece
  std::vector<Index> particles;  ///< in the order in which they are sent
};

/// What one rank tells another, or all others: pieces of several bodies, one behind the other.
struct Parcel {
  std::vector<Piece> pieces;  ///< in the order of the bodies

  /// Numbers in it.
  [[nodiscard]] std::size_t size() const {
    std::size_t n = 0;
    for (const Piece& piece : pieces) n += 3 * piece.fields.size() * piece.particles.size();
    return n;
  }
  /// Copies the fields to `out`.
  void pack(double* out) const {
    for (const Piece& piece : pieces)
      for (const Index i : piece.particles)
        for (const Field* field : piece.fields) out = std::copy_n((*field)[i].data(), 3, out);
  }
  /// Copies to the fields.
  void unpack(const double* in) const {
    for (const Piece& piece : pieces)
      for (const Index i : piece.particles)
        for (Field* field : piece.fields) {
          std::copy_n(in, 3, (*field)[i].data());
          in += 3;
        }
  }
};

/// Places of parcels in one buffer.
struct Layout {
  std::vector<int> counts;          ///< per parcel: numbers in it
  std::vector<int> places;          ///< per parcel: where they begin
  std::vector<double> buffer;       ///< of all

  Layout() = default;
  /// One behind the other.
  explicit Layout(const std::vector<Parcel>& parcels) {
    std::size_t size = 0;
    for (const Parcel& parcel : parcels) {
      counts.push_back(as_count(parcel.size()));
      places.push_back(as_count(size));
      size += parcel.size();
    }
    buffer.resize(std::max<std::size_t>(size, 1));
  }
};

/// Tells all ranks what each of them owns: one parcel per rank, its own at its place.
class ParcelsToAll {
 public:
  ParcelsToAll() = default;
  /// `parcels`: one per rank, the same on all ranks. `ranks` must outlive it.
  ParcelsToAll(MPI_Comm ranks, std::vector<Parcel> parcels) : ranks_(ranks), parcels_(std::move(parcels)), all_(parcels_) {
    MPI_Comm_rank(ranks_, &rank_);
    own_.resize(std::max<std::size_t>(own().size(), 1));
    empty_ = std::all_of(all_.counts.begin(), all_.counts.end(), [](int n) { return n == 0; });
  }
  /// Sends; the fields of other ranks' particles are set by end().
  void begin() {
    if (empty_) return;
    own().pack(own_.data());
    succeeded(MPI_Iallgatherv(own_.data(), all_.counts[static_cast<std::size_t>(rank_)], MPI_DOUBLE, all_.buffer.data(), all_.counts.data(), all_.places.data(),
                              MPI_DOUBLE, ranks_, &request_));
  }
  /// Waits, and sets the fields.
  void end() {
    if (empty_) return;
    wait(request_);
    for (std::size_t r = 0; r < parcels_.size(); ++r)
      if (static_cast<int>(r) != rank_) parcels_[r].unpack(all_.buffer.data() + all_.places[r]);
  }

 private:
  [[nodiscard]] const Parcel& own() const { return parcels_[static_cast<std::size_t>(rank_)]; }
  MPI_Comm ranks_ = MPI_COMM_NULL;
  int rank_ = 0;
  std::vector<Parcel> parcels_;
  Layout all_;
  std::vector<double> own_;
  bool empty_ = true;
  MPI_Request request_ = MPI_REQUEST_NULL;
};

/// Tells each rank what it needs of the particles of its neighbours.
class ParcelsToNeighbors {
 public:
  ParcelsToNeighbors() = default;
  /// `out` and `in`: one parcel per rank, empty where there is nothing to tell; `out` of one rank is `in` of the other.
  ParcelsToNeighbors(MPI_Comm ranks, std::vector<Parcel> out, std::vector<Parcel> in) {
    std::vector<int> to, from;
    for (std::size_t r = 0; r < out.size(); ++r)
      if (out[r].size() > 0) to.push_back(static_cast<int>(r)), out_.push_back(std::move(out[r]));
    for (std::size_t r = 0; r < in.size(); ++r)
      if (in[r].size() > 0) from.push_back(static_cast<int>(r)), in_.push_back(std::move(in[r]));
    succeeded(MPI_Dist_graph_create_adjacent(ranks, as_count(from.size()), from.data(), MPI_UNWEIGHTED, as_count(to.size()), to.data(), MPI_UNWEIGHTED,
                                             MPI_INFO_NULL, 0, &neighbors_));
    sent_ = Layout(out_);
    received_ = Layout(in_);
  }
  ParcelsToNeighbors(const ParcelsToNeighbors&) = delete;
  ParcelsToNeighbors& operator=(const ParcelsToNeighbors&) = delete;
  ~ParcelsToNeighbors() {
    if (request_ != MPI_REQUEST_NULL) MPI_Wait(&request_, MPI_STATUS_IGNORE);
    if (neighbors_ != MPI_COMM_NULL) MPI_Comm_free(&neighbors_);
  }
  /// Sends; the fields are set by end().
  void begin() {
    for (std::size_t n = 0; n < out_.size(); ++n) out_[n].pack(sent_.buffer.data() + sent_.places[n]);
    succeeded(MPI_Ineighbor_alltoallv(sent_.buffer.data(), sent_.counts.data(), sent_.places.data(), MPI_DOUBLE, received_.buffer.data(), received_.counts.data(),
                                      received_.places.data(), MPI_DOUBLE, neighbors_, &request_));
  }
  /// Waits, and sets the fields.
  void end() {
    wait(request_);
    for (std::size_t n = 0; n < in_.size(); ++n) in_[n].unpack(received_.buffer.data() + received_.places[n]);
  }
  /// Numbers that this rank sends in every step.
  [[nodiscard]] std::size_t sent() const {
    std::size_t n = 0;
    for (const Parcel& parcel : out_) n += parcel.size();
    return n;
  }

 private:
  std::vector<Parcel> out_, in_;
  Layout sent_, received_;
  MPI_Comm neighbors_ = MPI_COMM_NULL;
  MPI_Request request_ = MPI_REQUEST_NULL;
};

}  // namespace tactoid::mpi
