#pragma once

// Needs MPI: link tactoid::mpi. Neither <tactoid/tactoid.hpp> nor a header of another room includes this room.

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
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

/// What becomes of a number at the place where it arrives.
enum class Arrival { replaces, adds };

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
  /// Copies to the fields, or adds to them.
  void unpack(const double* in, Arrival arrival = Arrival::replaces) const {
    for (const Piece& piece : pieces)
      for (const Index i : piece.particles)
        for (Field* field : piece.fields) {
          Eigen::Map<const Vector3> arrived(in);
          if (arrival == Arrival::adds) (*field)[i].template head<3>() += arrived;
          else (*field)[i].template head<3>() = arrived;
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

///@{
/// Numbers as MPI knows them.
[[nodiscard]] inline MPI_Datatype type_of(double) { return MPI_DOUBLE; }
[[nodiscard]] inline MPI_Datatype type_of(std::uint32_t) { return MPI_UINT32_T; }
///@}

/// Lists for each rank, which it gets: the lists that all ranks have for this one. Collective.
template <class T>
[[nodiscard]] std::vector<std::vector<T>> exchange_lists(MPI_Comm ranks, const std::vector<std::vector<T>>& lists) {
  const std::size_t n = lists.size();
  std::vector<int> counts(n), places(n + 1, 0), arriving(n), arriving_places(n + 1, 0);
  std::vector<T> out;
  for (std::size_t r = 0; r < n; ++r) {
    counts[r] = as_count(lists[r].size());
    out.insert(out.end(), lists[r].begin(), lists[r].end());
    places[r + 1] = as_count(out.size());
  }
  MPI_Request request = MPI_REQUEST_NULL;
  succeeded(MPI_Ialltoall(counts.data(), 1, MPI_INT, arriving.data(), 1, MPI_INT, ranks, &request));
  wait(request);
  std::size_t all = 0;
  for (std::size_t r = 0; r < n; ++r) all += static_cast<std::size_t>(arriving[r]), arriving_places[r + 1] = as_count(all);
  std::vector<T> in(all + 1);
  out.push_back(0);
  succeeded(MPI_Ialltoallv(out.data(), counts.data(), places.data(), type_of(T{}), in.data(), arriving.data(), arriving_places.data(), type_of(T{}), ranks, &request));
  wait(request);
  std::vector<std::vector<T>> result(n);
  for (std::size_t r = 0; r < n; ++r) result[r].assign(in.begin() + arriving_places[r], in.begin() + arriving_places[r + 1]);
  return result;
}

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
  ParcelsToNeighbors(MPI_Comm ranks, std::vector<Parcel> out, std::vector<Parcel> in, Arrival arrival = Arrival::replaces) : arrival_(arrival) {
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
  /// Other fields from now on, as many as before.
  void carry(std::span<Field* const> fields) {
    for (auto* parcels : {&out_, &in_})
      for (Parcel& parcel : *parcels)
        for (Piece& piece : parcel.pieces) std::copy(fields.begin(), fields.end(), piece.fields.begin());
  }
  /// Sends; the fields are set by end().
  void begin() {
    for (std::size_t n = 0; n < out_.size(); ++n) out_[n].pack(sent_.buffer.data() + sent_.places[n]);
    succeeded(MPI_Ineighbor_alltoallv(sent_.buffer.data(), sent_.counts.data(), sent_.places.data(), MPI_DOUBLE, received_.buffer.data(), received_.counts.data(),
                                      received_.places.data(), MPI_DOUBLE, neighbors_, &request_));
  }
  /// Waits, and sets the fields, or adds to them, rank after rank.
  void end() {
    wait(request_);
    for (std::size_t n = 0; n < in_.size(); ++n) in_[n].unpack(received_.buffer.data() + received_.places[n], arrival_);
  }
  /// Numbers that this rank sends in every step.
  [[nodiscard]] std::size_t sent() const {
    std::size_t n = 0;
    for (const Parcel& parcel : out_) n += parcel.size();
    return n;
  }

 private:
  Arrival arrival_ = Arrival::replaces;
  std::vector<Parcel> out_, in_;
  Layout sent_, received_;
  MPI_Comm neighbors_ = MPI_COMM_NULL;
  MPI_Request request_ = MPI_REQUEST_NULL;
};

}  // namespace tactoid::mpi
