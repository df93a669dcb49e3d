#pragma once

#include <filesystem>
#include <string_view>

#include <tactoid/core/atomic_file.hpp>

namespace tactoid {

/// Writes `text` to `path`, whole or not at all. Throws FileError.
inline void write_file(const std::filesystem::path& path, std::string_view text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

/// Makes the folder `path`, with its parents, unless it is there, and makes sure that files can be made in it: the first of several
/// processes, as AtomicFile. Throws FileError.
void prepare_folder(const std::filesystem::path& path);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/output/file.ipp>
#endif
