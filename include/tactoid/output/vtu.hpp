#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/output/file.hpp>

namespace tactoid {

namespace detail {

template <class T>
concept VtkNumber = std::same_as<T, double> || std::same_as<T, float> || std::same_as<T, std::uint8_t> ||
                    std::same_as<T, std::int32_t> || std::same_as<T, std::uint32_t> || std::same_as<T, std::int64_t>;

template <VtkNumber T>
[[nodiscard]] constexpr std::string_view vtk_type() {
  if constexpr (std::same_as<T, double>) return "Float64";
  if constexpr (std::same_as<T, float>) return "Float32";
  if constexpr (std::same_as<T, std::uint8_t>) return "UInt8";
  if constexpr (std::same_as<T, std::int32_t>) return "Int32";
  if constexpr (std::same_as<T, std::uint32_t>) return "UInt32";
  if constexpr (std::same_as<T, std::int64_t>) return "Int64";
}

/// A cell of N vertices in VTK: its type, and the place in tensor order (vertex i + 2 j + 4 k) of each VTK vertex.
template <std::size_t N>
struct VtkCell;
template <>
struct VtkCell<1> {
  static constexpr std::uint8_t type = 1;
  static constexpr std::array<std::size_t, 1> order{0};
};
template <>
struct VtkCell<2> {
  static constexpr std::uint8_t type = 3;
  static constexpr std::array<std::size_t, 2> order{0, 1};
};
template <>
struct VtkCell<4> {
  static constexpr std::uint8_t type = 9;
  static constexpr std::array<std::size_t, 4> order{0, 1, 3, 2};
};
template <>
struct VtkCell<8> {
  static constexpr std::uint8_t type = 12;
  static constexpr std::array<std::size_t, 8> order{0, 1, 3, 2, 4, 5, 7, 6};
};

}  // namespace detail

/// One unstructured grid for ParaView and VTK (.vtu): points, cells of any kinds, and data on both.
///
///     VtuGrid grid(time);
///     grid.points(std::span<const Vector4>(positions));
///     grid.cells(cloud.cells);                       // hexahedra, quadrilaterals, lines; tensor order
///     grid.vertices(positions.size());               // each point as a cell of its own
///     grid.point_data("pressure", pressures);        // numbers
///     grid.point_data("displacement", displacements) // Vector4, Vector3: three components; Tensor3: nine, by rows
///     grid.write("frame_0001.vtu");
///
/// Everything is copied when it is given. Data is appended in raw binary: no loss, fast to read.
class VtuGrid {
 public:
  explicit VtuGrid(double time = 0.0) : time_(time) {}  ///< s, as ParaView shows it

  /// The points; those of one or two dimensions get zeros for the missing coordinates.
  template <class P>
  void points(std::span<const P> positions) {
    points_.clear();
    points_.reserve(3 * positions.size());
    for (const P& x : positions)
      for (Eigen::Index k = 0; k < 3; ++k) points_.push_back(k < x.size() ? x[k] : 0.0);
  }
  /// The points, from a list.
  template <class P>
  void points(const std::vector<P>& positions) {
    points(std::span<const P>(positions));
  }

  /// Cells or facets of a point cloud, `offset` being added to their indices (a second body in the same grid).
  template <std::size_t N>
  void cells(std::span<const std::array<Index, N>> corners, Index offset = 0) {
    for (const auto& cell : corners) {
      for (const std::size_t place : detail::VtkCell<N>::order)
        connectivity_.push_back(static_cast<std::int64_t>(cell[place]) + offset);
      offsets_.push_back(static_cast<std::int64_t>(connectivity_.size()));
      types_.push_back(detail::VtkCell<N>::type);
    }
  }
  /// Cells, from a list.
  template <std::size_t N>
  void cells(const std::vector<std::array<Index, N>>& corners, Index offset = 0) {
    cells(std::span<const std::array<Index, N>>(corners), offset);
  }

  /// The points first, first + 1, … as `count` cells of one vertex.
  void vertices(std::size_t count, Index first = 0);

  [[nodiscard]] std::size_t point_count() const { return points_.size() / 3; }  ///< points given
  [[nodiscard]] std::size_t cell_count() const { return types_.size(); }        ///< cells given, vertices included

  /// An array over the points: numbers (`components` of them per point), vectors or tensors.
  template <class Values>
  void point_data(std::string_view name, const Values& values, std::size_t components = 1) {
    point_data_.push_back(make_array(name, std::span(values), components));
  }
  /// An array over the cells, in the order in which the cells were given.
  template <class Values>
  void cell_data(std::string_view name, const Values& values, std::size_t components = 1) {
    cell_data_.push_back(make_array(name, std::span(values), components));
  }

  /// Writes the file, whole or not at all: the first of several processes that share a simulation. Throws ParameterError for
  /// arrays that do not fit the points or cells, FileError where the system refuses.
  void write(const std::filesystem::path& path) const { write(path, false); }

  /// Writes this grid as the piece of this process, `<stem>_<rank>.vtu` beside `path`, and from the first process `path` (.pvtu), which
  /// names the pieces of all and opens as one grid. All processes give the same arrays. Throws as write().
  void write_pieces(const std::filesystem::path& path) const;

 private:
  void write(const std::filesystem::path& path, bool on_every_rank) const;

  struct Array {
    std::string name;
    std::string_view type;
    std::size_t components = 1;
    std::size_t tuples = 0;
    bool whole = true;  // the values fill the last tuple
    std::vector<std::byte> bytes;
  };

  template <class T, std::size_t Extent>
  static Array make_array(std::string_view name, std::span<T, Extent> values, std::size_t components) {
    using Value = std::remove_cv_t<T>;
    if constexpr (detail::VtkNumber<Value>) {
      Array array{.name = std::string(name),
                  .type = detail::vtk_type<Value>(),
                  .components = components,
                  .tuples = components > 0 ? values.size() / components : 0,
                  .whole = components > 0 && values.size() % components == 0,
                  .bytes = std::vector<std::byte>(values.size_bytes())};
      if (!values.empty()) std::memcpy(array.bytes.data(), values.data(), values.size_bytes());
      return array;
    } else {
      constexpr Eigen::Index rows = Value::RowsAtCompileTime, columns = Value::ColsAtCompileTime;
      static_assert(rows > 0 && columns > 0, "VtuGrid takes vectors and tensors of fixed size.");
      std::vector<double> flat;
      if constexpr (columns == 1) {
        for (const Value& v : values)
          for (Eigen::Index k = 0; k < 3; ++k) flat.push_back(k < rows ? v[k] : 0.0);
        return make_array(name, std::span<const double>(flat), 3);
      } else {
        for (const Value& v : values)
          for (Eigen::Index i = 0; i < rows; ++i)
            for (Eigen::Index j = 0; j < columns; ++j) flat.push_back(v(i, j));
        return make_array(name, std::span<const double>(flat), static_cast<std::size_t>(rows * columns));
      }
    }
  }

  void validate() const;

  double time_;
  std::vector<double> points_;
  std::vector<std::int64_t> connectivity_, offsets_;
  std::vector<std::uint8_t> types_;
  std::vector<Array> point_data_, cell_data_;
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/output/vtu.ipp>
#endif
