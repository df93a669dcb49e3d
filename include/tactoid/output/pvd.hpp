#pragma once

#include <charconv>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <tactoid/output/file.hpp>

namespace tactoid {

/// A series of grids in time (.pvd), which ParaView opens as one. The file is written anew, whole, after each grid, so
/// that an interrupted run can be read up to its last frame.
class PvdSeries {
 public:
  /// Nothing is written before the first grid.
  explicit PvdSeries(std::filesystem::path path) : path_(std::move(path)) {}

  /// Goes on with a series that is there: the grids up to this time (s) stay in it.
  void keep_until(double time);

  /// Adds the grid `file`, a path relative to the folder of the series, at `time` (s). Grids of the same time with
  /// different names of `part` are the parts of one picture. Throws FileError.
  void add(double time, std::string_view file, std::string_view part = "");

 private:
  int part_number(double time) {
    part_ = time == last_time_ && !entries_.empty() ? part_ + 1 : 0;
    last_time_ = time;
    return part_;
  }
  static std::string escaped(std::string_view text);

  std::filesystem::path path_;
  std::string entries_;
  double last_time_ = 0.0;
  int part_ = 0;
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/output/pvd.ipp>
#endif
