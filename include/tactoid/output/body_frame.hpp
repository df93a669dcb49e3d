#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <span>
#include <vector>

#include <tactoid/geometry/particle_fields.hpp>
#include <tactoid/observe/stress.hpp>
#include <tactoid/output/vtu.hpp>

namespace tactoid {

/// Writes one body at the present state as a VTU file: its background cells and its particles (as vertices), at their
/// current positions, with displacement (m), velocity (m/s), effective_stress, pressure (Pa), J, region, director, and
/// gap (m; signed, NaN for particles that are not on the surface) where `gaps` is given. Throws FileError.
template <class Body>
void write_body_frame(const std::filesystem::path& path, const Body& body, const ParticleFields& fields,
                      const StressFields& stress, double time, std::span<const double> gaps = {}) {
  Field displacement(body.size());
  for (std::size_t i = 0; i < displacement.size(); ++i) displacement[i] = fields.position[i] - fields.reference[i];
  // A particle on an interface belongs to the first of its regions.
  std::vector<int> region(body.size(), 0);
  for (std::size_t q = body.table().points(); q-- > 0;)
    region[body.table().owner[q]] = static_cast<int>(body.table().region[q]);

  VtuGrid grid(time);
  grid.points(fields.position);
  grid.cells(body.cloud().cells);
  grid.vertices(body.size());
  grid.point_data("displacement", displacement);
  grid.point_data("velocity", fields.velocity);
  grid.point_data("effective_stress", stress.effective_stress);
  grid.point_data("pressure", stress.pressure);
  grid.point_data("J", stress.volume_ratio);
  grid.point_data("region", region);
  if (!body.director.empty()) grid.point_data("director", body.director);
  if (!gaps.empty()) {
    std::vector<double> shown(gaps.begin(), gaps.end());
    for (double& gap : shown)
      if (!std::isfinite(gap)) gap = std::numeric_limits<double>::quiet_NaN();
    grid.point_data("gap", shown);
  }
  grid.write(path);
}

}  // namespace tactoid
