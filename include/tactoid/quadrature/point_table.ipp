#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/quadrature/point_table.hpp>

namespace tactoid {

TACTOID_INLINE void PointTable::use_single_precision() {
  std::vector<std::size_t> rows(1, 0);
  rows.reserve(offsets.size());
  std::vector<SingleTableEntry> rounded;
  rounded.reserve(entries.size() + points());
  std::vector<double> values;
  const auto add = [&](const PackedVector& gradient, Index particle, double value) {
    rounded.push_back({{float(gradient[0]), float(gradient[1]), float(gradient[2])}, particle});
    if (!value_based()) values.push_back(value);
    return TableEntry(rounded.back());
  };
  for (std::size_t q = 0; q < points(); ++q) {
    if (offsets[q] == offsets[q + 1]) {  // other processes have the row
      rows.push_back(rounded.size());
      continue;
    }
    PackedVector lost;
    for (std::size_t e = offsets[q]; e < offsets[q + 1]; ++e) {
      const TableEntry& exact = entries[e];
      if (e > offsets[q] && e + 1 == offsets[q + 1] && exact.particle == entries[offsets[q]].particle && exact.gradient[0] == 0.0 && exact.gradient[1] == 0.0 && exact.gradient[2] == 0.0) break;  // padding
      const TableEntry stored = add(exact.gradient, exact.particle, value_based() ? 0.0 : point_values[e]);
      for (int k = 0; k < 3; ++k) lost[k] += exact.gradient[k] - stored.gradient[k];
    }
    add(lost, owner[q], 0.0);
    if (rounded.size() % 2 != 0) add({}, rounded[rows.back()].particle, 0.0);
    rows.push_back(rounded.size());
  }
  offsets = std::move(rows);
  single_entries = std::move(rounded);
  single_entries.shrink_to_fit();
  entries = std::vector<TableEntry>();
  point_values = std::move(values);
}

TACTOID_INLINE std::size_t PointTable::memory() const {
  const auto bytes = [](const auto&... list) { return ((list.capacity() * sizeof(list[0])) + ...); };
  return bytes(position, volume, region, owner, offsets, entries, single_entries, point_values, particle_values.offsets, particle_values.particles,
               particle_values.values, mass_shares, particle_position, stabilization_scale, bond_offsets, bond_weights, chunks, color_offsets);
}

}  // namespace tactoid
