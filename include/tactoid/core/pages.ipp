#pragma once

#include <cstdint>
#include <cstdlib>  // which says whether the C library is glibc

#ifdef __GLIBC__
#include <malloc.h>
#endif
#ifdef __linux__
#include <sys/mman.h>
#include <unistd.h>
#endif

#include <tactoid/core/compiled.hpp>
#include <tactoid/core/pages.hpp>

namespace tactoid::detail {

TACTOID_INLINE void give_back_pages([[maybe_unused]] std::byte* first, [[maybe_unused]] std::byte* last) {
#ifdef __linux__
  static const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const std::uintptr_t begin = (reinterpret_cast<std::uintptr_t>(first) + page - 1) / page * page, end = reinterpret_cast<std::uintptr_t>(last) / page * page;
  if (begin < end) (void)::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);  // where it fails, the memory stays
#endif
}

}  // namespace tactoid::detail

namespace tactoid {

TACTOID_INLINE void give_back_released() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

}  // namespace tactoid
