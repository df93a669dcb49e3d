#pragma once

#include <utility>

#include <unistd.h>

#include <tactoid/core/atomic_file.hpp>
#include <tactoid/core/compiled.hpp>
#include <tactoid/core/ranks.hpp>

namespace tactoid {

TACTOID_INLINE AtomicFile::AtomicFile(std::filesystem::path path, bool on_every_rank)
    : path_(std::move(path)) {
  if (!on_every_rank && !is_first_rank()) return;
  temporary_ = path_;
  temporary_ += ".part";
  file_ = std::fopen(temporary_.c_str(), "wb");
  if (file_ == nullptr) detail::fail_file("write", path_, errno);
}

TACTOID_INLINE void AtomicFile::commit(bool to_disc) {
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

}  // namespace tactoid
