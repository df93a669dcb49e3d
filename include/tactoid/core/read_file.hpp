#pragma once

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/text.hpp>

namespace tactoid {

namespace detail {
[[nodiscard]] inline std::string file_failure(std::string_view what, const std::filesystem::path& path, int error) {
  return fmt::format("Cannot {} {}: {}.", what, in_quotes(path.string()), std::generic_category().message(error));
}
[[noreturn]] inline void fail_file(std::string_view what, const std::filesystem::path& path, int error) { throw FileError(file_failure(what, path, error)); }
}  // namespace detail

/// The whole content of `path`. Throws FileError.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/core/read_file.ipp>
#endif
