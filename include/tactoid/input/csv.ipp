#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/input/csv.hpp>

namespace tactoid::detail {

template <int D>
PointCloud<D> CsvReader<D>::read(const PointsOptions& options) {
  options.validate();
  std::string_view rest = content_;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);  // the mark of some spreadsheets
  bool has_header = false;
  for (line_ = 1; !rest.empty(); ++line_) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (trimmed(line).empty() || trimmed(line).front() == '#') continue;
    if (!is_utf8(line) || line.find('\0') != std::string_view::npos) refuse("there are bytes that are no text.");
    if (has_header)
      row(line);
    else
      header(line);
    has_header = true;
  }
  if (!has_header)
    throw FileError(fmt::format("{} has no line with the names of the columns: {}.", name_, allowed()));
  if (points_.positions.empty())
    throw FileError(fmt::format("{} has no points below the names of its columns.", name_));
  return cloud_of_points<D>(std::move(points_), options, name_,
                            [&](std::size_t i) { return fmt::format("the point of line {}", lines_[i]); });
}

template <int D>
void CsvReader<D>::header(std::string_view line) {
  const std::string_view separators = ",;\t";
  for (const char c : separators) {
    if (line.find(c) == std::string_view::npos) continue;
    if (separator_ != '\0')
      refuse("the names of the columns are separated in two ways: use one of comma, semicolon and tab.");
    separator_ = c;
  }
  if (separator_ == '\0')
    refuse(fmt::format("{} is no list of columns separated by comma, semicolon or tab: {}.",
                       in_quotes(line.substr(0, 60)), allowed()));
  for (const std::string_view field : fields(line)) {
    const auto found = std::find(names.begin(), names.end(), field);
    if (found == names.end()) refuse(fmt::format("there is no column {}: {}.", in_quotes(field), allowed()));
    const auto column = static_cast<std::size_t>(found - names.begin());
    if (std::find(order_.begin(), order_.end(), column) != order_.end())
      refuse(fmt::format("the column {} is there twice.", field));
    order_.push_back(column);
  }
  for (std::size_t k = 0; k < static_cast<std::size_t>(D); ++k)
    if (!has(k)) refuse(fmt::format("the column {} is missing: {}.", names[k], allowed()));
  if (has(region)) points_.regions.clear();
}

template <int D>
void CsvReader<D>::row(std::string_view line) {
  const std::vector<std::string_view> all = fields(line);
  if (all.size() != order_.size())
    refuse(fmt::format("there {} {} field{}, but {} columns.", all.size() == 1 ? "is" : "are", all.size(),
                       all.size() == 1 ? "" : "s", order_.size()));
  Vector3 X = Vector3::Zero();
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (order_[k] == region) {
      points_.point_regions.push_back(region_of(all[k]));
      continue;
    }
    const std::optional<double> value = number_in<double>(all[k]);
    if (!value)
      refuse(fmt::format("{} = {} is no number{}.", names[order_[k]], in_quotes(all[k]),
                         all[k].find(',') != std::string_view::npos ? ": write a point, no comma" : ""));
    if (!std::isfinite(*value)) refuse(fmt::format("{} = {} is not finite.", names[order_[k]], all[k]));
    if (order_[k] == volume) {
      if (!(*value > 0.0)) refuse(fmt::format("volume = {:g} is not allowed: it must be positive.", *value));
      points_.volumes.push_back(*value);
    } else {
      X[static_cast<Eigen::Index>(order_[k])] = *value;
    }
  }
  if (D == 2 && X[2] != 0.0)
    refuse(fmt::format("z = {:g} is not allowed: a cloud of 2 dimensions lies in the plane z = 0.", X[2]));
  points_.positions.push_back(X.head<D>());
  lines_.push_back(line_);
}

template <int D>
std::vector<std::string_view> CsvReader<D>::fields(std::string_view line) const {
  std::vector<std::string_view> all;
  for (;;) {
    std::size_t end = std::min(line.find(separator_), line.size());
    if (const std::size_t quote = line.find_first_not_of(' ');
        quote != std::string_view::npos && line[quote] == '"') {
      const std::size_t closing = line.find('"', quote + 1);
      if (closing == std::string_view::npos) refuse("a quotation mark is not closed.");
      end = std::min(line.find(separator_, closing), line.size());
      if (!trimmed(line.substr(closing + 1, end - closing - 1)).empty())
        refuse("there is something between a quotation mark and the next column.");
      all.push_back(trimmed(line.substr(quote + 1, closing - quote - 1)));
    } else {
      all.push_back(trimmed(line.substr(0, end)));
    }
    if (end == line.size()) return all;
    line.remove_prefix(end + 1);
  }
}

}  // namespace tactoid::detail

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template class CsvReader<2>;
template class CsvReader<3>;
}  // namespace tactoid::detail
#endif
