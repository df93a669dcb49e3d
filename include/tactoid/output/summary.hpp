#pragma once

#include <cmath>
#include <concepts>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactoid/core/text.hpp>
#include <tactoid/output/file.hpp>

namespace tactoid {

/// A JSON object (.json) whose members keep the order in which they were first set: numbers, texts, truth values,
/// arrays of them, and objects. JSON has no NaN and no infinity: they become null. Bytes that are no UTF-8 become
/// U+FFFD.
class Summary {
 public:
  /// Sets a member, anew if it is there: a number, bool, text, a std::vector of them, or a Summary.
  template <class T>
  Summary& set(std::string_view key, const T& value) {
    std::string json = to_json(value);
    for (auto& [name, text] : members_) {
      if (name != key) continue;
      text = std::move(json);
      return *this;
    }
    members_.emplace_back(key, std::move(json));
    return *this;
  }

  /// The object as text; lines after the first begin with `indent` blanks.
  [[nodiscard]] std::string json(int indent = 0) const;

  /// Writes the file, whole or not at all. Throws FileError.
  void write(const std::filesystem::path& path) const { write_file(path, json() + '\n'); }

 private:
  static std::string to_json(const Summary& object) { return object.json(); }
  static std::string to_json(bool value) { return value ? "true" : "false"; }
  template <std::floating_point T>
  static std::string to_json(T value) {
    return std::isfinite(value) ? fmt::format("{}", value) : "null";
  }
  template <std::integral T>
  static std::string to_json(T value) {
    return fmt::format("{}", value);
  }
  static std::string to_json(const char* text) { return to_json(std::string_view(text)); }
  static std::string to_json(const std::string& text) { return to_json(std::string_view(text)); }
  static std::string to_json(std::string_view text);
  template <class T>
  static std::string to_json(const std::vector<T>& values) {
    std::string result = "[";
    for (std::size_t i = 0; i < values.size(); ++i) result += (i == 0 ? "" : ", ") + to_json(T(values[i]));
    return result + "]";
  }

  std::vector<std::pair<std::string, std::string>> members_;
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/output/summary.ipp>
#endif
