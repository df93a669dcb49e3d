#pragma once

// Needs HDF5 (core/hdf5.hpp); neither <tactoid/tactoid.hpp> nor all.hpp includes this header:
//   find_package(HDF5 REQUIRED COMPONENTS C)
//   target_link_libraries(my_program PRIVATE tactoid::tactoid hdf5::hdf5)

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactoid/core/atomic_file.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/core/hdf5.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/core/read_file.hpp>
#include <tactoid/core/text.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/geometry/validate.hpp>
#include <tactoid/neighbors/part_of.hpp>

namespace tactoid {

namespace detail {

inline constexpr std::string_view cloud_mark = "Tactoid cloud, format 1";

/// Integers of the size of Index, and doubles.
template <class T>
[[nodiscard]] inline hid_t hdf5_type() {
  static_assert(sizeof(Index) == 4);
  if constexpr (std::is_same_v<T, Index>) return H5T_NATIVE_UINT32;
  else return H5T_NATIVE_DOUBLE;
}

/// A data set of `count` rows, each of `width` numbers, in pieces with checksums.
template <class T>
void write_table(hid_t file, const char* name, std::size_t count, std::size_t width, const T* numbers) {
  const SetRows all(0, count, width, true);
  const Hdf5 space(H5Screate_simple(2, all.extent.data(), nullptr), H5Sclose), creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (count > 0) {
    const std::array<hsize_t, 2> piece{std::min(count, rows_at_a_time), width};
    hdf5_succeeded(H5Pset_chunk(creation, 2, piece.data()));
    hdf5_succeeded(H5Pset_fletcher32(creation));
  }
  const Hdf5 set(H5Dcreate2(file, name, std::is_same_v<T, Index> ? H5T_STD_U32LE : H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
  if (count > 0) hdf5_succeeded(H5Dwrite(set, hdf5_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers));
}

}  // namespace detail

/// Writes a cloud as an HDF5 file that read_cloud and read_cloud_part read: `positions` (m), `spacing` (longest edges, m), `cells`, `cell_regions`, `facets`; and as attributes `regions` (one in
/// each line), `period` (m) and `axisymmetric`. The file appears whole or not at all. Of several processes the first one writes. Throws FileError; GeometryError as validate(); ParameterError
/// for a part of a cloud.
template <int D>
void write_cloud(const std::filesystem::path& path, const PointCloud<D>& cloud) {
  if (!is_first_rank()) return;
  if (cloud.part) throw ParameterError("write_cloud: the cloud is one process's part of another.");
  validate(cloud);
  AtomicFile out(path);
  try {
    const detail::QuietHdf5 quiet;
    const detail::Hdf5 file(H5Fcreate(out.temporary().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    std::string regions;
    for (const std::string& name : cloud.regions) regions += (regions.empty() ? "" : "\n") + name;
    std::string period;
    for (int k = 0; k < D; ++k) period += fmt::format("{}{:.17g}", k > 0 ? " " : "", cloud.period[k]);
    detail::write_attribute(file, "format", detail::cloud_mark);
    detail::write_attribute(file, "dimension", fmt::format("{}", D));
    detail::write_attribute(file, "regions", regions);
    detail::write_attribute(file, "period", period);
    detail::write_attribute(file, "axisymmetric", cloud.axisymmetric ? "yes" : "no");
    const std::vector<double> spacing = longest_edges(cloud);
    detail::write_table(file, "positions", cloud.size(), D, cloud.positions.front().data());
    detail::write_table(file, "spacing", cloud.size(), 1, spacing.data());
    detail::write_table(file, "cells", cloud.cells.size(), 1u << D, cloud.cells.front().data());
    detail::write_table(file, "cell_regions", cloud.cells.size(), 1, cloud.cell_regions.data());
    detail::write_table(file, "facets", cloud.facets.size(), 1u << (D - 1), cloud.facets.empty() ? nullptr : cloud.facets.front().data());
    detail::hdf5_succeeded(H5Fflush(file, H5F_SCOPE_GLOBAL));
  } catch (const FileError&) {
    throw FileError(fmt::format("Cannot write {}: HDF5 refused a part of it; is the disc full?", in_quotes(path.string())));
  }
  out.commit();
}

/// A file of write_cloud as a CloudSource: it is read anew in each pass, a piece at a time.
template <int D>
class CloudFile {
 public:
  /// Opens a file. Throws FileError, with the path and one reason, where it cannot be read, is no cloud, or one of another dimension.
  explicit CloudFile(const std::filesystem::path& path) : name_(in_quotes(path.string())) {
    if (std::FILE* const probe = std::fopen(path.c_str(), "rb"); probe != nullptr) std::fclose(probe);
    else detail::fail_file("read", path, errno);
    const detail::QuietHdf5 quiet;
    std::string format, dimension;
    try {
      file_.emplace(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
      format = detail::read_attribute(*file_, "format");
      dimension = detail::read_attribute(*file_, "dimension");
    } catch (const FileError&) {
    }
    if (format != detail::cloud_mark) throw FileError(fmt::format("{} is no cloud of Tactoid (write_cloud).", name_));
    if (dimension != fmt::format("{}", D)) throw FileError(fmt::format("{} is a cloud of {} dimensions, not of {}.", name_, dimension, D));
    reading([&] {
      std::string lines = detail::read_attribute(*file_, "regions");
      for (std::size_t end = 0; end != std::string::npos;) {
        end = lines.find('\n');
        regions_.push_back(lines.substr(0, end));
        if (end != std::string::npos) lines.erase(0, end + 1);
      }
      const std::string period = detail::read_attribute(*file_, "period");
      std::string_view numbers = period;
      for (int k = 0; k < D; ++k) {
        const std::size_t end = std::min(numbers.find(' '), numbers.size());
        const std::optional<double> length = number_in<double>(numbers.substr(0, end));
        if (!length) throw FileError("");
        period_[k] = *length;
        numbers.remove_prefix(std::min(end + 1, numbers.size()));
      }
      axisymmetric_ = detail::read_attribute(*file_, "axisymmetric") == "yes";
      size_ = rows_of("positions", D);
      cells_ = rows_of("cells", std::size_t{1} << D);
      facets_ = rows_of("facets", std::size_t{1} << (D - 1));
      if (rows_of("spacing", 1) != size_ || rows_of("cell_regions", 1) != cells_) throw FileError("");
    });
  }
  [[nodiscard]] std::size_t size() const { return size_; }                                  ///< number of particles
  [[nodiscard]] const std::vector<std::string>& regions() const { return regions_; }        ///< their names
  [[nodiscard]] Point<D> period() const { return period_; }                                 ///< m; 0 where not periodic
  [[nodiscard]] bool axisymmetric() const { return axisymmetric_; }                         ///< a meridian section
  /// f(number, position, longest edge) for all particles. Throws FileError where the file is damaged, as the next ones.
  template <class F>
  void for_each_particle(const F& f) {
    pieces<double, double>("positions", D, "spacing", size_, [&](std::size_t i, const double* X, const double* spacing) {
      f(i, Point<D>(Eigen::Map<const Point<D>>(X)), *spacing);
    });
  }
  /// f(particles, region) for all cells.
  template <class F>
  void for_each_cell(const F& f) {
    pieces<Index, Index>("cells", std::size_t{1} << D, "cell_regions", cells_, [&](std::size_t, const Index* vertices, const Index* region) {
      if (*region >= regions_.size()) refuse();
      f(particles<std::tuple_size_v<typename PointCloud<D>::Cell>>(vertices), *region);
    });
  }
  /// f(particles) for all facets.
  template <class F>
  void for_each_facet(const F& f) {
    pieces<Index, Index>("facets", std::size_t{1} << (D - 1), nullptr, facets_, [&](std::size_t, const Index* vertices, const Index*) {
      f(particles<std::tuple_size_v<typename PointCloud<D>::Facet>>(vertices));
    });
  }

 private:
  [[noreturn]] void refuse() const { throw FileError(fmt::format("{} is a damaged cloud.", name_)); }
  template <class Work>
  void reading(const Work& work) const {
    const detail::QuietHdf5 quiet;
    try {
      work();
    } catch (const FileError&) {
      refuse();
    }
  }
  [[nodiscard]] std::size_t rows_of(const char* name, std::size_t width) const {
    const detail::Hdf5 set(H5Dopen2(*file_, name, H5P_DEFAULT), H5Dclose), space(H5Dget_space(set), H5Sclose);
    std::array<hsize_t, 2> extent{};
    if (H5Sget_simple_extent_ndims(space) != 2 || H5Sget_simple_extent_dims(space, extent.data(), nullptr) < 0 || extent[1] != width) throw FileError("");
    return static_cast<std::size_t>(extent[0]);
  }
  template <std::size_t N>
  [[nodiscard]] std::array<Index, N> particles(const Index* vertices) const {
    std::array<Index, N> list;
    std::copy_n(vertices, N, list.begin());
    if (std::any_of(list.begin(), list.end(), [&](Index i) { return i >= size_; })) refuse();
    return list;
  }
  /// f(number, row of the first data set, row of the second one) for all rows.
  template <class A, class B, class F>
  void pieces(const char* first, std::size_t width, const char* second, std::size_t rows, const F& f) {
    std::vector<A> a;
    std::vector<B> b(second != nullptr ? 0 : 1);
    for (std::size_t at = 0; at < rows; at += detail::rows_at_a_time) {
      const std::size_t count = std::min(detail::rows_at_a_time, rows - at);
      a.resize(count * width);
      if (second != nullptr) b.resize(count);
      reading([&] {
        const detail::Hdf5 set(H5Dopen2(*file_, first, H5P_DEFAULT), H5Dclose);
        detail::SetRows(at, count, width, true).transfer(set, H5Dread, detail::hdf5_type<A>(), a.data());
        if (second == nullptr) return;
        const detail::Hdf5 other(H5Dopen2(*file_, second, H5P_DEFAULT), H5Dclose);
        detail::SetRows(at, count, 1, true).transfer(other, H5Dread, detail::hdf5_type<B>(), b.data());
      });
      for (std::size_t k = 0; k < count; ++k) f(at + k, a.data() + k * width, second != nullptr ? b.data() + k : b.data());
    }
  }

  std::string name_;
  std::optional<detail::Hdf5> file_;
  std::vector<std::string> regions_;
  Point<D> period_ = Point<D>::Zero();
  bool axisymmetric_ = false;
  std::size_t size_ = 0, cells_ = 0, facets_ = 0;
};

/// The cloud in a file of write_cloud. Throws FileError as CloudFile; GeometryError as validate().
template <int D>
[[nodiscard]] PointCloud<D> read_cloud(const std::filesystem::path& path) {
  CloudFile<D> file(path);
  PointCloud<D> cloud;
  cloud.regions = file.regions();
  cloud.period = file.period();
  cloud.axisymmetric = file.axisymmetric();
  file.for_each_particle([&](std::size_t, const Point<D>& X, double) { cloud.positions.push_back(X); });
  file.for_each_cell([&](const auto& cell, Index region) {
    cloud.cells.push_back(cell);
    cloud.cell_regions.push_back(region);
  });
  file.for_each_facet([&](const auto& facet) { cloud.facets.push_back(facet); });
  validate(cloud);
  return cloud;
}

/// One rank's part of the cloud in a file of write_cloud: as part_of(read_cloud<D>(path), part), but without the whole (part_of_source). Each rank reads positions four times and cells twice. Throws as part_of_source()
/// and read_cloud(); where that is on one rank alone, as when a disc fails there, the others do not know.
template <int D>
[[nodiscard]] PointCloud<D> read_cloud_part(const std::filesystem::path& path, const Part& part) {
  CloudFile<D> file(path);
  PointCloud<D> cloud = part_of_source<D>(file, part);
  validate(cloud);
  return cloud;
}

}  // namespace tactoid
