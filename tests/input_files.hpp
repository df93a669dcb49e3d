#pragma once

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include <tactoid/core/errors.hpp>

namespace tactoid::test {

/// A folder that goes with the test.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("tactoid_input_{}", std::random_device{}());
  Folder() { std::filesystem::create_directories(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path); }
  [[nodiscard]] std::filesystem::path write(const std::string& content, const std::string& name = "file") const {
    std::ofstream(path / name, std::ios::binary) << content;
    return path / name;
  }
};

/// What the library says about something it refuses.
template <class Call>
std::string refusal(const Call& call) {
  try {
    (void)call();
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}
/// Whether a refusal is one sentence that says so.
inline bool says(const std::string& message, const std::string& what) {
  const bool does =
      message.find(what) != std::string::npos && message.find('\n') == std::string::npos && message.back() == '.';
  if (!does) MESSAGE(message);
  return does;
}

}  // namespace tactoid::test
