#pragma once

#include <algorithm>

#include <tactoid/core/compiled.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>

namespace tactoid {

TACTOID_INLINE void NodalCentroids::validate() const {
  require_non_negative("NodalCentroids.solid_ratio", solid_ratio);
  if (!(stabilization_reach > 1.0) || !std::isfinite(stabilization_reach))
    reject("NodalCentroids.stabilization_reach", stabilization_reach, "", "above 1");
  require_non_negative("NodalCentroids.fluid_modulus", fluid_modulus, "Pa");
  require_non_negative("NodalCentroids.solid_damping_time", solid_damping_time, "s");
  require_non_negative("NodalCentroids.fluid_viscosity", fluid_viscosity, "Pa s");
  require_positive("NodalCentroids.condition_limit", condition_limit);
  require_non_negative("NodalCentroids.consistency_tolerance", consistency_tolerance);
}

TACTOID_INLINE void NodalCentroids::take_spacings(const CloudPart& part, double support, std::vector<double>& spacing) {
  for (std::size_t i = 0; i < spacing.size(); ++i) {
    if (!part.complete[i]) spacing[i] = part.spacing[i];
    if (support * spacing[i] > part.support * part.spacing[i] * (1.0 + 1e-9))
      throw ParameterError(fmt::format("The part of the cloud that rank {} has was made for a support of {:.6g} m of particle {}, which has {:.6g} m: make it with a larger Part::support.", part.rank,
                                       part.support * part.spacing[i], part.number[i], support * spacing[i]));
  }
}

template <int D>
void NodalCentroids::fill_rows(PointTable& table, std::vector<double>& weights, const PointCloud<D>& cloud, const std::vector<double>& supports, const RowsOf<D>& rows_of_points,
                               const RowsToMake& rows) const {
  weights.assign(table.size(), 0.0);
  table.mass_shares.assign(table.size(), 0.0);
  parallel_for(rows.points.size(), [&](std::size_t k) {
    const std::size_t q = rows.points[k];
    const Point<D> centroid = table.position[q].template head<D>();
    std::vector<KernelNeighbor<D>> near;
    RowOfPoint<D> of_kernel;
    const auto row = rows.neighbors.row(k);
    for (Index i : row) near.push_back({cloud.difference(centroid, cloud.positions[i]), supports[i], 1.0});
    rows_of_points(near, of_kernel);
    check_condition(q, table.position[q], row.size(), of_kernel.condition, condition_limit);
    for (std::size_t j = 0; j < row.size(); ++j) {
      const std::size_t e = table.offsets[q] + j;
      for (int d = 0; d < D; ++d) table.entries[e].gradient[d] = of_kernel.gradient[j][d];
      table.mass_shares[e] = of_kernel.mass_share[j];
      weights[e] = of_kernel.weight[j];
    }
  });
}

template <int D>
PointTable NodalCentroids::table_of(const PointCloud<D>& cloud, double support, const RowsOf<D>& rows_of_points,
                                    const std::vector<NodalCell<D>>& cells, const std::vector<double>& spacing, bool moved, DividedBuild* divided) const {
  std::vector<double> supports = spacing;
  for (double& radius : supports) radius *= support;

  PointTable table = empty_table(cloud);
  table.volume.reserve(cells.size());
  table.region.reserve(cells.size());
  table.owner.reserve(cells.size());
  table.position.reserve(cells.size());
  for (const NodalCell<D>& cell : cells) {
    table.volume.push_back(cell.volume);
    table.region.push_back(cell.region);
    table.owner.push_back(cell.particle);
    table.position.push_back(pad(cell.centroid).template head<3>());
  }
  const auto find = [&](std::span<const Index> points) {
    std::vector<Point<D>> centroids;
    for (const Index q : points) centroids.push_back(cells[q].centroid);
    return neighbor_table(cloud, centroids, supports);
  };
  std::vector<double> weights;
  if (divided == nullptr) {
    RowsToMake rows;
    rows.points.resize(cells.size());
    std::iota(rows.points.begin(), rows.points.end(), Index{0});
    rows.neighbors = find(rows.points);
    lay_out_rows(table, rows.neighbors);
    fill_rows(table, weights, cloud, supports, rows_of_points, rows);
    color_chunks(table, points_per_chunk);
  } else {
    RowsToMake rows;
    if (cloud.part) {
      rows = divided->rows_of(table, *cloud.part, find);
    } else {
      cut_chunks(table, points_per_chunk);
      rows = divided->divide(table, supports, find);
    }
    lay_out_rows(table, rows.neighbors, rows.points, table.points());
    divided->together([&] { fill_rows(table, weights, cloud, supports, rows_of_points, rows); });
    if (cloud.part) divided->share_part(table, cloud.part, points_per_chunk);
    divided->share()->follow_rows(table);
  }
  if (consistency_tolerance > 0.0) {
    const std::vector<Point<D>> normals = boundary_normal_integrals(cloud);
    Field boundary;
    for (const Point<D>& b : normals) boundary.push_back(pad(b));
    if (cloud.axisymmetric) take_off_hoops(table, boundary);
    if (moved) fit_boundary(table, normals, boundary);
    if (divided == nullptr) {
      make_consistent(table, std::move(weights), boundary, consistency_tolerance);
    } else {
      SharedRows shared{*divided->share(), {}, {}};
      if (!cloud.part && table.particles >= detail::particles_for_coarse_space) shared.samples = sampled_rows(table, shared.weights, cloud, supports, rows_of_points, find);
      make_consistent(table, std::move(weights), boundary, consistency_tolerance, 20000, &shared);
    }
  }
  if (cloud.axisymmetric)
    for (std::size_t q = 0; q < table.points(); ++q)
      for (std::size_t e = table.offsets[q]; e < table.offsets[q + 1]; ++e)
        table.entries[e].gradient[2] = table.mass_shares[e] / table.position[q][0];
  weigh_stabilization(table, cloud, spacing);
  return table;
}

template <int D>
PointTable NodalCentroids::sampled_rows(const PointTable& table, std::vector<double>& weights, const PointCloud<D>& cloud, const std::vector<double>& supports,
                                        const RowsOf<D>& rows_of_points, const DividedBuild::Find& find) const {
  PointTable samples = empty_table(cloud);
  std::vector<Index> points;
  for (std::size_t q = 0; q < table.points(); q += detail::sampling_step(table.points())) {
    points.push_back(static_cast<Index>(q));
    samples.volume.push_back(table.volume[q]);
    samples.position.push_back(table.position[q]);
  }
  RowsToMake rows{{}, find(points)};
  rows.points.resize(points.size());
  std::iota(rows.points.begin(), rows.points.end(), Index{0});
  lay_out_rows(samples, rows.neighbors);
  fill_rows(samples, weights, cloud, supports, rows_of_points, rows);
  samples.mass_shares = std::vector<double>();
  return samples;
}

template <int D>
void NodalCentroids::weigh_stabilization(PointTable& table, const PointCloud<D>& cloud, const std::vector<double>& spacing) const {
  const auto length = [&](std::size_t q, std::size_t e) {
    return cloud.difference(cloud.positions[table.owner[q]], cloud.positions[table.entries[e].particle]).norm();
  };
  // Of the bond's reach; 1 for what is none.
  const auto share_of_reach = [&](std::size_t q, std::size_t e, double distance) {
    const Index particle = table.entries[e].particle;
    return particle == table.owner[q] ? 1.0 : distance / (stabilization_reach * spacing[particle]);
  };
  table.bond_offsets.assign(table.points() + 1, 0);
  parallel_for(table.points(), [&](std::size_t q) {
    std::size_t bonds = 0;
    for (std::size_t e = table.offsets[q]; e < table.offsets[q + 1] && !is_padding(table, q, e); ++e) bonds += share_of_reach(q, e, length(q, e)) < 1.0 ? 1 : 0;
    table.bond_offsets[q + 1] = (bonds + 1) / 2 * 2;
  });
  std::partial_sum(table.bond_offsets.begin(), table.bond_offsets.end(), table.bond_offsets.begin());
  table.bond_weights.assign(table.bond_offsets.back(), 0.0F);
  table.stabilization_scale.assign(table.points(), 0.0);
  parallel_for(table.points(), [&](std::size_t q) {
    std::vector<std::pair<TableEntry, double>> bonded, others;  // with their shares of the mass
    std::size_t e = table.offsets[q];
    double moment = 0.0;
    for (; e < table.offsets[q + 1] && !is_padding(table, q, e); ++e) {
      const double distance = length(q, e), x = share_of_reach(q, e, distance);
      const bool bond = x < 1.0;
      (bond ? bonded : others).emplace_back(table.entries[e], table.mass_shares[e]);
      if (!bond) continue;
      float& weight = table.bond_weights[table.bond_offsets[q] + bonded.size() - 1];
      weight = static_cast<float>(1.0 - x * x);
      moment += static_cast<double>(weight) * distance * distance;
    }
    const bool padded = e < table.offsets[q + 1];
    e = table.offsets[q];
    for (const auto* part : {&bonded, &others})
      for (const auto& [entry, share] : *part) {
        table.entries[e] = entry;
        table.mass_shares[e++] = share;
      }
    if (padded) table.entries[e].particle = table.entries[table.offsets[q]].particle;
    table.stabilization_scale[q] = moment > 0.0 ? table.volume[q] * D / moment : 0.0;
  });
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template PointTable NodalCentroids::table_of<1>(const PointCloud<1>&, double, const RowsOf<1>&, const std::vector<NodalCell<1>>&,
                                                const std::vector<double>&, bool, DividedBuild*) const;
template PointTable NodalCentroids::table_of<2>(const PointCloud<2>&, double, const RowsOf<2>&, const std::vector<NodalCell<2>>&,
                                                const std::vector<double>&, bool, DividedBuild*) const;
template PointTable NodalCentroids::table_of<3>(const PointCloud<3>&, double, const RowsOf<3>&, const std::vector<NodalCell<3>>&,
                                                const std::vector<double>&, bool, DividedBuild*) const;
}  // namespace tactoid
#endif
