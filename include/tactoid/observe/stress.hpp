#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <tactoid/kinematics/kinematics.hpp>
#include <tactoid/simulation/body.hpp>

namespace tactoid {

/// Effective (von Mises) stress, pressure and volume ratio of a body, at its points and averaged to its particles.
struct StressFields {
  std::vector<double> point_effective_stress;  ///< Pa, per quadrature point
  std::vector<double> effective_stress;        ///< Pa, per particle
  std::vector<double> pressure;                ///< −tr σ / 3, Pa, per particle
  std::vector<double> volume_ratio;            ///< J, per particle
};

/// Samples the Cauchy stress of a body at the present state. Particle values are the averages over the particle's
/// points, weighted by reference volume (and by the shape functions, where unknowns are coefficients).
template <class Body>
[[nodiscard]] StressFields stress_fields(Body& body) {
  const std::vector<PointSample> samples = body.sample_points();
  const PointTable& table = body.table();
  StressFields s;
  s.point_effective_stress.resize(table.points());
  s.effective_stress.assign(body.size(), 0.0);
  s.pressure.assign(body.size(), 0.0);
  s.volume_ratio.assign(body.size(), 0.0);
  std::vector<double> weight(body.size(), 0.0);
  for (std::size_t q = 0; q < table.points(); ++q) {
    const double effective = tactoid::effective_stress(samples[q].cauchy), pressure = -samples[q].cauchy.trace() / 3.0;
    s.point_effective_stress[q] = effective;
    auto add = [&](Index particle, double w) {
      s.effective_stress[particle] += w * effective;
      s.pressure[particle] += w * pressure;
      s.volume_ratio[particle] += w * samples[q].J;
      weight[particle] += w;
    };
    if (table.value_based()) {
      add(table.owner[q], body.point_volume(q));
    } else {
      for (std::size_t e = table.offsets[q]; e < table.offsets[q + 1]; ++e)
        add(table.entry(e).particle, table.volume[q] * std::max(0.0, table.point_values[e]));
    }
  }
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (weight[i] <= 0.0) continue;
    s.effective_stress[i] /= weight[i];
    s.pressure[i] /= weight[i];
    s.volume_ratio[i] /= weight[i];
  }
  return s;
}

/// Mean (weighted by the volumes of the table) and largest value over the points of a region.
struct RegionStatistics {
  double mean = 0.0;  ///< weighted by the volumes of the table
  double max = 0.0;   ///< 0 where no value is positive
};
/// Statistics of values at the quadrature points (stress_fields().point_effective_stress) over a region, its number
/// in Materials{…}; zero for a region without points.
[[nodiscard]] inline RegionStatistics region_statistics(const PointTable& table, const std::vector<double>& at_points,
                                                        Index region) {
  RegionStatistics r;
  double volume = 0.0;
  for (std::size_t q = 0; q < table.points(); ++q) {
    if (table.region[q] != region) continue;
    r.mean += table.volume[q] * at_points[q];
    r.max = std::max(r.max, at_points[q]);
    volume += table.volume[q];
  }
  if (volume > 0.0) r.mean /= volume;
  return r;
}

}  // namespace tactoid
