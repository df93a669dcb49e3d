#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <utility>

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

/// Sums are added up in so many parts, whatever the number of threads or of processes.
inline constexpr std::size_t sum_parts = 64;

/// The items of part p of a sum over [0, count): [first, last).
[[nodiscard]] inline std::pair<std::size_t, std::size_t> sum_part(std::size_t count, std::size_t p) {
  const std::size_t length = (count + sum_parts - 1) / sum_parts;
  return {std::min(count, p * length), std::min(count, (p + 1) * length)};
}

/// Σ_i term(i) over [0, count), on all threads, where `zero` changes no sum. Terms are added up in parts: the same bits for any number of threads. Some terms are
/// made before they are added: a product is rounded before it is, as it is where terms come from several processes.
template <class T = double, class Term>
[[nodiscard]] T parallel_sum(std::size_t count, const Term& term, const T& zero = T()) {
  std::array<T, sum_parts> parts;
  parallel_for(sum_parts, [&](std::size_t p) {
    T sum = zero;
    const auto [first, last] = sum_part(count, p);
    std::array<T, 64> terms;
    for (std::size_t i = first; i < last; i += terms.size()) {
      const std::size_t n = std::min(terms.size(), last - i);
      for (std::size_t k = 0; k < n; ++k) terms[k] = term(i + k);
      for (std::size_t k = 0; k < n; ++k) sum += terms[k];
    }
    parts[p] = sum;
  });
  T total = zero;
  for (const T& part : parts) total += part;
  return total;
}

}  // namespace tactoid
