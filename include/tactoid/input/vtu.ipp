#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/input/vtu.hpp>

namespace tactoid::detail {

TACTOID_INLINE std::string VtuBytes::take(std::size_t count) {
  if (!base64_) {
    std::string bytes(text_.substr(std::min(at_, text_.size()), count));
    at_ += bytes.size();
    return bytes;
  }
  while (ready_.size() < count && decode_group()) {
  }
  std::string bytes = ready_.substr(0, count);
  ready_.erase(0, bytes.size());
  return bytes;
}

TACTOID_INLINE bool VtuBytes::decode_group() {
  std::uint32_t bits = 0;
  int digits = 0, padding = 0;
  while (digits + padding < 4) {
    if (at_ >= text_.size()) return false;
    const char c = text_[at_++];
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    if (c == '=') {
      ++padding;
      continue;
    }
    const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (digit < 0 || padding > 0) return false;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    ++digits;
  }
  if (digits < 2) return false;
  bits <<= 6 * padding;
  for (int k = 0; k + 1 < digits; ++k) ready_ += static_cast<char>(bits >> (16 - 8 * k) & 0xFF);
  return true;
}

template <int D>
PointCloud<D> VtuReader<D>::read(const VtuOptions& options) {
  const MeshOptions mesh{.scale = options.scale, .coincidence = options.coincidence};
  mesh.validate();
  decompress_ = options.decompress;
  const XmlElement root = xml_.root();
  const XmlElement& piece = find_piece(root);
  const std::size_t points = count(piece, "NumberOfPoints"), cells = count(piece, "NumberOfCells");
  read_points(one_array(needed(piece, "Points"), ""), points);
  read_cells(needed(piece, "Cells"), cells);
  read_regions(piece.child("CellData"), options);
  std::vector<std::size_t> tags(positions_.size());
  std::iota(tags.begin(), tags.end(), std::size_t{0});
  return cloud_of_mesh<D>(std::move(positions_), tags, std::move(cells_), std::move(regions_), mesh, name_);
}

template <int D>
const typename VtuReader<D>::Kind* VtuReader<D>::kind_of(std::int64_t type) {
  static const std::array<Kind, 12> kinds = {Kind{1, 0, {}},
                                             Kind{2, 0, {}},
                                             Kind{3, 1, {0, 1}},
                                             Kind{4, 1, {}},
                                             Kind{5, 2, {0, 1, 2}},
                                             Kind{6, 2, {}},
                                             Kind{7, 2, {}},
                                             Kind{8, 2, {0, 1, 2, 3}},
                                             Kind{9, 2, {0, 1, 3, 2}},
                                             Kind{10, 3, {0, 1, 2, 3}},
                                             Kind{11, 3, {0, 1, 2, 3, 4, 5, 6, 7}},
                                             Kind{12, 3, {0, 1, 3, 2, 4, 5, 7, 6}}};
  for (const Kind& kind : kinds)
    if (kind.type == type) return &kind;
  return nullptr;
}

template <int D>
const XmlElement& VtuReader<D>::find_piece(const XmlElement& root) {
  if (root.name != "VTKFile")
    throw FileError(fmt::format("{} is no VTU file: its first element is <{}>, not <VTKFile>.", name_, root.name));
  const std::string type = value(root, "type", "");
  if (type != "UnstructuredGrid")
    xml_.refuse(root.line,
                fmt::format("files of type {} are not read: it must be \"UnstructuredGrid\".", in_quotes(type)));
  const std::string order = value(root, "byte_order", "LittleEndian"), header = value(root, "header_type", "UInt32");
  if (order != "LittleEndian" && order != "BigEndian")
    xml_.refuse(root.line, fmt::format("byte_order = {} is not allowed: it must be LittleEndian or BigEndian.",
                                       in_quotes(order)));
  if (header != "UInt32" && header != "UInt64")
    xml_.refuse(root.line,
                fmt::format("header_type = {} is not allowed: it must be UInt32 or UInt64.", in_quotes(header)));
  swap_ = (order == "LittleEndian") != (std::endian::native == std::endian::little);
  header_size_ = header == "UInt64" ? 8 : 4;
  if (const std::string* compressor = root.attribute("compressor")) {
    compressed_ = true;
    if (*compressor != "vtkZLibDataCompressor")
      xml_.refuse(
          root.line,
          fmt::format("data compressed by {} are not read: write the file without compression, or with zlib's.",
                      in_quotes(*compressor)));
  }
  const XmlElement& grid = needed(root, "UnstructuredGrid");
  if (const XmlElement* data = root.child("AppendedData")) {
    const std::string encoding = value(*data, "encoding", "");
    if (encoding != "raw" && encoding != "base64")
      xml_.refuse(data->line,
                  fmt::format("encoding = {} of the appended data is not allowed: it must be raw or base64.",
                              in_quotes(encoding)));
    appended_base64_ = encoding == "base64";
    const std::size_t mark = data->text.find_first_not_of(" \t\r\n");
    if (mark == std::string_view::npos || data->text[mark] != '_')
      xml_.refuse(data->line, "appended data must begin with \"_\".");
    appended_ = data->text.substr(mark + 1);
    has_appended_ = true;
  }
  const auto pieces = std::count_if(grid.children.begin(), grid.children.end(),
                                    [](const XmlElement& e) { return e.name == "Piece"; });
  if (pieces != 1)
    xml_.refuse(grid.line, fmt::format("there are {} pieces: a file with one <Piece> is read.", pieces));
  return *grid.child("Piece");
}

template <int D>
const XmlElement& VtuReader<D>::one_array(const XmlElement& parent, std::string_view name) const {
  const XmlElement* found = nullptr;
  for (const XmlElement& e : parent.children) {
    if (e.name != "DataArray" || (!name.empty() && value(e, "Name", "") != name)) continue;
    if (found != nullptr)
      xml_.refuse(e.line, fmt::format("<{}> has two arrays{}{}.", parent.name, name.empty() ? "" : " ", name));
    found = &e;
  }
  if (found == nullptr)
    xml_.refuse(parent.line, fmt::format("<{}> has no array{}{}.", parent.name, name.empty() ? "" : " ", name));
  return *found;
}

template <int D>
std::size_t VtuReader<D>::count(const XmlElement& e, std::string_view key) const {
  const std::string* text = e.attribute(key);
  const std::optional<std::size_t> n = text ? number_in<std::size_t>(*text) : std::nullopt;
  if (!n)
    xml_.refuse(e.line, fmt::format("{} of <{}> must be a whole number{}{}.", key, e.name, text ? ", not " : "",
                                    text ? in_quotes(*text) : ""));
  return *n;
}

template <int D>
void VtuReader<D>::read_points(const XmlElement& array, std::size_t points) {
  if (value(array, "NumberOfComponents", "1") != "3")
    xml_.refuse(array.line, "points must have NumberOfComponents=\"3\".");
  if (points > content_.size() * 1100)
    xml_.refuse(array.line, fmt::format("{} points are announced, more than the file can hold.", points));
  const std::vector<double> x = numbers<double>(array, 3 * points);
  for (std::size_t i = 0; i < points; ++i) {
    const Vector3 X(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
    for (int k = D; k < 3; ++k)
      if (std::abs(X[k]) > 0.0)
        throw GeometryError(
            fmt::format("{}: node {} does not lie in the {}: a cloud of {} dimensions has no such coordinate.", name_,
                        i, D == 2 ? "plane z = 0" : "line y = z = 0", D));
    positions_.push_back(X.head<D>());
  }
}

template <int D>
void VtuReader<D>::read_cells(const XmlElement& group, std::size_t cells) {
  const std::vector<std::int64_t> types = numbers<std::int64_t>(one_array(group, "types"), cells);
  const std::vector<std::int64_t> offsets = numbers<std::int64_t>(one_array(group, "offsets"), cells);
  const std::vector<std::int64_t> connectivity =
      numbers<std::int64_t>(one_array(group, "connectivity"), std::nullopt);
  const auto refuse = [&](std::string_view what) { xml_.refuse(group.line, what); };
  std::int64_t begin = 0;
  for (std::size_t c = 0; c < cells; ++c) {
    const std::int64_t end = offsets[c];
    if (end < begin || end > static_cast<std::int64_t>(connectivity.size()))
      refuse(fmt::format("the offset {} of cell {} is not allowed: it must lie between {} and {}.", end, c, begin,
                         connectivity.size()));
    const Kind* kind = kind_of(types[c]);
    if (kind == nullptr || kind->dimension > D || (kind->dimension == D && kind->order.empty()))
      refuse(
          fmt::format("cell {} of VTK's type {} is not read: lines (3), triangles (5), pixels (8), quadrilaterals "
                      "(9), tetrahedra (10), voxels (11) and "
                      "hexahedra (12) are, up to {} dimension{} here.",
                      c, types[c], D, D == 1 ? "" : "s"));
    if (kind->dimension == D) {
      if (end - begin != static_cast<std::int64_t>(kind->order.size()))
        refuse(fmt::format("cell {} of VTK's type {} has {} nodes, not {}.", c, types[c], end - begin,
                           kind->order.size()));
      MeshCell<D> cell{.vertices = {}, .region = 0, .tag = c};
      for (const std::size_t place : kind->order) {
        const std::int64_t node = connectivity[static_cast<std::size_t>(begin) + place];
        if (node < 0 || node >= static_cast<std::int64_t>(positions_.size()))
          refuse(fmt::format("cell {} uses node {}, but there are {} nodes, counted from 0.", c, node,
                             positions_.size()));
        cell.vertices.push_back(static_cast<std::size_t>(node));
      }
      cells_.push_back(std::move(cell));
    }
    begin = end;
  }
  if (begin != static_cast<std::int64_t>(connectivity.size()))
    refuse(fmt::format("the cells use {} entries of the connectivity, {} are there.", begin, connectivity.size()));
  cell_count_ = cells;
}

template <int D>
void VtuReader<D>::read_regions(const XmlElement* data, const VtuOptions& options) {
  const XmlElement* array = nullptr;
  std::string there;
  std::vector<std::string> candidates = {options.region};
  if (options.region.empty()) candidates = {"region", "gmsh:physical"};
  if (data != nullptr) {
    for (const XmlElement& e : data->children)
      there += fmt::format("{}{}", there.empty() ? "" : ", ", in_quotes(value(e, "Name", "")));
    for (const std::string& name : candidates)
      for (const XmlElement& e : data->children)
        if (array == nullptr && e.name == "DataArray" && value(e, "Name", "") == name) array = &e;
  }
  if (array == nullptr) {
    if (!options.region.empty())
      throw FileError(fmt::format("{} has no cell array {}; its cell arrays: {}.", name_, in_quotes(options.region),
                                  there.empty() ? "none" : there));
    regions_ = {"body"};
    return;
  }
  const std::string label = in_quotes(value(*array, "Name", ""));
  if (value(*array, "NumberOfComponents", "1") != "1")
    xml_.refuse(array->line, fmt::format("array {}: regions must have one component.", label));
  const std::vector<double> ids = numbers<double>(*array, cell_count_);
  for (MeshCell<D>& cell : cells_) {
    const double id = ids[cell.tag];
    if (!(std::abs(id) < 1e15) || id != std::floor(id))
      xml_.refuse(array->line,
                  fmt::format("array {}: {:g}, the region of cell {}, is no whole number.", label, id, cell.tag));
    const auto number = static_cast<long long>(id);
    const auto named = options.region_names.find(number);
    cell.region = region_number(
        regions_, named != options.region_names.end() ? named->second : fmt::format("region {}", number));
  }
}

}  // namespace tactoid::detail

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template class VtuReader<1>;
template class VtuReader<2>;
template class VtuReader<3>;
}  // namespace tactoid::detail
#endif
