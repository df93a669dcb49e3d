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
[[noreturn]] inline void fail_file(std::string_view what, const std::filesystem::path& path, int error) {
  throw FileError(
      fmt::format("Cannot {} {}: {}.", what, in_quotes(path.string()), std::generic_category().message(error)));
}
}  // namespace detail

/// The whole content of `path`. Throws FileError.
[[nodiscard]] inline std::string read_file(const std::filesystem::path& path) {
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
  if (!file) detail::fail_file("read", path, errno);
  std::string bytes;
  std::vector<char> buffer(std::size_t{1} << 16);
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file.get())) bytes.append(buffer.data(), count);
  if (std::ferror(file.get())) detail::fail_file("read", path, errno);
  return bytes;
}

}  // namespace tactoid
