#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <tactoid/output/history.hpp>

namespace tactoid::verification {

/// How much a study computes: `fast` is part of the tests (seconds), `full` is the study itself (minutes).
enum class Level { fast, full };

/// What a study measured, each with what it is compared with. A study that records no requirement has failed.
class Report {
 public:
  struct Line {
    std::string study = {}, quantity = {}, source = {};
    double value = 0.0, reference = 0.0, error = 0.0, allowed = 0.0;
    enum class Kind { compare, at_most, at_least, note } kind = Kind::note;
    bool passed = true;
  };

  /// Files of the study go to `folder`, which exists.
  Report(std::string study, std::filesystem::path folder) : study_(std::move(study)), folder_(std::move(folder)) {}

  /// |value − reference| <= allowed · |reference|. `source`: where the reference comes from.
  void compare(std::string quantity, double value, double reference, double allowed, std::string source);
  /// value <= limit: an error, a drift.
  void at_most(std::string quantity, double value, double limit, std::string source);
  /// value >= limit: an order of convergence.
  void at_least(std::string quantity, double value, double limit, std::string source);
  /// Reported, not required: what users should know. `reference` NaN: there is none.
  void note(std::string quantity, double value, double reference, std::string source);

  /// A table for the plots, `<folder>/<study>_<name>.csv`: SI units, unit in the column's name where there is one.
  [[nodiscard]] HistoryWriter table(std::string_view name, std::vector<std::string> columns) const;
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  [[nodiscard]] const std::vector<Line>& lines() const { return lines_; }
  [[nodiscard]] bool passed() const;
  [[nodiscard]] const std::string& study() const { return study_; }

 private:
  void add(Line line);
  std::string study_;
  std::filesystem::path folder_;
  std::vector<Line> lines_;
};

struct Study {
  std::string_view name, purpose;
  void (*run)(Report&, Level);
};

}  // namespace tactoid::verification
