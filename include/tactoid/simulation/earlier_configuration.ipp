#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/simulation/earlier_configuration.hpp>

namespace tactoid {

TACTOID_INLINE void smooth_volume_ratio(const PointTable& table, std::size_t begin, std::size_t end,
                                        EarlierConfiguration& earlier) {
  constexpr int passes = 2;
  constexpr double share = 0.5;  // of the difference to the mean of the neighbours: what alternates is gone
  std::vector<std::size_t> point_of(table.particles, end);
  std::vector<double> ratio(end - begin), change(end - begin);
  for (std::size_t q = begin; q < end; ++q) {
    point_of[table.owner[q]] = q;
    ratio[q - begin] = determinant(earlier.gradient[q]);
  }
  const std::vector<double> first = ratio;
  for (int pass = 0; pass < passes; ++pass) {
    std::fill(change.begin(), change.end(), 0.0);
    for (std::size_t q = begin; q < end; ++q) {
      const auto weights = table.bonds(q);
      double sum = 0.0;
      for (const float w : weights) sum += static_cast<double>(w);
      for (std::size_t k = 0; k < weights.size(); ++k) {
        const std::size_t r = point_of[table.row(q)[k].particle];
        if (r == end || !(weights[k] > 0.0F)) continue;
        const double moved = 0.5 * share * earlier.volume[q] * static_cast<double>(weights[k]) / sum * (ratio[r - begin] - ratio[q - begin]);
        change[q - begin] += moved / earlier.volume[q];
        change[r - begin] -= moved / earlier.volume[r];
      }
    }
    for (std::size_t i = 0; i < ratio.size(); ++i) ratio[i] += change[i];
  }
  for (std::size_t q = begin; q < end; ++q) earlier.gradient[q] *= std::cbrt(ratio[q - begin] / first[q - begin]);
}

}  // namespace tactoid
