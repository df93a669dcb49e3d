#pragma once

#include <span>
#include <vector>

#include <tactoid/core/ranks.hpp>
#include <tactoid/core/tensor.hpp>

namespace tactoid {

/// What contact and boundary terms see of a body: values *at the particles* (interpolated, where the body's
/// unknowns are coefficients), and the forces at the particles, to which they add. All spans have one entry per
/// particle, padded to four components; components beyond the dimension of the body are zero.
struct ParticleFields {
  std::span<const Vector4> reference;  ///< X, m
  std::span<const Vector4> position;   ///< x = X + u(X), m
  std::span<const Vector4> velocity;   ///< v, m/s
  std::span<const double> mass;        ///< lumped mass, kg
  std::span<const double> volume;      ///< reference nodal volume, m³
  std::span<Vector4> force;            ///< N
  Ranks* ranks = nullptr;              ///< processes that share the bodies, and evaluate each term together; null: this one alone
  /// Where the processes sum in their own order (SumOrder::of_ranks): the particles that belong to this one, ascending; null: it computes what falls on any.
  const std::vector<Index>* own = nullptr;
  const std::vector<int>* owner = nullptr;  ///< beside `own`: the process of each particle
};

/// Which particles of a body a contact or a boundary term reads and loads. One that says `static constexpr Reads reads =
/// Reads::facets;` (a contact: `reads_a`, `reads_b`, one for each body) lets several processes that share a simulation tell each
/// other less in every step. Unless it says so, it may read everything.
enum class Reads {
  all,    ///< any particle
  facets  ///< particles on facets of the cloud
};

/// Energy and power of a contact or boundary term at one instant.
struct TermEnergy {
  double potential = 0.0;         ///< stored, J
  double external_power = 0.0;    ///< power of forces that have no energy of their own in the balance, W
  double dissipated_power = 0.0;  ///< W, >= 0
  /// Sums of several terms.
  TermEnergy& operator+=(const TermEnergy& other) {
    potential += other.potential;
    external_power += other.external_power;
    dissipated_power += other.dissipated_power;
    return *this;
  }
};

}  // namespace tactoid
