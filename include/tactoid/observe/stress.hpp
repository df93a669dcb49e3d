#pragma once

#include <cstddef>
#include <vector>

#include <tactoid/kinematics/kinematics.hpp>
#include <tactoid/quadrature/point_table.hpp>
#include <tactoid/quadrature/row_share.hpp>

namespace tactoid {

/// Effective (von Mises) stress, pressure and volume ratio of a body, at its points and averaged to its particles.
struct StressFields {
  std::vector<double> point_effective_stress;  ///< Pa, per quadrature point
  std::vector<double> effective_stress;        ///< Pa, per particle
  std::vector<double> pressure;                ///< −tr σ / 3, Pa, per particle
  std::vector<double> volume_ratio;            ///< J, per particle
};

/// Mean (weighted by the volumes of the table) and largest value over the points of a region.
struct RegionStatistics {
  double mean = 0.0;  ///< weighted by the volumes of the table
  double max = 0.0;   ///< 0 where no value is positive
};

namespace detail {

/// Of the points of own particles, and then of all processes, where `share` is not null.
[[nodiscard]] RegionStatistics region_statistics(const PointTable& table, const std::vector<double>& at_points, Index region, RowShare* share);

/// From the stress at the points of a body and their reference volumes, m³.
[[nodiscard]] StressFields stress_fields(const PointTable& table, const std::vector<PointSample>& samples, const std::vector<double>& volumes);

}  // namespace detail

/// Samples the Cauchy stress of a body at the present state. Particle values are the averages over the particle's
/// points, weighted by reference volume (and by the shape functions, where unknowns are coefficients). Of a body of which each process has a part of the
/// cloud, they are those of the part (at points of other processes 0); collective.
template <class Body>
[[nodiscard]] StressFields stress_fields(Body& body) {
  std::vector<double> volumes(body.table().points());
  for (std::size_t q = 0; q < volumes.size(); ++q) volumes[q] = body.point_volume(q);
  StressFields fields = detail::stress_fields(body.table(), body.sample_points(), volumes);
  if (body.in_parts())  // rows of particles around the own ones are elsewhere
    for (std::vector<double>* values : {&fields.effective_stress, &fields.pressure, &fields.volume_ratio}) body.share()->complete(*values);
  return fields;
}

/// Statistics of values at the quadrature points (stress_fields().point_effective_stress) over a region, its number
/// in Materials{…}; zero for a region without points.
[[nodiscard]] RegionStatistics region_statistics(const PointTable& table, const std::vector<double>& at_points,
                                                 Index region);
/// The same of the points of a body; of one of which each process has a part, of the whole (collective).
template <class Body>
[[nodiscard]] RegionStatistics region_statistics(const Body& body, const std::vector<double>& at_points, Index region) {
  return detail::region_statistics(body.table(), at_points, region, body.in_parts() ? body.share() : nullptr);
}

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/observe/stress.ipp>
#endif
