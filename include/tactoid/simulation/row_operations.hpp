#pragma once

#include <cmath>

#include <tactoid/core/tensor.hpp>
#include <tactoid/quadrature/point_table.hpp>

/// What happens per pair of a quadrature point and a particle. Everything in this file is the hot path: fixed
/// sizes, contiguous rows, four lanes at a time, no branch that depends on data.
namespace tactoid::rows {

/// Columns of a referential gradient: column[K] = ∂f/∂X_K, padded.
struct Gradient {
  Vector4 column[3] = {Vector4::Zero(), Vector4::Zero(), Vector4::Zero()};
};

/// ∂f/∂X at a point: Σ_I f_I ⊗ G_qI. Rows have an even length, and two pairs are kept in flight.
inline void gather(std::span<const TableEntry> row, const Vector4* f, Gradient& gradient) {
  Gradient other;
  for (std::size_t k = 0; k < row.size(); k += 2) {
    const Vector4 &fa = f[row[k].particle], &fb = f[row[k + 1].particle];
    for (int K = 0; K < 3; ++K) {
      gradient.column[K] += row[k].gradient[K] * fa;
      other.column[K] += row[k + 1].gradient[K] * fb;
    }
  }
  for (int K = 0; K < 3; ++K) gradient.column[K] += other.column[K];
}

/// Two fields in one sweep.
inline void gather(std::span<const TableEntry> row, const Vector4* f, const Vector4* g, Gradient& df, Gradient& dg) {
  for (const TableEntry& entry : row) {
    const Vector4 &fi = f[entry.particle], &gi = g[entry.particle];
    for (int K = 0; K < 3; ++K) {
      df.column[K] += entry.gradient[K] * fi;
      dg.column[K] += entry.gradient[K] * gi;
    }
  }
}

/// Three fields in one sweep.
inline void gather(std::span<const TableEntry> row, const Vector4* f, const Vector4* g, const Vector4* h, Gradient& df,
                   Gradient& dg, Gradient& dh) {
  for (const TableEntry& entry : row) {
    const Vector4 &fi = f[entry.particle], &gi = g[entry.particle], &hi = h[entry.particle];
    for (int K = 0; K < 3; ++K) {
      df.column[K] += entry.gradient[K] * fi;
      dg.column[K] += entry.gradient[K] * gi;
      dh.column[K] += entry.gradient[K] * hi;
    }
  }
}

/// f_I ← f_I − Σ_K flux_K G_qI,K: the internal force of the stress columns V_q P_·K.
inline void scatter(std::span<const TableEntry> row, const Gradient& flux, Vector4* f) {
  for (const TableEntry& entry : row) {
    Vector4 sum = entry.gradient[0] * flux.column[0];
    sum += entry.gradient[1] * flux.column[1];
    sum += entry.gradient[2] * flux.column[2];
    f[entry.particle] -= sum;
  }
}

/// Two fluxes in one sweep.
inline void scatter(std::span<const TableEntry> row, const Gradient& flux, const Gradient& other, Vector4* f, Vector4* g) {
  for (const TableEntry& entry : row) {
    Vector4 a = entry.gradient[0] * flux.column[0], b = entry.gradient[0] * other.column[0];
    for (int K = 1; K < 3; ++K) {
      a += entry.gradient[K] * flux.column[K];
      b += entry.gradient[K] * other.column[K];
    }
    f[entry.particle] -= a;
    g[entry.particle] -= b;
  }
}

/// Energy and dissipated power of the stabilisation of one point.
struct StabilizationPower {
  double energy = 0.0;
  double dissipated = 0.0;
};

/// The stabilising energy of a point q with the owner I (NodalCentroids), its exact variation and its damping:
///   r_J = u_J − u_I − (F_q − 1) ΔX_J,   energy ½ κ Σ_J w_J |r_J|²,   force from κ w_J (r_J + τ ṙ_J).
/// Adds the pair forces to f, and subtracts from `flux` the part that acts through F_q. Damped: τ > 0, and v, dv count.
/// Without periodic directions r_J = (u_J − H X_J) − (u_I − H X_I), which saves the differences of positions.
template <bool Damped, bool Periodic>
StabilizationPower stabilize(std::span<const TableEntry> row, Index owner, double kappa, double tau, const Vector3& period,
                             const Vector4* X, const Vector4* u, const Vector4* v, const Gradient& du, const Gradient& dv,
                             Vector4* f, Gradient& flux) {
  const Vector4& Xi = X[owner];
  Vector4 ui = u[owner], vi = Damped ? v[owner] : Vector4::Zero();
  if constexpr (!Periodic)
    for (int K = 0; K < 3; ++K) {
      ui -= Xi[K] * du.column[K];
      if constexpr (Damped) vi -= Xi[K] * dv.column[K];
    }
  Vector4 total = Vector4::Zero(), energy = Vector4::Zero(), rate = Vector4::Zero();
  Gradient moment;
  for (const TableEntry& entry : row) {
    const double w = kappa * static_cast<double>(entry.weight);
    const double* XJ = X[entry.particle].data();
    double x[3] = {XJ[0], XJ[1], XJ[2]};
    if constexpr (Periodic)
      for (int k = 0; k < 3; ++k) {
        x[k] -= Xi[k];
        if (period[k] > 0.0) x[k] -= period[k] * std::round(x[k] / period[k]);
      }
    Vector4 r = u[entry.particle] - ui;
    for (int K = 0; K < 3; ++K) r -= x[K] * du.column[K];
    Vector4 force = w * r;
    energy += force.cwiseProduct(r);
    if constexpr (Damped) {
      Vector4 s = v[entry.particle] - vi;
      for (int K = 0; K < 3; ++K) s -= x[K] * dv.column[K];
      const Vector4 ws = w * s;
      rate += ws.cwiseProduct(s);
      force += tau * ws;
    }
    f[entry.particle] -= force;
    total += force;
    for (int K = 0; K < 3; ++K) moment.column[K] += x[K] * force;
  }
  f[owner] += total;
  for (int K = 0; K < 3; ++K) flux.column[K] -= Periodic ? moment.column[K] : Vector4(moment.column[K] - Xi[K] * total);
  return {0.5 * energy.sum(), tau * rate.sum()};
}

/// The same, with the choice of the loop made once per point; v may be null (τ = 0).
inline StabilizationPower stabilize(std::span<const TableEntry> row, Index owner, double kappa, double tau,
                                    const Vector3& period, const Vector4* X, const Vector4* u, const Vector4* v,
                                    const Gradient& du, const Gradient& dv, Vector4* f, Gradient& flux) {
  if (period.any()) {
    if (v) return stabilize<true, true>(row, owner, kappa, tau, period, X, u, v, du, dv, f, flux);
    return stabilize<false, true>(row, owner, kappa, 0.0, period, X, u, v, du, dv, f, flux);
  }
  if (v) return stabilize<true, false>(row, owner, kappa, tau, period, X, u, v, du, dv, f, flux);
  return stabilize<false, false>(row, owner, kappa, 0.0, period, X, u, v, du, dv, f, flux);
}

}  // namespace tactoid::rows
