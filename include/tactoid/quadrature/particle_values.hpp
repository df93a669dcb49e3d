#pragma once

#include <tactoid/core/parallel.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/quadrature/point_table.hpp>

namespace tactoid {

/// The map from the unknowns of a body to the values of its fields at the particles, u(X_I) = Σ_J φ_J(X_I) u_J, and
/// its transpose, which hands a force at a particle to the unknowns. The identity where unknowns are values.
class ParticleValues {
 public:
  ParticleValues() = default;
  explicit ParticleValues(const ValueRows& rows);  ///< φ_J(X_I), a row per particle; empty: the identity

  [[nodiscard]] bool identity() const { return rows_.empty(); }  ///< unknowns are values at the particles
  [[nodiscard]] const ValueRows& rows() const { return rows_; }  ///< φ_J(X_I); empty where that is the identity

  /// Values at the particles.
  [[nodiscard]] Field evaluate(const Field& unknowns) const;
  /// Adds forces at the particles to the forces of the unknowns.
  void distribute(const Field& at_particles, Field& unknowns) const;

 private:
  static void multiply(const ValueRows& rows, const Field& x, Field& y, bool add);
  ValueRows rows_, transpose_;
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/quadrature/particle_values.ipp>
#endif
