#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/read_file.hpp>
#include <tactoid/core/text.hpp>
#include <tactoid/input/mesh.hpp>
#include <tactoid/input/xml.hpp>

namespace tactoid {

/// How a VTU file becomes a cloud.
struct VtuOptions {
  double scale = 1.0;         ///< m per unit of length of the file; > 0
  double coincidence = 1e-6;  ///< see MeshOptions
  /// Name of the cell array with the regions, whole numbers. Empty: "region", or else "gmsh:physical", where the file
  /// has one.
  std::string region{};
  std::map<long long, std::string> region_names{};  ///< of the numbers; without a name n is "region n"
  /// Inverse of zlib's compress: bytes, and how many they become. input/vtu_zlib.hpp has one, which needs zlib.
  std::string (*decompress)(std::string_view bytes, std::size_t size) = nullptr;
};

namespace detail {

/// Bytes as a VTU file holds them: raw, or in base64, each piece (header, data) with a padding of its own or not.
class VtuBytes {
 public:
  VtuBytes(std::string_view text, bool base64) : text_(text), base64_(base64) {}

  /// The next `count` bytes, fewer at the end or before something that is no base64.
  [[nodiscard]] std::string take(std::size_t count) {
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
  /// No more bytes than that can follow.
  [[nodiscard]] std::size_t left() const { return ready_.size() + text_.size() - std::min(at_, text_.size()); }

 private:
  bool decode_group() {
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
  std::string_view text_;
  bool base64_;
  std::size_t at_ = 0;
  std::string ready_;
};

/// Reader of one VTU file.
template <int D>
class VtuReader {
 public:
  explicit VtuReader(const std::filesystem::path& path)
      : name_(in_quotes(path.string())), content_(read_file(path)), xml_(name_, content_) {}

  PointCloud<D> read(const VtuOptions& options) {
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

 private:
  /// Cells that are read or left out: VTK's type, dimension, and their vertices in tensor order (or as a simplex).
  struct Kind {
    int type, dimension;
    std::vector<std::size_t> order;  // empty: never read, left out where cells have more dimensions
  };
  [[nodiscard]] static const Kind* kind_of(std::int64_t type) {
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

  const XmlElement& find_piece(const XmlElement& root) {
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

  [[nodiscard]] static std::string value(const XmlElement& e, std::string_view key, std::string otherwise) {
    const std::string* found = e.attribute(key);
    return found ? *found : otherwise;
  }
  const XmlElement& needed(const XmlElement& parent, std::string_view name) const {
    const XmlElement* found = parent.child(name);
    if (found == nullptr) xml_.refuse(parent.line, fmt::format("<{}> has no <{}>.", parent.name, name));
    return *found;
  }
  /// The array of that name; without a name, the only one.
  const XmlElement& one_array(const XmlElement& parent, std::string_view name) const {
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
  [[nodiscard]] std::size_t count(const XmlElement& e, std::string_view key) const {
    const std::string* text = e.attribute(key);
    const std::optional<std::size_t> n = text ? number_in<std::size_t>(*text) : std::nullopt;
    if (!n)
      xml_.refuse(e.line, fmt::format("{} of <{}> must be a whole number{}{}.", key, e.name, text ? ", not " : "",
                                      text ? in_quotes(*text) : ""));
    return *n;
  }

  /// The numbers of an array, `expected` of them where that is known.
  template <class T>
  [[nodiscard]] std::vector<T> numbers(const XmlElement& array, std::optional<std::size_t> expected) {
    const std::string label = in_quotes(value(array, "Name", "Points")), type = value(array, "type", ""),
                      format = value(array, "format", "ascii");
    const auto refuse = [&](std::string_view what) {
      xml_.refuse(array.line, fmt::format("array {}: {}", label, what));
    };
    const bool whole = type.starts_with("Int") || type.starts_with("UInt");
    const std::optional<std::size_t> bits =
        whole || type.starts_with("Float") ? number_in<std::size_t>(std::string_view(type).substr(type.find('t') + 1))
                                           : std::nullopt;
    if (!bits || (*bits != 64 && *bits != 32 && (!whole || (*bits != 16 && *bits != 8))))
      refuse(fmt::format("the type {} is not read: it must be Float32, Float64, Int8 to Int64 or UInt8 to UInt64.",
                         in_quotes(type)));
    if (std::integral<T> && !whole)
      refuse(fmt::format("the type {} is not allowed: it must be one of whole numbers.", in_quotes(type)));
    std::vector<T> result;
    if (format == "ascii") {
      for (std::string_view rest = array.text; !rest.empty();) {
        const std::size_t end = std::min(rest.find_first_of(" \t\r\n"), rest.size());
        const std::optional<T> number = number_in<T>(rest.substr(0, end));
        if (!number)
          refuse(fmt::format("{} is expected, not {}.", std::integral<T> ? "a whole number" : "a number",
                             in_quotes(rest.substr(0, std::min<std::size_t>(end, 24)))));
        result.push_back(*number);
        rest = trimmed(rest.substr(end));
      }
    } else if (format == "binary" || format == "appended") {
      const std::string bytes = format == "binary" ? content_of(VtuBytes(array.text, true), refuse)
                                                   : content_of(appended(array, refuse), refuse);
      const std::size_t size = *bits / 8;
      if (bytes.size() % size != 0)
        refuse(fmt::format("{} bytes are no whole number of values of type {}.", bytes.size(), type));
      result.reserve(bytes.size() / size);
      for (std::size_t k = 0; k < bytes.size(); k += size) result.push_back(decode<T>(bytes.data() + k, type));
    } else {
      refuse(fmt::format("format = {} is not allowed: it must be ascii, binary or appended.", in_quotes(format)));
    }
    if (expected && result.size() != *expected)
      refuse(fmt::format("{} numbers are expected, {} are there.", *expected, result.size()));
    return result;
  }

  template <class Refuse>
  [[nodiscard]] VtuBytes appended(const XmlElement& array, const Refuse& refuse) const {
    if (!has_appended_) refuse("its data are appended, but the file has no <AppendedData>.");
    const std::size_t offset = count(array, "offset");
    if (offset >= appended_.size())
      refuse(fmt::format("offset = {} is beyond the {} bytes of appended data.", offset, appended_.size()));
    return {appended_.substr(offset), appended_base64_};
  }

  /// The bytes of an array, behind a header that tells their number; compressed, those of its blocks.
  template <class Refuse>
  [[nodiscard]] std::string content_of(VtuBytes stream, const Refuse& refuse) const {
    const auto take = [&](std::size_t n) {
      std::string bytes = n <= stream.left() ? stream.take(n) : std::string();
      if (bytes.size() < n) refuse("its data end early, or are no base64 where they should be.");
      return bytes;
    };
    const auto integer = [&] {
      const std::string bytes = take(header_size_);
      return header_size_ == 8 ? decode<std::uint64_t>(bytes.data(), "UInt64")
                               : decode<std::uint64_t>(bytes.data(), "UInt32");
    };
    const std::uint64_t first = integer();
    if (!compressed_) return take(static_cast<std::size_t>(first));
    if (decompress_ == nullptr)
      refuse(
          "it is compressed: write the file without compression, or give VtuOptions.decompress = zlib_decompress "
          "(input/vtu_zlib.hpp).");
    const std::uint64_t block = integer(), last = integer();
    if (first > stream.left() || block > (std::uint64_t{1} << 32) || last > block)
      refuse("the header of its compressed data is damaged.");
    std::vector<std::uint64_t> sizes(static_cast<std::size_t>(first));
    for (std::uint64_t& size : sizes) size = integer();
    std::string bytes;
    for (std::size_t b = 0; b < sizes.size(); ++b) {
      const std::size_t size = static_cast<std::size_t>(b + 1 == sizes.size() && last > 0 ? last : block);
      if (size / 1100 > sizes[b])
        refuse("the header of its compressed data is damaged.");  // no zlib shrinks more than that
      const std::string part = decompress_(take(static_cast<std::size_t>(sizes[b])), size);
      if (part.size() != size) refuse("its compressed data are damaged.");
      bytes += part;
    }
    return bytes;
  }

  template <class T>
  [[nodiscard]] T decode(const char* bytes, std::string_view type) const {
    const auto as = [&]<class Stored>(Stored) {
      std::array<char, sizeof(Stored)> copy;
      std::copy_n(bytes, copy.size(), copy.begin());
      if (swap_) std::reverse(copy.begin(), copy.end());
      return static_cast<T>(std::bit_cast<Stored>(copy));
    };
    if (type == "Float64") return as(double{});
    if (type == "Float32") return as(float{});
    if (type == "Int64") return as(std::int64_t{});
    if (type == "UInt64") return as(std::uint64_t{});
    if (type == "Int32") return as(std::int32_t{});
    if (type == "UInt32") return as(std::uint32_t{});
    if (type == "Int16") return as(std::int16_t{});
    if (type == "UInt16") return as(std::uint16_t{});
    if (type == "Int8") return as(std::int8_t{});
    return as(std::uint8_t{});
  }

  void read_points(const XmlElement& array, std::size_t points) {
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

  void read_cells(const XmlElement& group, std::size_t cells) {
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

  void read_regions(const XmlElement* data, const VtuOptions& options) {
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

  std::string name_, content_;
  XmlScanner xml_;
  std::string (*decompress_)(std::string_view, std::size_t) = nullptr;
  bool swap_ = false, compressed_ = false, has_appended_ = false, appended_base64_ = false;
  std::size_t header_size_ = 4, cell_count_ = 0;
  std::string_view appended_;
  std::vector<Point<D>> positions_;
  std::vector<MeshCell<D>> cells_;
  std::vector<std::string> regions_;
};

}  // namespace detail

/// Reads an unstructured grid of VTK (.vtu, as ParaView, meshio, VTK and write_body_frame write it) as a cloud with
/// cells: lines (D = 1), quadrilaterals, pixels or triangles (D = 2, in the plane z = 0), hexahedra, voxels or
/// tetrahedra (D = 3). Cells of lower dimension are left out; the surface is that of the cells. Data in text, in
/// base64, or appended, raw or in base64, of either byte order. A cell array of whole numbers gives the regions, see
/// VtuOptions; without one there is one, "body".
///
///   PointCloud<3> cloud = read_vtu<3>("cell.vtu", {.scale = 1e-6, .region_names = {{1, "nucleus"}, {2,
///   "cytoplasm"}}});
///
/// Simplices become quadrilaterals and hexahedra as those of read_gmsh do. Nodes and cells are counted from 0 in
/// messages. Throws FileError for a file that cannot be read, is damaged (with the line), or is compressed and no
/// decompress is given; GeometryError for a mesh that is no body, as read_gmsh; ParameterError for the options.
template <int D>
[[nodiscard]] PointCloud<D> read_vtu(const std::filesystem::path& path, const VtuOptions& options = {}) {
  return detail::VtuReader<D>(path).read(options);
}

}  // namespace tactoid
