#pragma once

#include <filesystem>
#include <numeric>
#include <span>
#include <vector>

#include <tactoid/core/ranks.hpp>
#include <tactoid/geometry/particle_fields.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/observe/stress.hpp>
#include <tactoid/output/vtu.hpp>
#include <tactoid/quadrature/point_table.hpp>

namespace tactoid {

namespace detail {

/// The fields of a body at some of its particles, and some of its cells.
template <int D>
[[nodiscard]] VtuGrid body_grid(const PointTable& table, const Field& director, const ParticleFields& fields, const StressFields& stress,
                                double time, std::span<const double> gaps, const std::vector<Index>& particles, std::size_t vertices,
                                const std::vector<typename PointCloud<D>::Cell>& cells);

}  // namespace detail

/// Writes one body at the present state as a VTU file: its background cells and its particles (as vertices), at their
/// current positions, with displacement (m), velocity (m/s), effective_stress, pressure (Pa), J, region, director, and
/// gap (m; signed, NaN for particles that are not on the surface) where `gaps` is given. Throws FileError; ParameterError for a body of which each process has a part.
template <class Body>
void write_body_frame(const std::filesystem::path& path, const Body& body, const ParticleFields& fields,
                      const StressFields& stress, double time, std::span<const double> gaps = {}) {
  if (body.in_parts()) throw ParameterError("write_body_frame: each process has a part of body " + in_quotes(body.name()) + "; write_body_pieces writes them.");
  std::vector<Index> all(body.size());
  std::iota(all.begin(), all.end(), Index{0});
  detail::body_grid<Body::dimension>(body.table(), body.director, fields, stress, time, gaps, all, all.size(), body.cloud().cells).write(path);
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
  VtuGrid grid = detail::body_grid<Body::dimension>(body.table(), body.director, fields, stress, time, gaps, particles, own, cells);
  std::vector<int> ranks;
  for (const Index i : particles) ranks.push_back(owners[i]);
  grid.point_data("rank", ranks);
  grid.write_pieces(path);
}

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/output/body_frame.ipp>
#endif
