#pragma once

#include <algorithm>
#include <array>

#include <tactoid/core/compiled.hpp>
#include <tactoid/kinematics/kinematics.hpp>
#include <tactoid/observe/stress.hpp>

namespace tactoid {

TACTOID_INLINE StressFields detail::stress_fields(const PointTable& table, const std::vector<PointSample>& samples,
                                                  const std::vector<double>& volumes) {
  const std::size_t n = table.particles;
  StressFields s;
  s.point_effective_stress.resize(table.points());
  s.effective_stress.assign(n, 0.0);
  s.pressure.assign(n, 0.0);
  s.volume_ratio.assign(n, 0.0);
  std::vector<double> weight(n, 0.0);
  for (std::size_t q = 0; q < table.points(); ++q) {
    const double effective = effective_stress(samples[q].cauchy), pressure = -samples[q].cauchy.trace() / 3.0;
    s.point_effective_stress[q] = effective;
    auto add = [&](Index particle, double w) {
      s.effective_stress[particle] += w * effective;
      s.pressure[particle] += w * pressure;
      s.volume_ratio[particle] += w * samples[q].J;
      weight[particle] += w;
    };
    if (table.value_based()) {
      add(table.owner[q], volumes[q]);
    } else {
      for (std::size_t e = table.offsets[q]; e < table.offsets[q + 1]; ++e)
        add(table.entry(e).particle, table.volume[q] * std::max(0.0, table.point_values[e]));
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (weight[i] <= 0.0) continue;
    s.effective_stress[i] /= weight[i];
    s.pressure[i] /= weight[i];
    s.volume_ratio[i] /= weight[i];
  }
  return s;
}

TACTOID_INLINE RegionStatistics detail::region_statistics(const PointTable& table, const std::vector<double>& at_points, Index region, RowShare* share) {
  RegionStatistics r;
  double volume = 0.0;
  for (std::size_t q = 0; q < table.points(); ++q) {
    if (table.region[q] != region || (share != nullptr && share->particle_owner[table.owner[q]] != share->rank())) continue;
    r.mean += table.volume[q] * at_points[q];
    r.max = std::max(r.max, at_points[q]);
    volume += table.volume[q];
  }
  if (share != nullptr) {
    std::array<double, 2> sums{r.mean, volume};
    share->reduce(sums, {&r.max, 1});
    r.mean = sums[0];
    volume = sums[1];
  }
  if (volume > 0.0) r.mean /= volume;
  return r;
}

TACTOID_INLINE RegionStatistics region_statistics(const PointTable& table, const std::vector<double>& at_points, Index region) {
  return detail::region_statistics(table, at_points, region, nullptr);
}

}  // namespace tactoid
