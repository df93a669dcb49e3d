#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/output/vtu.hpp>

namespace tactoid {

TACTOID_INLINE void VtuGrid::vertices(std::size_t count, Index first) {
  for (std::size_t i = 0; i < count; ++i) {
    connectivity_.push_back(static_cast<std::int64_t>(i) + first);
    offsets_.push_back(static_cast<std::int64_t>(connectivity_.size()));
    types_.push_back(detail::VtkCell<1>::type);
  }
}

TACTOID_INLINE void VtuGrid::write_pieces(const std::filesystem::path& path) const {
  const int rank = Ranks::current != nullptr ? Ranks::current->rank() : 0, size = Ranks::current != nullptr ? Ranks::current->size() : 1;
  const auto piece = [&](int r) { return fmt::format("{}_{}.vtu", path.stem().string(), r); };
  write(path.parent_path() / piece(rank), true);
  if (rank != 0) return;
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" header_type=\"UInt64\">\n"
      "<PUnstructuredGrid GhostLevel=\"0\">\n<PPoints>\n<PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n",
      std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian");
  const auto describe = [&](std::string_view place, const std::vector<Array>& arrays) {
    text += fmt::format("<{}>\n", place);
    for (const Array& array : arrays)
      text += fmt::format("<PDataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"/>\n", array.type, array.name, array.components);
    text += fmt::format("</{}>\n", place);
  };
  describe("PPointData", point_data_);
  describe("PCellData", cell_data_);
  for (int r = 0; r < size; ++r) text += fmt::format("<Piece Source=\"{}\"/>\n", piece(r));
  write_file(path, text + "</PUnstructuredGrid>\n</VTKFile>\n");
}

TACTOID_INLINE void VtuGrid::write(const std::filesystem::path& path, bool on_every_rank) const {
  validate();
  std::vector<Array> arrays;  // those of the grid itself
  arrays.push_back(make_array("Points", std::span<const double>(points_), 3));
  arrays.push_back(make_array("connectivity", std::span<const std::int64_t>(connectivity_), 1));
  arrays.push_back(make_array("offsets", std::span<const std::int64_t>(offsets_), 1));
  arrays.push_back(make_array("types", std::span<const std::uint8_t>(types_), 1));

  std::uint64_t offset = 0;
  std::vector<const Array*> appended;
  const auto describe = [&](const Array& array) {
    appended.push_back(&array);
    const std::string line = fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        array.type, array.name, array.components, offset);
    offset += sizeof(std::uint64_t) + array.bytes.size();
    return line;
  };
  std::string head = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" "
      "NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n</FieldData>\n<Piece NumberOfPoints=\"{}\" "
      "NumberOfCells=\"{}\">\n<Points>\n",
      std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian", time_, point_count(), cell_count());
  head += describe(arrays[0]) + "</Points>\n<Cells>\n";
  for (std::size_t i = 1; i < arrays.size(); ++i) head += describe(arrays[i]);
  head += "</Cells>\n<PointData>\n";
  for (const Array& array : point_data_) head += describe(array);
  head += "</PointData>\n<CellData>\n";
  for (const Array& array : cell_data_) head += describe(array);
  head += "</CellData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";

  AtomicFile file(path, on_every_rank);
  file.write(head);
  for (const Array* array : appended) {
    const std::uint64_t size = array->bytes.size();
    file.write(&size, sizeof size);
    file.write(array->bytes.data(), array->bytes.size());
  }
  file.write("\n</AppendedData>\n</VTKFile>\n");
  file.commit();
}

TACTOID_INLINE void VtuGrid::validate() const {
  const auto points = static_cast<std::int64_t>(point_count());
  for (const std::int64_t index : connectivity_) {
    if (index >= points)
      throw ParameterError(fmt::format("VtuGrid: a cell names point {}, but there are {} points.", index, points));
  }
  const auto check = [](const std::vector<Array>& arrays, std::size_t count, std::string_view place) {
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      const Array& array = arrays[i];
      if (array.name.empty() || array.name.find_first_of("<>&\"\n") != std::string::npos)
        throw ParameterError(
            fmt::format("VtuGrid: {} is not allowed as the name of an array.", in_quotes(array.name)));
      if (!array.whole || array.tuples != count) {
        throw ParameterError(
            fmt::format("VtuGrid: the array {} of {} component(s) has {} entries, but there are {} {}.", array.name,
                        array.components, array.tuples, count, place));
      }
      for (std::size_t j = 0; j < i; ++j)
        if (arrays[j].name == array.name)
          throw ParameterError(fmt::format("VtuGrid: two arrays of the {} have the name {}.", place, array.name));
    }
  };
  check(point_data_, point_count(), "points");
  check(cell_data_, cell_count(), "cells");
}

}  // namespace tactoid
