#pragma once

#include <cmath>

#include <tactoid/core/tensor.hpp>
#include <tactoid/quadrature/point_table.hpp>

/// What happens per pair of a quadrature point and a particle. Everything in this file is the hot path: fixed
/// sizes, contiguous rows, no branch that depends on data. A particle's values are four lanes (a padded vector) or eight
/// (displacement and velocity side by side), which one load brings; rows have an even length, and two pairs are kept
/// in flight, so that sums do not wait for each other.
namespace tactoid::rows {

/// N values of a particle: a padded vector, or two.
template <int N>
using Values = Eigen::Matrix<double, N, 1>;

/// Columns of a referential gradient: column[K] = ∂f/∂X_K.
template <int N = 4>
struct Gradient {
  /// column[K] = ∂f/∂X_K.
  Values<N> column[3] = {Values<N>::Zero(), Values<N>::Zero(), Values<N>::Zero()};
};

/// In a meridian section the third column of a gathered gradient is f/R. The parts of ∂f/∂X around the axis, where the unit
/// vectors turn, are made of it: (−f_θ, 0, f_R)/R, with the third component θ around the axis.
template <int N>
inline void turn_around_axis(Gradient<N>& df) {
  for (int half = 0; half < N; half += 4) {
    const double f_r = df.column[2][half], f_theta = df.column[2][half + 2];
    df.column[2][half] = -f_theta;
    df.column[2][half + 1] = 0.0;
    df.column[2][half + 2] = f_r;
  }
}
/// The transpose, for a flux that is scattered: what acts around the axis on f_R and f_θ.
inline void turn_back(Gradient<>& flux) {
  const Vector4 around = flux.column[2];
  flux.column[2] = Vector4(around[2], 0.0, -around[0], 0.0);
}

// The loops below work on local copies: what a store to a force may have changed, a compiler must load anew. (A copy by
// assignment is a load; the copy constructor would go through the stack.)

/// ∂f/∂X at a point: Σ_I f_I ⊗ G_qI.
template <int N>
inline void gather(std::span<const TableEntry> row, const Values<N>* f, Gradient<N>& df) {
  Gradient<N> even, odd;
  for (std::size_t k = 0; k < row.size(); k += 2) {
    const TableEntry &a = row[k], &b = row[k + 1];
    Values<N> fa, fb;
    fa = f[a.particle], fb = f[b.particle];
    for (int K = 0; K < 3; ++K) {
      even.column[K] += a.gradient[K] * fa;
      odd.column[K] += b.gradient[K] * fb;
    }
  }
  for (int K = 0; K < 3; ++K) df.column[K] = even.column[K] + odd.column[K];
}

/// Two fields in one sweep.
template <int N, int M>
inline void gather(std::span<const TableEntry> row, const Values<N>* f, const Values<M>* g, Gradient<N>& df,
                   Gradient<M>& dg) {
  Gradient<N> f_even, f_odd;
  Gradient<M> g_even, g_odd;
  for (std::size_t k = 0; k < row.size(); k += 2) {
    const TableEntry &a = row[k], &b = row[k + 1];
    Values<N> fa, fb;
    Values<M> ga, gb;
    fa = f[a.particle], fb = f[b.particle], ga = g[a.particle], gb = g[b.particle];
    for (int K = 0; K < 3; ++K) {
      f_even.column[K] += a.gradient[K] * fa;
      g_even.column[K] += a.gradient[K] * ga;
      f_odd.column[K] += b.gradient[K] * fb;
      g_odd.column[K] += b.gradient[K] * gb;
    }
  }
  for (int K = 0; K < 3; ++K) {
    df.column[K] = f_even.column[K] + f_odd.column[K];
    dg.column[K] = g_even.column[K] + g_odd.column[K];
  }
}

/// Σ_K flux_K G_qI,K: what the stress columns V_q P_·K do to the particle of a pair.
[[nodiscard]] inline Vector4 contracted(const TableEntry& entry, const Gradient<>& flux) {
  Vector4 sum = entry.gradient[0] * flux.column[0];
  sum += entry.gradient[1] * flux.column[1];
  sum += entry.gradient[2] * flux.column[2];
  return sum;
}

/// f_I ← f_I − Σ_K flux_K G_qI,K.
inline void scatter(std::span<const TableEntry> row, const Gradient<>& flux, Vector4* f) {
  const Gradient<> local = flux;
  for (const TableEntry& entry : row) f[entry.particle] -= contracted(entry, local);
}

/// The same with a force held for each of the first pairs: f_I ← f_I − held − Σ_K flux_K G_qI,K.
inline void scatter(std::span<const TableEntry> row, const Gradient<>& flux, std::span<const Vector4> held, Vector4* f) {
  const Gradient<> local = flux;
  for (std::size_t k = 0; k < held.size(); ++k) f[row[k].particle] -= contracted(row[k], local) + held[k];
  for (std::size_t k = held.size(); k < row.size(); ++k) f[row[k].particle] -= contracted(row[k], local);
}

/// Asks for a row that will be needed soon, so that it comes from memory while other rows are computed.
inline void prefetch(std::span<const TableEntry> row) {
#if defined(__GNUC__)
  for (std::size_t k = 0; k < row.size(); k += 2) __builtin_prefetch(row.data() + k);
#endif
}

/// Energy and dissipated power of the stabilisation of one point.
struct StabilizationPower {
  double energy = 0.0;      ///< ½ κ Σ_J w_J |r_J|², J
  double dissipated = 0.0;  ///< κ τ Σ_J w_J |ṙ_J|², W
};

/// The stabilising energy of a point q with the owner I (NodalCentroids), its exact variation and its damping:
///   r_J = u_J − u_I − (F_q − 1) ΔX_J,   energy ½ κ Σ_J w_J |r_J|²,   force from κ w_J (r_J + τ ṙ_J).
/// over the `weights` of the first entries of the row. Writes the force of each of these pairs to `held`, adds the
/// owner's to f, and subtracts from `flux` the part that acts through F_q. `motion` holds u of the particles, or (u, v) where the stabilisation is damped, and `gradient` its gradient.
/// Without periodic directions r_J = (u_J − H X_J) − (u_I − H X_I), which saves the differences of positions.
template <bool Periodic, int N>
StabilizationPower stabilize(std::span<const TableEntry> row, std::span<const float> weights, Index owner, double kappa,
                             double tau, const Vector3& period,
                             const Vector4* X, const Values<N>* motion, const Gradient<N>& gradient, Vector4* held,
                             Vector4* f, Gradient<>& flux) {
  const Vector4 Xi = X[owner];
  const Gradient<N> H = gradient;
  Values<N> origin = motion[owner];
  if constexpr (!Periodic)
    for (int K = 0; K < 3; ++K) origin -= Xi[K] * H.column[K];

  struct Sums {
    Values<N> force = Values<N>::Zero(), energy = Values<N>::Zero(), moment[3] = {force, force, force};
  };
  const auto visit = [&](const TableEntry& entry, float weight, Sums& sums, Vector4& pair_force) {
    const double w = kappa * static_cast<double>(weight);
    const double* XJ = X[entry.particle].data();
    double x[3] = {XJ[0], XJ[1], XJ[2]};
    if constexpr (Periodic)
      for (int k = 0; k < 3; ++k) {
        x[k] -= Xi[k];
        if (period[k] > 0.0) x[k] -= period[k] * std::round(x[k] / period[k]);
      }
    Values<N> r = motion[entry.particle] - origin;
    for (int K = 0; K < 3; ++K) r -= x[K] * H.column[K];
    const Values<N> force = w * r;
    sums.energy += force.cwiseProduct(r);
    sums.force += force;
    for (int K = 0; K < 3; ++K) sums.moment[K] += x[K] * force;
    if constexpr (N == 8) pair_force = force.template head<4>() + tau * force.template tail<4>();
    else pair_force = force;
  };
  Sums even, odd;
  for (std::size_t k = 0; k < weights.size(); k += 2) {
    visit(row[k], weights[k], even, held[k]);
    visit(row[k + 1], weights[k + 1], odd, held[k + 1]);
  }
  const auto damped = [&](const Values<N>& a) -> Vector4 {
    if constexpr (N == 8) return a.template head<4>() + tau * a.template tail<4>();
    else return a;
  };
  const Vector4 total = damped(even.force + odd.force);
  f[owner] += total;
  for (int K = 0; K < 3; ++K) {
    const Vector4 moment = damped(even.moment[K] + odd.moment[K]);
    flux.column[K] -= Periodic ? moment : Vector4(moment - Xi[K] * total);
  }
  const Values<N> energy = even.energy + odd.energy;
  if constexpr (N == 8) return {0.5 * energy.template head<4>().sum(), tau * energy.template tail<4>().sum()};
  else return {0.5 * energy.sum(), 0.0};
}

/// The same, with the choice of the loop made once per point.
template <int N>
StabilizationPower stabilize(std::span<const TableEntry> row, std::span<const float> weights, Index owner, double kappa,
                             double tau, const Vector3& period,
                             const Vector4* X, const Values<N>* motion, const Gradient<N>& gradient, Vector4* held,
                             Vector4* f, Gradient<>& flux) {
  if (period.any()) return stabilize<true>(row, weights, owner, kappa, tau, period, X, motion, gradient, held, f, flux);
  return stabilize<false>(row, weights, owner, kappa, tau, period, X, motion, gradient, held, f, flux);
}

}  // namespace tactoid::rows
