#pragma once

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include <tactoid/core/read_file.hpp>

namespace tactoid {

/// A file that appears whole or not at all: it is written beside its place under another name, and commit() moves it
/// there. Without commit() nothing remains. Every failure throws FileError with the path and the system's reason. Of several
/// processes that share a simulation the first one writes, and the others do nothing.
class AtomicFile {
 public:
  /// Opens the file beside `path`. With `on_every_rank` it is a file of this process's own, and each process writes.
  explicit AtomicFile(std::filesystem::path path, bool on_every_rank = false);
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

  /// Where it is written until commit(), for libraries that write by name; empty where this process does not write.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }

  /// With `to_disc` the content is on the disc before it takes the place of a former file, should the power fail.
  void commit(bool to_disc = false);

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  std::FILE* file_ = nullptr;
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/core/atomic_file.ipp>
#endif
