#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace tactoid {

/// Threads that the loops below use.
[[nodiscard]] inline int thread_count() {
#ifdef _OPENMP
  return omp_get_max_threads();
#else
  return 1;
#endif
}

/// Sets the number of threads; without OpenMP there is always one.
inline void set_thread_count([[maybe_unused]] int threads) {
#ifdef _OPENMP
  omp_set_num_threads(threads);
#endif
}

/// Calls body(i) for i in [0, count), on all threads. The calls must not depend on each other, and what they
/// write must not depend on the thread: then the result is the same to the bit for any number of threads.
/// An exception in a call is rethrown here after all the others have ended.
template <class Body>
void parallel_for(std::size_t count, const Body& body) {
  std::exception_ptr failure;
#ifdef _OPENMP
#pragma omp parallel for schedule(static)
#endif
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(count); ++i) {
    try {
      body(static_cast<std::size_t>(i));
    } catch (...) {
#ifdef _OPENMP
#pragma omp critical(tactoid_failure)
#endif
      if (!failure) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

/// Σ_i term(i) over [0, count), on all threads, where `zero` changes no sum. Terms are added up in 64 parts, whatever the number of threads: the same
/// bits for any.
template <class T = double, class Term>
[[nodiscard]] T parallel_sum(std::size_t count, const Term& term, const T& zero = T()) {
  std::array<T, 64> parts;
  const std::size_t size = (count + parts.size() - 1) / parts.size();
  parallel_for(parts.size(), [&](std::size_t p) {
    T sum = zero;
    for (std::size_t i = p * size; i < std::min(count, (p + 1) * size); ++i) sum += term(i);
    parts[p] = sum;
  });
  T total = zero;
  for (const T& part : parts) total += part;
  return total;
}

}  // namespace tactoid
