#include "study.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace tactoid::verification {

void Report::add(Line line) {
  line.study = study_;
  const char* verdict = line.kind == Line::Kind::note ? "reported" : line.passed ? "pass" : "FAIL";
  switch (line.kind) {
    case Line::Kind::compare:
      fmt::print("  {:<58} {:>12.6g}  expected {:>12.6g}  error {:>9.2e} (allowed {:.1e})  {}\n", line.quantity,
                 line.value, line.reference, line.error, line.allowed, verdict);
      break;
    case Line::Kind::at_most:
    case Line::Kind::at_least:
      fmt::print("  {:<58} {:>12.6g}  {} {:<12.6g}  {}\n", line.quantity, line.value,
                 line.kind == Line::Kind::at_most ? "at most " : "at least", line.allowed, verdict);
      break;
    case Line::Kind::note:
      if (std::isnan(line.reference))
        fmt::print("  {:<58} {:>12.6g}  {}\n", line.quantity, line.value, verdict);
      else
        fmt::print("  {:<58} {:>12.6g}  expected {:>12.6g}  error {:>9.2e}  {}\n", line.quantity, line.value,
                   line.reference, line.error, verdict);
      break;
  }
  std::fflush(stdout);
  lines_.push_back(std::move(line));
}

void Report::compare(std::string quantity, double value, double reference, double allowed, std::string source) {
  const double error = std::abs(value - reference) / std::abs(reference);
  add({.quantity = std::move(quantity),
       .source = std::move(source),
       .value = value,
       .reference = reference,
       .error = error,
       .allowed = allowed,
       .kind = Line::Kind::compare,
       .passed = error <= allowed});
}

void Report::at_most(std::string quantity, double value, double limit, std::string source) {
  add({.quantity = std::move(quantity),
       .source = std::move(source),
       .value = value,
       .allowed = limit,
       .kind = Line::Kind::at_most,
       .passed = value <= limit});
}

void Report::at_least(std::string quantity, double value, double limit, std::string source) {
  add({.quantity = std::move(quantity),
       .source = std::move(source),
       .value = value,
       .allowed = limit,
       .kind = Line::Kind::at_least,
       .passed = value >= limit});
}

void Report::note(std::string quantity, double value, double reference, std::string source) {
  add({.quantity = std::move(quantity),
       .source = std::move(source),
       .value = value,
       .reference = reference,
       .error = std::abs(value - reference) / std::abs(reference)});
}

HistoryWriter Report::table(std::string_view name, std::vector<std::string> columns) const {
  return {folder_ / fmt::format("{}_{}.csv", study_, name), std::move(columns)};
}

bool Report::passed() const {
  const auto required = [](const Line& line) { return line.kind != Line::Kind::note; };
  return std::any_of(lines_.begin(), lines_.end(), required) &&
         std::all_of(lines_.begin(), lines_.end(), [](const Line& line) { return line.passed; });
}

}  // namespace tactoid::verification
