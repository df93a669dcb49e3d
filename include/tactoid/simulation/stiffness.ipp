#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/simulation/stiffness.hpp>

namespace tactoid::detail {

template <int D>
StiffnessMatrix stiffness_pattern(const PointTable& table) {
  std::vector<std::vector<Index>> points_of(table.particles);
  for (Index q = 0; q < table.points(); ++q)
    for (std::size_t e = table.offsets[q]; e < table.offsets[q + 1]; ++e)
      if (!is_padding(table, q, e)) points_of[table.entries[e].particle].push_back(q);
  std::vector<std::vector<Index>> near(table.particles);
  parallel_for(table.particles, [&](std::size_t j) {
    for (Index q : points_of[j])
      for (const TableEntry& entry : table.row(q)) near[j].push_back(entry.particle);
    std::sort(near[j].begin(), near[j].end());
    near[j].erase(std::unique(near[j].begin(), near[j].end()), near[j].end());
  });
  const auto n = static_cast<Eigen::Index>(D * table.particles);
  StiffnessMatrix K(n, n);
  Eigen::VectorXi sizes(n);
  for (std::size_t j = 0; j < near.size(); ++j)
    sizes.segment<D>(static_cast<Eigen::Index>(D * j)).setConstant(static_cast<int>(D * near[j].size()));
  K.reserve(sizes);
  for (std::size_t j = 0; j < near.size(); ++j)
    for (int c = 0; c < D; ++c)
      for (Index i : near[j])
        for (int r = 0; r < D; ++r)
          K.insert(static_cast<Eigen::Index>(D * i) + r, static_cast<Eigen::Index>(D * j) + c) = 0.0;
  K.makeCompressed();
  return K;
}

}  // namespace tactoid::detail

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template StiffnessMatrix stiffness_pattern<1>(const PointTable& table);
template StiffnessMatrix stiffness_pattern<2>(const PointTable& table);
template StiffnessMatrix stiffness_pattern<3>(const PointTable& table);
}  // namespace tactoid::detail
#endif
