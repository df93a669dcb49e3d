#pragma once

#include <cerrno>
#include <system_error>

#include <unistd.h>

#include <tactoid/core/compiled.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/core/read_file.hpp>
#include <tactoid/output/file.hpp>

namespace tactoid {

TACTOID_INLINE void prepare_folder(const std::filesystem::path& path) {
  if (!is_first_rank()) return;
  if (path.empty()) throw FileError("Cannot make an output folder without a name.");
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) detail::fail_file("make the folder", path, error.value());
  if (!std::filesystem::is_directory(path, error)) detail::fail_file("make the folder", path, ENOTDIR);
  if (::access(path.c_str(), W_OK | X_OK) != 0) detail::fail_file("write in the folder", path, errno);
}

}  // namespace tactoid
