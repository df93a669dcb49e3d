#pragma once

#include <limits>
#include <string>

#include <fmt/format.h>

#include <tactoid/core/quantity.hpp>

namespace tactoid {

/// The values that an option allows.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool without_min = false;
  bool without_max = false;

  static Range any() { return {}; }
  static Range positive() { return {.min = 0.0, .without_min = true}; }
  static Range non_negative() { return {.min = 0.0}; }
  static Range at_least(double min) { return {.min = min}; }
  static Range between(double min, double max) { return {.min = min, .max = max}; }  ///< both allowed
  static Range inside(double min, double max) {                                      ///< neither allowed
    return {.min = min, .max = max, .without_min = true, .without_max = true};
  }

  [[nodiscard]] bool contains(double value) const {
    return (without_min ? value > min : value >= min) && (without_max ? value < max : value <= max);
  }

  /// "positive", "between 0 and 1", "above 1 nm and at most 5 um"; empty where everything is allowed.
  [[nodiscard]] std::string text(const Quantity& quantity = Quantity::dimensionless) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const auto shown = [&](double value) { return value == 0.0 ? std::string("0") : format_quantity(value, quantity); };
    if (min == -infinity && max == infinity) return "";
    if (max == infinity && min == 0.0) return without_min ? "positive" : "zero or positive";
    if (min > -infinity && max < infinity && !without_min && !without_max)
      return fmt::format("between {} and {}", shown(min), shown(max));
    std::string result;
    if (min > -infinity) result = fmt::format("{} {}", without_min ? "above" : "at least", shown(min));
    if (max < infinity)
      result += fmt::format("{}{} {}", result.empty() ? "" : " and ", without_max ? "below" : "at most", shown(max));
    return result;
  }
};

}  // namespace tactoid
