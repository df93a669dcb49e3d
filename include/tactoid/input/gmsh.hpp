#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/read_file.hpp>
#include <tactoid/core/text.hpp>
#include <tactoid/input/mesh.hpp>

namespace tactoid {

namespace detail {

/// Numbers of an MSH file, text or binary, with the place in the messages.
class MshScanner {
 public:
  explicit MshScanner(const std::filesystem::path& path) : path_(path), content_(read_file(path)) {}

  [[noreturn]] void refuse(std::string_view what) const {
    throw FileError(fmt::format("{}, {}: {}", in_quotes(path_.string()), place(), what));
  }
  [[nodiscard]] std::string name() const { return in_quotes(path_.string()); }
  void set_binary(bool binary) { binary_ = binary; }
  [[nodiscard]] bool binary() const { return binary_; }

  /// The next "$Name" line, empty at the end of the file. Other lines between sections are skipped.
  std::string next_section();
  /// Skips to the line after "$EndName".
  void skip_section(const std::string& name);
  void end_section(const std::string& name) {
    if (binary_ && at_ < content_.size() && content_[at_] == '\n') ++at_;
    skip_space();
    if (rest_of_line() != "$End" + name) refuse(fmt::format("$End{} is expected here.", name));
  }

  double real() { return binary_ ? raw<double>() : text<double>("a number"); }
  int integer() { return binary_ ? raw<std::int32_t>() : text<int>("a whole number"); }
  std::size_t count() { return binary_ ? static_cast<std::size_t>(raw<std::uint64_t>()) : text<std::size_t>("a count or tag"); }
  /// A count of things that take at least `bytes` bytes each: no file is shorter than what it announces.
  std::size_t size_of_list(std::size_t bytes) {
    const std::size_t n = count();
    if (n > (content_.size() - at_) / bytes + 1) refuse(fmt::format("{} entries are announced, more than the file can hold.", n));
    return n;
  }
  double text_real() { return text<double>("a number"); }
  int text_integer() { return text<int>("a whole number"); }
  std::string quoted();
  std::string_view rest_of_line();
  template <class T>
  T raw() {
    T value;
    if (content_.size() - at_ < sizeof(T)) refuse("the file ends in the middle of its data.");
    std::memcpy(&value, content_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }

 private:
  void skip_space() {
    while (at_ < content_.size() && (content_[at_] == ' ' || content_[at_] == '\n' || content_[at_] == '\r' || content_[at_] == '\t')) ++at_;
  }
  template <class T>
  T text(std::string_view what) {
    skip_space();
    T value{};
    const char* begin = content_.data() + at_;
    const char* end = content_.data() + content_.size();
    const auto read = std::from_chars(begin, end, value);
    const bool whole = read.ptr == end || *read.ptr == ' ' || *read.ptr == '\n' || *read.ptr == '\r' || *read.ptr == '\t';
    if (read.ec != std::errc{} || !whole) {
      std::string_view found(begin, std::min<std::size_t>(24, static_cast<std::size_t>(end - begin)));
      found = found.substr(0, found.find_first_of(" \n\r\t"));
      refuse(found.empty() ? fmt::format("the file ends where {} is expected.", what)
                           : fmt::format("{} is expected, not {}.", what, in_quotes(found)));
    }
    at_ += static_cast<std::size_t>(read.ptr - begin);
    return value;
  }
  [[nodiscard]] std::string place() const {
    if (binary_) return fmt::format("byte {}", at_);
    return fmt::format("line {}", 1 + std::count(content_.begin(), content_.begin() + static_cast<std::ptrdiff_t>(at_), '\n'));
  }
  std::filesystem::path path_;
  std::string content_;
  std::size_t at_ = 0;
  bool binary_ = false;
};

/// Reader of one MSH 4.1 file.
template <int D>
class MshReader {
 public:
  explicit MshReader(const std::filesystem::path& path) : scan_(path) {}

  PointCloud<D> read(const MeshOptions& options);

 private:
  /// Elements that are read: Gmsh's type, dimension, and their vertices in tensor order (or as a simplex).
  struct Kind {
    int type, dimension;
    std::vector<std::size_t> order;
  };
  [[nodiscard]] static const Kind* kind_of(int type);

  void format();

  void physical_names();  // text in binary files too

  void entities();

  void nodes();

  void elements();

  /// The region of an entity: the name of its first physical group; "body" without groups.
  std::size_t region(int entity);

  MshScanner scan_;
  std::map<int, std::string> names_;      // of the physical groups of dimension D
  std::map<int, int> group_of_entity_;    // of dimension D
  std::vector<std::size_t> tags_;         // of the nodes
  std::unordered_map<std::size_t, std::size_t> number_;
  std::vector<Point<D>> positions_;
  std::vector<MeshCell<D>> cells_;
  std::vector<std::string> regions_;
};

}  // namespace detail

/// Reads a mesh of Gmsh (MSH 4.1, text or binary) as a cloud with cells: lines (D = 1), quadrilaterals or triangles
/// (D = 2, in the plane z = 0), hexahedra or tetrahedra (D = 3), of the first order. Elements of lower dimension are left
/// out; the surface is that of the cells. A physical group of dimension D is a region; without groups there is one, "body".
///
///   PointCloud<3> cloud = read_gmsh<3>("cell.msh", {.scale = 1e-6});   // coordinates in µm
///
/// The background cells are tensor products, so a triangle becomes three quadrilaterals and a tetrahedron four hexahedra: the
/// spacing of the particles is about half an edge of the mesh, and a support of 1.3 times the longest edge is enough.
/// Throws FileError for a file that cannot be read or is damaged (with line or byte), GeometryError for a mesh that is no
/// body: inverted, flat, repeated or overlapping cells, coincident nodes, positions that are not finite, a surface that
/// touches itself in an edge or a point; ParameterError for the options.
template <int D>
[[nodiscard]] PointCloud<D> read_gmsh(const std::filesystem::path& path, const MeshOptions& options = {}) {
  return detail::MshReader<D>(path).read(options);
}

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/input/gmsh.ipp>
#endif
