#pragma once

#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>

namespace tactoid {

/// One measured figure of a gate, with the limits between which it must be.
struct GateFigure {
  std::string name;  ///< what was measured
  double value = 0.0;  ///< the figure
  double lowest = -std::numeric_limits<double>::infinity();  ///< least value that passes; −∞: not required
  double highest = std::numeric_limits<double>::infinity();  ///< largest value that passes; ∞: not required
  std::string note;  ///< what it means, where the name does not say it

  /// False for a NaN, unless nothing is required of the figure.
  [[nodiscard]] bool required() const { return std::isfinite(lowest) || std::isfinite(highest); }
  /// Within the limits.
  [[nodiscard]] bool passed() const { return !required() || (value >= lowest && value <= highest); }
};

/// What a gate has measured; printable, and passed or not.
struct GateReport {
  std::vector<GateFigure> figures;  ///< in the order in which they were measured

  /// True if every required figure is within its limits (and there is one at all).
  [[nodiscard]] bool passed() const {
    bool any = false;
    for (const GateFigure& f : figures) {
      if (!f.passed()) return false;
      any = any || f.required();
    }
    return any;
  }

  /// The figure of that name; throws ParameterError if there is none.
  [[nodiscard]] const GateFigure& figure(std::string_view name) const {
    for (const GateFigure& f : figures)
      if (f.name == name) return f;
    throw ParameterError("The gate's report has no figure named '" + std::string(name) + "'.");
  }

  /// Adds a figure that must not exceed `highest`.
  void at_most(std::string name, double value, double highest, std::string note = "") {
    figures.push_back({.name = std::move(name), .value = value, .highest = highest, .note = std::move(note)});
  }
  /// Adds a figure that must reach `lowest`.
  void at_least(std::string name, double value, double lowest, std::string note = "") {
    figures.push_back({.name = std::move(name), .value = value, .lowest = lowest, .note = std::move(note)});
  }
  /// Adds a figure of which nothing is required.
  void note(std::string name, double value, std::string note = "") {
    figures.push_back({.name = std::move(name), .value = value, .note = std::move(note)});
  }

  /// One line per figure: passed, FAILED or (not required) blank; name, value, limit, note.
  [[nodiscard]] std::string text() const {
    std::ostringstream out;
    out << std::setprecision(3);
    for (const GateFigure& f : figures) {
      out << (!f.required() ? "        " : f.passed() ? "passed  " : "FAILED  ");
      out << std::left << std::setw(40) << f.name << " " << std::right << std::setw(10) << f.value;
      if (std::isfinite(f.highest)) out << "  <= " << f.highest;
      if (std::isfinite(f.lowest)) out << "  >= " << f.lowest;
      if (!f.note.empty()) out << "  (" << f.note << ")";
      out << "\n";
    }
    out << (passed() ? "passed\n" : "FAILED\n");
    return out.str();
  }
};

}  // namespace tactoid
