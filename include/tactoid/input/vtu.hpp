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
  [[nodiscard]] std::string take(std::size_t count);
  /// No more bytes than that can follow.
  [[nodiscard]] std::size_t left() const { return ready_.size() + text_.size() - std::min(at_, text_.size()); }

 private:
  bool decode_group();
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

  PointCloud<D> read(const VtuOptions& options);

 private:
  /// Cells that are read or left out: VTK's type, dimension, and their vertices in tensor order (or as a simplex).
  struct Kind {
    int type, dimension;
    std::vector<std::size_t> order;  // empty: never read, left out where cells have more dimensions
  };
  [[nodiscard]] static const Kind* kind_of(std::int64_t type);

  const XmlElement& find_piece(const XmlElement& root);

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
  const XmlElement& one_array(const XmlElement& parent, std::string_view name) const;
  [[nodiscard]] std::size_t count(const XmlElement& e, std::string_view key) const;

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

  void read_points(const XmlElement& array, std::size_t points);

  void read_cells(const XmlElement& group, std::size_t cells);

  void read_regions(const XmlElement* data, const VtuOptions& options);

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

#if !defined(TACTOID_COMPILED)
#include <tactoid/input/vtu.ipp>
#endif
