#pragma once

// Needs zlib; no other header of the library does, and neither <tactoid/tactoid.hpp> nor all.hpp includes this one:
//   find_package(ZLIB REQUIRED)
//   target_link_libraries(my_program PRIVATE tactoid::tactoid ZLIB::ZLIB)

#include <cstddef>
#include <string>
#include <string_view>

#include <zlib.h>

#include <tactoid/input/vtu.hpp>

namespace tactoid {

/// The `size` bytes that zlib compressed to `bytes`; an empty string if they are damaged. For VtuOptions.decompress:
/// ParaView and meshio compress unless they are told not to.
[[nodiscard]] inline std::string zlib_decompress(std::string_view bytes, std::size_t size) {
  std::string result(size, '\0');
  auto length = static_cast<uLongf>(size);
  const int status = ::uncompress(reinterpret_cast<Bytef*>(result.data()), &length,
                                  reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()));
  return status == Z_OK && length == size ? result : std::string();
}

}  // namespace tactoid
