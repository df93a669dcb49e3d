#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/read_file.hpp>
#include <tactoid/core/text.hpp>
#include <tactoid/input/mesh.hpp>
#include <tactoid/input/points.hpp>

namespace tactoid {

namespace detail {

/// Reader of one table of points.
template <int D>
class CsvReader {
 public:
  explicit CsvReader(const std::filesystem::path& path) : name_(in_quotes(path.string())), content_(read_file(path)) {}

  PointCloud<D> read(const PointsOptions& options);

 private:
  enum Column : std::size_t { x, y, z, volume, region, columns };
  static constexpr std::array<std::string_view, columns> names = {"x", "y", "z", "volume", "region"};

  [[nodiscard]] static std::string allowed() {
    return D == 3 ? "x, y and z are needed, volume and region may follow"
                  : "x and y are needed; z (which must be 0), volume and region may follow";
  }
  [[noreturn]] void refuse(std::string_view what) const {
    throw FileError(fmt::format("{}, line {}: {}", name_, line_, what));
  }

  void header(std::string_view line);

  void row(std::string_view line);

  /// The number of a region by the name, or by the id, which gives the name "region 7".
  [[nodiscard]] std::size_t region_of(std::string_view field) {
    if (field.empty()) refuse("the region is empty: it must be a name or a whole number.");
    const std::optional<long long> id = number_in<long long>(field);
    return region_number(points_.regions, id ? fmt::format("region {}", *id) : std::string(field));
  }

  [[nodiscard]] bool has(std::size_t column) const {
    return std::find(order_.begin(), order_.end(), column) != order_.end();
  }

  /// The fields of a line, without blanks and quotes around them.
  [[nodiscard]] std::vector<std::string_view> fields(std::string_view line) const;

  std::string name_, content_;
  std::size_t line_ = 0;
  char separator_ = '\0';
  std::vector<std::size_t> order_;  // the columns, from left to right
  std::vector<std::size_t> lines_;  // of the points
  Points<D> points_;
};

}  // namespace detail

/// Reads points from a table as a cloud, with cells between them by cloud_of_points. The first line names the columns,
/// in any order: x, y and z (D = 2: x, y) in units of `scale`, and where known volume, in units of scale³ (scale²), and
/// region, a name or a whole number n, which becomes "region n". Columns are separated by comma, semicolon or tab,
/// numbers have a decimal point; blank lines and those that begin with # are left out.
///
///   PointCloud<3> cloud = read_csv<3>("cell.csv", {.scale = 1e-6});   // coordinates in µm
///
/// Throws FileError for a file that cannot be read or is no such table, with the line; as cloud_of_points for the
/// points.
template <int D>
  requires(D > 1)
[[nodiscard]] PointCloud<D> read_csv(const std::filesystem::path& path, const PointsOptions& options = {}) {
  return detail::CsvReader<D>(path).read(options);
}

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/input/csv.ipp>
#endif
