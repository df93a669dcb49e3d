#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/core/read_file.hpp>

namespace tactoid {

TACTOID_INLINE std::string read_file(const std::filesystem::path& path) {
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
