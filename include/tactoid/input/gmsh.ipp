#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/input/gmsh.hpp>

namespace tactoid::detail {

TACTOID_INLINE std::string MshScanner::next_section() {
  while (at_ < content_.size()) {
    const std::string_view line = rest_of_line();
    if (line.starts_with('$')) return std::string(line.substr(1));
  }
  return {};
}

TACTOID_INLINE void MshScanner::skip_section(const std::string& name) {
  const std::size_t end = content_.find("\n$End" + name, at_ > 0 ? at_ - 1 : 0);
  if (end == std::string::npos) refuse(fmt::format("${} has no $End{}.", name, name));
  at_ = end + 1;
  (void)rest_of_line();
}

TACTOID_INLINE std::string MshScanner::quoted() {
  skip_space();
  const std::size_t end = at_ < content_.size() && content_[at_] == '"' ? content_.find('"', at_ + 1) : std::string::npos;
  if (end == std::string::npos) refuse("a name in quotes is expected here.");
  std::string name = content_.substr(at_ + 1, end - at_ - 1);
  at_ = end + 1;
  return name;
}

TACTOID_INLINE std::string_view MshScanner::rest_of_line() {
  const std::size_t end = std::min(content_.find('\n', at_), content_.size());
  std::string_view line(content_.data() + at_, end - at_);
  at_ = std::min(end + 1, content_.size());
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  return line;
}

template <int D>
PointCloud<D> MshReader<D>::read(const MeshOptions& options) {
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

template <int D>
const typename MshReader<D>::Kind* MshReader<D>::kind_of(int type) {
  static const std::array<Kind, 5> kinds = {Kind{1, 1, {0, 1}}, Kind{2, 2, {0, 1, 2}}, Kind{3, 2, {0, 1, 3, 2}},
                                            Kind{4, 3, {0, 1, 2, 3}}, Kind{5, 3, {0, 1, 3, 2, 4, 5, 7, 6}}};
  for (const Kind& kind : kinds)
    if (kind.type == type) return &kind;
  return nullptr;
}

template <int D>
void MshReader<D>::format() {
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

template <int D>
void MshReader<D>::physical_names() {
  const int n = scan_.text_integer();
  for (int k = 0; k < n; ++k) {
    const int dimension = scan_.text_integer(), tag = scan_.text_integer();
    std::string name = scan_.quoted();
    if (dimension == D) names_[tag] = std::move(name);
  }
  (void)scan_.rest_of_line();
}

template <int D>
void MshReader<D>::entities() {
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

template <int D>
void MshReader<D>::nodes() {
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

template <int D>
void MshReader<D>::elements() {
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

template <int D>
std::size_t MshReader<D>::region(int entity) {
  std::string name = "body";
  if (const auto group = group_of_entity_.find(entity); group != group_of_entity_.end()) {
    const auto named = names_.find(group->second);
    name = named != names_.end() ? named->second : fmt::format("group {}", group->second);
  }
  return region_number(regions_, name);
}

}  // namespace tactoid::detail

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template class MshReader<1>;
template class MshReader<2>;
template class MshReader<3>;
}  // namespace tactoid::detail
#endif
