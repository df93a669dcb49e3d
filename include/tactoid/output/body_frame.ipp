#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include <tactoid/output/body_frame.hpp>

namespace tactoid::detail {

template <int D>
VtuGrid body_grid(const PointTable& table, const Field& director, const ParticleFields& fields, const StressFields& stress, double time,
                  std::span<const double> gaps, const std::vector<Index>& particles, std::size_t vertices,
                  const std::vector<typename PointCloud<D>::Cell>& cells) {
  // A particle on an interface belongs to the first of its regions.
  std::vector<int> region(table.particles, 0);
  for (std::size_t q = table.points(); q-- > 0;) region[table.owner[q]] = static_cast<int>(table.region[q]);
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
  if (!director.empty()) grid.point_data("director", at(director));
  if (!gaps.empty()) {
    std::vector<double> shown = at(gaps);
    for (double& gap : shown)
      if (!std::isfinite(gap)) gap = std::numeric_limits<double>::quiet_NaN();
    grid.point_data("gap", shown);
  }
  return grid;
}

}  // namespace tactoid::detail

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template VtuGrid body_grid<1>(const PointTable&, const Field&, const ParticleFields&, const StressFields&, double, std::span<const double>,
                              const std::vector<Index>&, std::size_t, const std::vector<PointCloud<1>::Cell>&);
template VtuGrid body_grid<2>(const PointTable&, const Field&, const ParticleFields&, const StressFields&, double, std::span<const double>,
                              const std::vector<Index>&, std::size_t, const std::vector<PointCloud<2>::Cell>&);
template VtuGrid body_grid<3>(const PointTable&, const Field&, const ParticleFields&, const StressFields&, double, std::span<const double>,
                              const std::vector<Index>&, std::size_t, const std::vector<PointCloud<3>::Cell>&);
}  // namespace tactoid::detail
#endif
