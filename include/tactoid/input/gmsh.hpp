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
  std::string next_section() {
    while (at_ < content_.size()) {
      const std::string_view line = rest_of_line();
      if (line.starts_with('$')) return std::string(line.substr(1));
    }
    return {};
  }
  /// Skips to the line after "$EndName".
  void skip_section(const std::string& name) {
    const std::size_t end = content_.find("\n$End" + name, at_ > 0 ? at_ - 1 : 0);
    if (end == std::string::npos) refuse(fmt::format("${} has no $End{}.", name, name));
    at_ = end + 1;
    (void)rest_of_line();
  }
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
  std::string quoted() {
    skip_space();
    const std::size_t end = at_ < content_.size() && content_[at_] == '"' ? content_.find('"', at_ + 1) : std::string::npos;
    if (end == std::string::npos) refuse("a name in quotes is expected here.");
    std::string name = content_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return name;
  }
  std::string_view rest_of_line() {
    const std::size_t end = std::min(content_.find('\n', at_), content_.size());
    std::string_view line(content_.data() + at_, end - at_);
    at_ = std::min(end + 1, content_.size());
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    return line;
  }
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

  PointCloud<D> read(const MeshOptions& options) {
    format();
    for (std::string section = scan_.next_section(); !section.empty(); section = scan_.next_section()) {
      if (section == "PhysicalNames") physical_names();
      else if (section == "Entities") entities();
      else if (section == "Nodes") nodes();
      else if (section == "Elements") elements();
      else {
        scan_.skip_section(section);
        continue;
      }
      scan_.end_section(section);
    }
    if (positions_.empty()) throw FileError(fmt::format("{} has no $Nodes.", scan_.name()));
    return cloud_of_mesh<D>(std::move(positions_), tags_, std::move(cells_), std::move(regions_), options, scan_.name());
  }

 private:
  /// Elements that are read: Gmsh's type, dimension, and their vertices in tensor order (or as a simplex).
  struct Kind {
    int type, dimension;
    std::vector<std::size_t> order;
  };
  [[nodiscard]] static const Kind* kind_of(int type) {
    static const std::array<Kind, 5> kinds = {Kind{1, 1, {0, 1}}, Kind{2, 2, {0, 1, 2}}, Kind{3, 2, {0, 1, 3, 2}},
                                              Kind{4, 3, {0, 1, 2, 3}}, Kind{5, 3, {0, 1, 3, 2, 4, 5, 7, 6}}};
    for (const Kind& kind : kinds)
      if (kind.type == type) return &kind;
    return nullptr;
  }

  void format() {
    if (scan_.next_section() != "MeshFormat")
      throw FileError(fmt::format("{} is no MSH file: it does not begin with $MeshFormat.", scan_.name()));
    const double version = scan_.text_real();
    const int binary = scan_.text_integer(), size = scan_.text_integer();
    if (version != 4.1)
      scan_.refuse(fmt::format("MSH version {:g} is not read: write version 4.1 (gmsh -format msh41).", version));
    if ((binary != 0 && binary != 1) || size != 8) scan_.refuse("the format line must be \"4.1 0 8\" or \"4.1 1 8\".");
    (void)scan_.rest_of_line();
    scan_.set_binary(binary == 1);
    if (binary == 1 && scan_.raw<std::int32_t>() != 1) scan_.refuse("it was written on a machine of the other byte order.");
    scan_.end_section("MeshFormat");
  }

  void physical_names() {  // text in binary files too
    const int n = scan_.text_integer();
    for (int k = 0; k < n; ++k) {
      const int dimension = scan_.text_integer(), tag = scan_.text_integer();
      std::string name = scan_.quoted();
      if (dimension == D) names_[tag] = std::move(name);
    }
    (void)scan_.rest_of_line();
  }

  void entities() {
    std::array<std::size_t, 4> n{};
    for (std::size_t& k : n) k = scan_.size_of_list(1);
    for (int dimension = 0; dimension < 4; ++dimension)
      for (std::size_t k = 0; k < n[static_cast<std::size_t>(dimension)]; ++k) {
        const int tag = scan_.integer();
        for (int c = 0; c < (dimension == 0 ? 3 : 6); ++c) (void)scan_.real();
        const std::size_t groups = scan_.size_of_list(1);
        for (std::size_t g = 0; g < groups; ++g) {
          const int group = scan_.integer();
          if (dimension == D && g == 0) group_of_entity_[tag] = group;
        }
        if (dimension == 0) continue;
        const std::size_t bounds = scan_.size_of_list(1);
        for (std::size_t b = 0; b < bounds; ++b) (void)scan_.integer();
      }
  }

  void nodes() {
    const std::size_t blocks = scan_.size_of_list(1), total = scan_.size_of_list(1);
    (void)scan_.count(), (void)scan_.count();
    for (std::size_t b = 0; b < blocks; ++b) {
      const int dimension = scan_.integer();
      (void)scan_.integer();
      const bool parametric = scan_.integer() != 0;
      const std::size_t n = scan_.size_of_list(8), first = tags_.size();
      for (std::size_t k = 0; k < n; ++k) tags_.push_back(scan_.count());
      for (std::size_t k = 0; k < n; ++k) {
        std::array<double, 3> x{};
        for (double& c : x) c = scan_.real();
        for (int c = 0; parametric && c < dimension; ++c) (void)scan_.real();
        for (int c = D; c < 3; ++c)
          if (std::abs(x[static_cast<std::size_t>(c)]) > 0.0)
            scan_.refuse(fmt::format("node {} does not lie in the {}: a cloud of {} dimensions has no such coordinate.",
                                     tags_[first + k], D == 2 ? "plane z = 0" : "line y = z = 0", D));
        if (!number_.try_emplace(tags_[first + k], positions_.size()).second)
          scan_.refuse(fmt::format("node {} is there twice.", tags_[first + k]));
        positions_.push_back(Eigen::Map<const Vector3>(x.data()).head<D>());
      }
    }
    if (positions_.size() != total) scan_.refuse(fmt::format("{} nodes are announced, {} are there.", total, positions_.size()));
  }

  void elements() {
    const std::size_t blocks = scan_.size_of_list(1), total = scan_.size_of_list(1);
    (void)scan_.count(), (void)scan_.count();
    std::size_t seen = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
      const int dimension = scan_.integer(), entity = scan_.integer(), type = scan_.integer();
      const std::size_t n = scan_.size_of_list(8);
      const Kind* kind = kind_of(type);
      if (type != 15 && (kind == nullptr || kind->dimension != dimension))
        scan_.refuse(fmt::format("elements of type {} and dimension {} are not read: lines, triangles, quadrilaterals, tetrahedra and "
                                 "hexahedra of the first order are (prisms, pyramids and higher orders are not).", type, dimension));
      const std::size_t vertices = type == 15 ? 1 : kind->order.size();
      std::vector<std::size_t> node(vertices);
      for (std::size_t k = 0; k < n; ++k, ++seen) {
        const std::size_t tag = scan_.count();
        for (std::size_t& v : node) v = scan_.count();
        if (dimension != D) continue;
        MeshCell<D> cell{.vertices = {}, .region = region(entity), .tag = tag};
        for (const std::size_t place : kind->order) {
          const auto found = number_.find(node[place]);
          if (found == number_.end()) scan_.refuse(fmt::format("element {} uses node {}, which is not there.", tag, node[place]));
          cell.vertices.push_back(found->second);
        }
        cells_.push_back(std::move(cell));
      }
    }
    if (seen != total) scan_.refuse(fmt::format("{} elements are announced, {} are there.", total, seen));
  }

  /// The region of an entity: the name of its first physical group; "body" without groups.
  std::size_t region(int entity) {
    std::string name = "body";
    if (const auto group = group_of_entity_.find(entity); group != group_of_entity_.end()) {
      const auto named = names_.find(group->second);
      name = named != names_.end() ? named->second : fmt::format("group {}", group->second);
    }
    return region_number(regions_, name);
  }

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
