#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/quadrature/particle_values.hpp>

namespace tactoid {

TACTOID_INLINE ParticleValues::ParticleValues(const ValueRows& rows)
    : rows_(rows) {
  if (rows_.empty()) return;
  // The transpose by rows of the unknowns: each sum is made by one thread, in a fixed order.
  const std::size_t n = rows_.offsets.size() - 1;
  transpose_.offsets.assign(n + 1, 0);
  for (Index j : rows_.particles) ++transpose_.offsets[j + 1];
  for (std::size_t j = 0; j < n; ++j) transpose_.offsets[j + 1] += transpose_.offsets[j];
  transpose_.particles.resize(rows_.particles.size());
  transpose_.values.resize(rows_.particles.size());
  std::vector<std::size_t> next(transpose_.offsets.begin(), transpose_.offsets.end() - 1);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t e = rows_.offsets[i]; e < rows_.offsets[i + 1]; ++e) {
      const std::size_t to = next[rows_.particles[e]]++;
      transpose_.particles[to] = static_cast<Index>(i);
      transpose_.values[to] = rows_.values[e];
    }
}

TACTOID_INLINE Field ParticleValues::evaluate(const Field& unknowns) const {
  if (identity()) return unknowns;
  Field values(unknowns.size());
  multiply(rows_, unknowns, values, false);
  return values;
}

TACTOID_INLINE void ParticleValues::distribute(const Field& at_particles, Field& unknowns) const {
  if (identity()) {
    parallel_for(unknowns.size(), [&](std::size_t i) { unknowns[i] += at_particles[i]; });
  } else {
    multiply(transpose_, at_particles, unknowns, true);
  }
}

TACTOID_INLINE void ParticleValues::multiply(const ValueRows& rows, const Field& x, Field& y, bool add) {
  parallel_for(y.size(), [&](std::size_t i) {
    Vector4 sum = add ? y[i] : Vector4::Zero();
    for (std::size_t e = rows.offsets[i]; e < rows.offsets[i + 1]; ++e) sum += rows.values[e] * x[rows.particles[e]];
    y[i] = sum;
  });
}

}  // namespace tactoid
