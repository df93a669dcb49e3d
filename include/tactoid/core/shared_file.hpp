#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <utility>

#include <tactoid/core/read_file.hpp>

namespace tactoid {

/// A file that exists already, into which all processes that share a simulation write at once. All functions are collective.
class SharedFile {
 public:
  SharedFile() = default;
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;
  virtual ~SharedFile() = default;

  /// Writes what this process has, `offset` bytes behind the beginning; it may be nothing. That something could not be written close() says.
  virtual void write_at(std::uint64_t offset, std::span<const std::byte> bytes) = 0;
  /// Ends it. Throws FileError on all processes, with the path and the reason, where one of them could not write.
  virtual void close() = 0;
};

/// The same where one process writes.
class FileOfOne final : public SharedFile {
 public:
  /// Throws FileError where the file cannot be opened.
  explicit FileOfOne(std::filesystem::path path) : path_(std::move(path)), file_(std::fopen(path_.c_str(), "r+b"), std::fclose) {
    if (file_ == nullptr) detail::fail_file("write", path_, errno);
  }
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes) override {
    if (error_ != 0 || bytes.empty()) return;
    if (std::fseek(file_.get(), static_cast<long>(offset), SEEK_SET) != 0 || std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) error_ = errno;
  }
  void close() override {
    if (std::fclose(file_.release()) != 0 && error_ == 0) error_ = errno;
    if (error_ != 0) detail::fail_file("write", path_, error_);
  }

 private:
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  int error_ = 0;  // the first one
};

}  // namespace tactoid
