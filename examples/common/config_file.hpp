#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/output/file.hpp>

namespace tactoid {

/// One line `key = value` of a configuration file.
struct ConfigEntry {
  enum class Kind { number, text, truth };
  std::string key;
  std::string value;
  Kind kind = Kind::text;
};

/// Reads a TOML text of `key = value` lines, without sections. Throws ParameterError with its `name` and the line where it
/// is no such text.
[[nodiscard]] inline std::vector<ConfigEntry> read_config(std::string_view text, const std::string& name) {
  toml::table table;
  try {
    table = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw ParameterError(fmt::format("{}, line {}: {}.", name, error.source().begin.line, error.description()));
  }
  std::vector<ConfigEntry> entries;
  for (const auto& [key, node] : table) {
    const std::string key_text(key.str());
    const auto line = node.source().begin.line;
    if (const auto* number = node.as_integer()) {
      entries.push_back({key_text, fmt::format("{}", number->get()), ConfigEntry::Kind::number});
    } else if (const auto* real = node.as_floating_point()) {
      entries.push_back({key_text, fmt::format("{}", real->get()), ConfigEntry::Kind::number});
    } else if (const auto* words = node.as_string()) {
      entries.push_back({key_text, words->get(), ConfigEntry::Kind::text});
    } else if (const auto* truth = node.as_boolean()) {
      entries.push_back({key_text, truth->get() ? "true" : "false", ConfigEntry::Kind::truth});
    } else {
      const char* kind = node.is_table() ? "a section" : node.is_array() ? "an array" : "a date or time";
      throw ParameterError(fmt::format("{}, line {}: {} is {}, but only numbers, texts and truth values are allowed.",
                                       name, line, in_quotes(key_text), kind));
    }
  }
  return entries;
}

/// Of a file. Throws FileError where it cannot be read.
[[nodiscard]] inline std::vector<ConfigEntry> read_config_file(const std::filesystem::path& path) {
  return read_config(read_file(path), path.filename().string());
}

/// `text` as a TOML string.
[[nodiscard]] inline std::string toml_text(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      result += {'\\', c};
    else if (byte < 0x20 || byte == 0x7F)
      result += fmt::format("\\u{:04X}", byte);
    else
      result += c;
  }
  return result + '"';
}

}  // namespace tactoid
