#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <span>
#include <type_traits>
#include <vector>

#include <tactoid/core/ranks.hpp>
#include <tactoid/geometry/particle_fields.hpp>
#include <tactoid/observe/stress.hpp>
#include <tactoid/output/vtu.hpp>

namespace tactoid {

namespace detail {

/// The fields of a body at some of its particles, and some of its cells.
template <class Body, class Cells>
[[nodiscard]] VtuGrid body_grid(const Body& body, const ParticleFields& fields, const StressFields& stress, double time, std::span<const double> gaps,
                                const std::vector<Index>& particles, std::size_t vertices, const Cells& cells) {
  // A particle on an interface belongs to the first of its regions.
  std::vector<int> region(body.size(), 0);
  for (std::size_t q = body.table().points(); q-- > 0;)
    region[body.table().owner[q]] = static_cast<int>(body.table().region[q]);
  const auto at = [&](const auto& values) {
    std::vector<std::decay_t<decltype(values[0])>> list;
    list.reserve(particles.size());
    for (const Index i : particles) list.push_back(values[i]);
    return list;
  };
  Field displacement;
  displacement.reserve(particles.size());
  for (const Index i : particles) displacement.push_back(fields.position[i] - fields.reference[i]);

  VtuGrid grid(time);
  grid.points(at(fields.position));
  grid.cells(cells);
  grid.vertices(vertices);
  grid.point_data("displacement", displacement);
  grid.point_data("velocity", at(fields.velocity));
  grid.point_data("effective_stress", at(stress.effective_stress));
  grid.point_data("pressure", at(stress.pressure));
  grid.point_data("J", at(stress.volume_ratio));
  grid.point_data("region", at(region));
  if (!body.director.empty()) grid.point_data("director", at(body.director));
  if (!gaps.empty()) {
    std::vector<double> shown = at(gaps);
    for (double& gap : shown)
      if (!std::isfinite(gap)) gap = std::numeric_limits<double>::quiet_NaN();
    grid.point_data("gap", shown);
  }
  return grid;
}

}  // namespace detail

/// Writes one body at the present state as a VTU file: its background cells and its particles (as vertices), at their
/// current positions, with displacement (m), velocity (m/s), effective_stress, pressure (Pa), J, region, director, and
/// gap (m; signed, NaN for particles that are not on the surface) where `gaps` is given. Throws FileError.
template <class Body>
void write_body_frame(const std::filesystem::path& path, const Body& body, const ParticleFields& fields,
                      const StressFields& stress, double time, std::span<const double> gaps = {}) {
  std::vector<Index> all(body.size());
  std::iota(all.begin(), all.end(), Index{0});
  detail::body_grid(body, fields, stress, time, gaps, all, all.size(), body.cloud().cells).write(path);
}

/// The same in pieces (VtuGrid::write_pieces): each of several processes writes the particles that it owns, and the cells whose first
/// particle it owns; `rank` is among the fields. `owners`: Decomposition::owners of the body. Collective, as what it is given. Throws FileError.
template <class Body>
void write_body_pieces(const std::filesystem::path& path, const Body& body, const ParticleFields& fields, const StressFields& stress, double time,
                       std::span<const int> owners, std::span<const double> gaps = {}) {
  const int rank = Ranks::current != nullptr ? Ranks::current->rank() : 0;
  std::vector<Index> particles, number(body.size(), 0);
  std::vector<char> taken(body.size(), 0);
  const auto take = [&](Index i) {
    if (taken[i]) return;
    taken[i] = 1;
    number[i] = static_cast<Index>(particles.size());
    particles.push_back(i);
  };
  for (Index i = 0; i < body.size(); ++i)
    if (owners[i] == rank) take(i);
  const std::size_t own = particles.size();
  auto cells = body.cloud().cells;
  std::erase_if(cells, [&](const auto& cell) { return owners[cell[0]] != rank; });
  for (auto& cell : cells)
    for (Index& i : cell) {
      take(i);
      i = number[i];
    }
  VtuGrid grid = detail::body_grid(body, fields, stress, time, gaps, particles, own, cells);
  std::vector<int> ranks;
  for (const Index i : particles) ranks.push_back(owners[i]);
  grid.point_data("rank", ranks);
  grid.write_pieces(path);
}

}  // namespace tactoid
