#pragma once

/// For programs that run on several processes under mpirun. Link tactoid::mpi, which there is with -D TACTOID_WITH_MPI=ON; without
/// it the same program compiles, needs no MPI, and its session does nothing.

#ifdef TACTOID_WITH_MPI

#include <tactoid/mpi/all.hpp>

#else

#include <cstddef>

#include <tactoid/core/ranks.hpp>

namespace tactoid::mpi {

/// Without MPI: without effect.
struct SessionOptions {
  double patience = 10.0;  ///< s
  bool always = false;     ///< without effect
};

/// Without MPI: this process is the only rank.
class Session {
 public:
  Session(int&, char**&, const SessionOptions& = {}) {}  ///< does nothing
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] int rank() const { return 0; }  ///< of this process
  [[nodiscard]] int size() const { return 1; }  ///< number of processes
  SumOrder sum_order = SumOrder::of_one_process;  ///< without effect
  SetUp set_up = SetUp::whole;                    ///< without effect
  std::size_t divided_contacts_from = 8192;       ///< without effect
};

}  // namespace tactoid::mpi

#endif
