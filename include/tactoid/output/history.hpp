#pragma once

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/output/file.hpp>

namespace tactoid {

/// A table of numbers over time (.csv): a line of column names, then one line per call, each on the disc before the
/// call returns, or, where the disc is full, not at all. Numbers are written in the shortest form that reads back as the same double.
/// Of several processes that share a simulation the first one writes.
class HistoryWriter {
 public:
  /// Begins the file anew; or goes on with it, if it is there, behind the last line whose value in the column `key` (the first one
  /// if empty; a time, which grows from line to line) is at most `keep_until`: what a run wrote before the state from which it is
  /// continued. Throws FileError; ParameterError for a column without a name, with a comma, or named twice, for a `key` that is no
  /// column, and where the file has other columns.
  HistoryWriter(std::filesystem::path path, std::vector<std::string> columns, std::optional<double> keep_until = {}, const std::string& key = "");

  [[nodiscard]] const std::vector<std::string>& columns() const { return columns_; }  ///< their names

  /// Writes one line: one value per column. Throws ParameterError for another count, FileError.
  void write(std::span<const double> values);

 private:
  [[nodiscard]] std::string lines_until(const std::string& head, std::ptrdiff_t column, double last) const;
  void put(const std::string& line);

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_;
  std::vector<std::string> columns_;
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/output/history.ipp>
#endif
