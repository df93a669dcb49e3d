#pragma once

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <unistd.h>

#include <fmt/format.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/core/read_file.hpp>

namespace tactoid {

/// A file that appears whole or not at all: it is written beside its place under another name, and commit() moves it
/// there. Without commit() nothing remains. Every failure throws FileError with the path and the system's reason. Of several
/// processes that share a simulation the first one writes, and the others do nothing.
class AtomicFile {
 public:
  /// Opens the file beside `path`. With `on_every_rank` it is a file of this process's own, and each process writes.
  explicit AtomicFile(std::filesystem::path path, bool on_every_rank = false) : path_(std::move(path)), temporary_(path_) {
    if (!on_every_rank && !is_first_rank()) return;
    temporary_ += ".part";
    file_ = std::fopen(temporary_.c_str(), "wb");
    if (file_ == nullptr) detail::fail_file("write", path_, errno);
  }
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile() {
    if (file_ == nullptr) return;
    std::fclose(file_);
    std::remove(temporary_.c_str());
  }

  /// Appends bytes.
  void write(const void* bytes, std::size_t count) {
    if (file_ != nullptr && count > 0 && std::fwrite(bytes, 1, count, file_) != count) detail::fail_file("write", path_, errno);
  }
  /// Appends a text as it is.
  void write(std::string_view text) { write(text.data(), text.size()); }

  /// With `to_disc` the content is on the disc before it takes the place of a former file, should the power fail.
  void commit(bool to_disc = false) {
    if (file_ == nullptr) return;
    const bool flushed = std::fflush(file_) == 0 && (!to_disc || ::fsync(::fileno(file_)) == 0);
    const int flush_error = errno;
    const bool closed = std::fclose(std::exchange(file_, nullptr)) == 0;
    const int error = flushed ? errno : flush_error;
    if (flushed && closed && std::rename(temporary_.c_str(), path_.c_str()) == 0) return;
    const int reason = flushed && closed ? errno : error;
    std::remove(temporary_.c_str());
    detail::fail_file("write", path_, reason);
  }

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  std::FILE* file_ = nullptr;
};

/// Writes `text` to `path`, whole or not at all. Throws FileError.
inline void write_file(const std::filesystem::path& path, std::string_view text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

/// Makes the folder `path`, with its parents, unless it is there, and makes sure that files can be made in it: the first of several
/// processes, as AtomicFile. Throws FileError.
inline void prepare_folder(const std::filesystem::path& path) {
  if (!is_first_rank()) return;
  if (path.empty()) throw FileError("Cannot make an output folder without a name.");
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) detail::fail_file("make the folder", path, error.value());
  if (!std::filesystem::is_directory(path, error)) detail::fail_file("make the folder", path, ENOTDIR);
  if (::access(path.c_str(), W_OK | X_OK) != 0) detail::fail_file("write in the folder", path, errno);
}

}  // namespace tactoid
