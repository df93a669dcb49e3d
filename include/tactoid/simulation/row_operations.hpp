#pragma once

#include <cmath>
#include <span>
#include <type_traits>
#include <vector>

#include <tactoid/core/lanes.hpp>
#include <tactoid/core/quad.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/quadrature/point_table.hpp>

/// What happens per pair of a quadrature point and a particle. Everything in this file is the hot path: fixed
/// sizes, contiguous rows, no branch that depends on data. A padded vector is a register (core/quad.hpp), and each loop
/// holds no more of them than a machine with sixteen has: what does not fit goes through memory for every pair.
namespace tactoid::rows {

/// What a particle does, side by side: one line of the cache.
struct alignas(64) Motion {
  double displacement[4];  ///< u_I, m
  double velocity[4];      ///< v_I, m/s
};

/// What the force loop knows of a particle's motion: u and v, or u alone where no rate is needed.
template <bool Rate>
using MotionOf = std::conditional_t<Rate, Motion, Vector4>;
/// u of either.
[[nodiscard]] inline const double* displacement(const Motion& motion) { return motion.displacement; }
/// u of either.
[[nodiscard]] inline const double* displacement(const Vector4& u) { return u.data(); }

/// Columns of a referential gradient: column[K] = ∂f/∂X_K.
struct Gradient {
  Quad column[3] = {};  ///< 1/m times the unit of f
};

/// sum ← sum + f ⊗ gradient.
[[gnu::always_inline]] inline void add_outer(Gradient& sum, const Quad& f, const double (&gradient)[3]) {
  sum.column[0] += gradient[0] * f;
  sum.column[1] += gradient[1] * f;
  sum.column[2] += gradient[2] * f;
}

/// The same for f in memory.
[[gnu::always_inline]] inline void add_outer(Gradient& sum, const double* f, const double (&gradient)[3]) {
  const Quad value = quad(f);
  add_outer(sum, value, gradient);
}

/// In a meridian section the third column of a gathered gradient is f/R. The parts of ∂f/∂X around the axis, where the unit
/// vectors turn, are made of it: (−f_θ, 0, f_R)/R, with the third component θ around the axis.
inline void turn_around_axis(Gradient& df) {
  const Quad f = df.column[2];
  df.column[2] = Quad{-f[2], 0.0, f[0], 0.0};
}
/// The transpose, for a flux that is scattered: what acts around the axis on f_R and f_θ.
inline void turn_back(Gradient& flux) {
  const Quad around = flux.column[2];
  flux.column[2] = Quad{around[2], 0.0, -around[0], 0.0};
}

/// ∂f/∂X at a point: Σ_I f_I ⊗ G_qI. Two sums are kept in flight, so that they do not wait for each other.
inline void gather(std::span<const TableEntry> row, const Vector4* f, Gradient& df) {
  Gradient even, odd;
  for (std::size_t k = 0; k < row.size(); k += 2) {
    const TableEntry &a = row[k], &b = row[k + 1];
    add_outer(even, f[a.particle].data(), a.gradient);
    add_outer(odd, f[b.particle].data(), b.gradient);
  }
  for (int K = 0; K < 3; ++K) df.column[K] = even.column[K] + odd.column[K];
}

/// A row of single precision in double, written to `to`. Once per step: gather, stabilise and scatter all read it from the cache.
inline std::span<const TableEntry> unpack(std::span<const SingleTableEntry> row, TableEntry* to) {
  for (std::size_t k = 0; k < row.size(); ++k) widen(&row[k], &to[k]);
  return {to, row.size()};
}

/// ∂f/∂X of a field at a point of the table, the parts around an axis included; outside of the hot path.
[[nodiscard]] inline Tensor3 gradient_at(const PointTable& table, std::size_t q, const Field& f) {
  Gradient df;
  if (table.single_entries.empty()) {
    gather(table.stored_row<TableEntry>(q), f.data(), df);
  } else {
    std::vector<TableEntry> row(table.row(q).size());
    gather(unpack(table.stored_row<SingleTableEntry>(q), row.data()), f.data(), df);
  }
  if (table.axisymmetric) turn_around_axis(df);
  Tensor3 gradient;
  for (int K = 0; K < 3; ++K)
    for (int i = 0; i < 3; ++i) gradient(i, K) = df.column[K][i];
  return gradient;
}

/// The gradients of displacement and velocity in one sweep.
inline void gather(std::span<const TableEntry> row, const Motion* motion, Gradient& du, Gradient& dv) {
  Gradient u, v;
  for (const TableEntry& entry : row) {
    const Motion& m = motion[entry.particle];
    add_outer(u, m.displacement, entry.gradient);
    add_outer(v, m.velocity, entry.gradient);
  }
  du = u, dv = v;
}

/// And of the director.
inline void gather(std::span<const TableEntry> row, const Motion* motion, const Vector4* director, Gradient& du, Gradient& dv,
                   Gradient& dh) {
  Gradient u, v, h;
  for (const TableEntry& entry : row) {
    const Motion& m = motion[entry.particle];
    add_outer(u, m.displacement, entry.gradient);
    add_outer(v, m.velocity, entry.gradient);
    add_outer(h, director[entry.particle].data(), entry.gradient);
  }
  du = u, dv = v, dh = h;
}

/// Gradients of W points as one tensor of lanes: A(i, K) holds ∂f_i/∂X_K of all of them.
template <int W>
inline void to_lanes(const Gradient (&points)[W], Tensor<Lanes<W>>& A) {
  static_assert(W % 4 == 0);
  for (int K = 0; K < 3; ++K)
    for (int l = 0; l < W; l += 4) {
      Quad x = points[l].column[K], y = points[l + 1].column[K], z = points[l + 2].column[K], w = points[l + 3].column[K];
      transpose(x, y, z, w);
      quad(A(0, K).lane.data() + l) = x;
      quad(A(1, K).lane.data() + l) = y;
      quad(A(2, K).lane.data() + l) = z;
    }
}
/// The same for a law that is evaluated at one point at a time.
inline void to_lanes(const Gradient (&points)[1], Tensor<double>& A) {
  for (int K = 0; K < 3; ++K)
    for (int i = 0; i < 3; ++i) A(i, K) = points[0].column[K][i];
}

/// The other way, and times the points' volumes: column K of point l is volume[l] A_·K.
template <int W>
inline void to_points(const Tensor<Lanes<W>>& A, const double (&volume)[W], Gradient (&points)[W]) {
  for (int K = 0; K < 3; ++K)
    for (int l = 0; l < W; l += 4) {
      const Quad V = quad(volume + l);
      Quad x = V * quad(A(0, K).lane.data() + l), y = V * quad(A(1, K).lane.data() + l), z = V * quad(A(2, K).lane.data() + l);
      Quad w = {};
      transpose(x, y, z, w);
      points[l].column[K] = x;
      points[l + 1].column[K] = y;
      points[l + 2].column[K] = z;
      points[l + 3].column[K] = w;
    }
}
/// The same for a law that is evaluated at one point at a time.
inline void to_points(const Tensor<double>& A, const double (&volume)[1], Gradient (&points)[1]) {
  for (int K = 0; K < 3; ++K) points[0].column[K] = volume[0] * Quad{A(0, K), A(1, K), A(2, K), 0.0};
}

/// f ← f − Σ_K flux_K G_K: what the stress columns V_q P_·K do to the particle of a pair.
[[gnu::always_inline]] inline void subtract(double* f, const TableEntry& entry, const Gradient& flux) {
  quad(f) -= entry.gradient[0] * flux.column[0] + entry.gradient[1] * flux.column[1] + entry.gradient[2] * flux.column[2];
}
/// The same, and − held, a force that this pair has of its own.
[[gnu::always_inline]] inline void subtract(double* f, const TableEntry& entry, const Gradient& flux, const Quad& held) {
  quad(f) -= entry.gradient[0] * flux.column[0] + entry.gradient[1] * flux.column[1] + entry.gradient[2] * flux.column[2] + held;
}

/// f_I ← f_I − Σ_K flux_K G_qI,K, and − held for the first pairs, which have a force of their own.
inline void scatter(std::span<const TableEntry> row, const Gradient& flux, std::span<const Quad> held, Vector4* f) {
  const Gradient local = flux;  // what a store to a force may have changed, a compiler must load anew
  for (std::size_t k = 0; k < held.size(); ++k) subtract(f[row[k].particle].data(), row[k], local, held[k]);
  for (std::size_t k = held.size(); k < row.size(); ++k) subtract(f[row[k].particle].data(), row[k], local);
}

/// The same, and the flux of the director in the same sweep.
inline void scatter(std::span<const TableEntry> row, const Gradient& flux, std::span<const Quad> held, Vector4* f,
                    const Gradient& director_flux, Vector4* h) {
  const Gradient local = flux, local_h = director_flux;
  for (std::size_t k = 0; k < held.size(); ++k) {
    subtract(f[row[k].particle].data(), row[k], local, held[k]);
    subtract(h[row[k].particle].data(), row[k], local_h);
  }
  for (std::size_t k = held.size(); k < row.size(); ++k) {
    subtract(f[row[k].particle].data(), row[k], local);
    subtract(h[row[k].particle].data(), row[k], local_h);
  }
}

/// Asks for a row that will be needed soon, so that it comes from memory while other rows are computed.
template <class Entry>
void prefetch(std::span<const Entry> row) {
  for (std::size_t k = 0; k < row.size(); k += 64 / sizeof(Entry)) __builtin_prefetch(row.data() + k);
}

/// Energy and dissipated power of the stabilisation of one point.
struct StabilizationPower {
  double energy = 0.0;      ///< ½ κ Σ_J w_J |r_J|², J
  double dissipated = 0.0;  ///< κ τ Σ_J w_J |ṙ_J|², W
};

/// A point whose pairs are stabilised.
struct StabilizedPoint {
  std::span<const TableEntry> row;  ///< its pairs
  std::span<const float> weights;  ///< w_J, of the first entries of the row
  Index owner;                     ///< I
  double kappa;                    ///< κ, N/m
  double tau;                      ///< τ, s
};

/// The stabilising energy of a point q with the owner I (NodalCentroids), its exact variation and its damping:
///   r_J = u_J − u_I − H ΔX_J,  H = F_q − 1,   energy ½ κ Σ_J w_J |r_J|²,   force from κ w_J (r_J + τ ṙ_J).
/// Writes the force of each of these pairs to `held`, adds the owner's to f, and subtracts from `flux` the part that acts
/// through F_q. `periodic` directions take the nearest images. Without them r_J = (u_J − H X_J) − (u_I − H X_I), which saves
/// the differences of positions.
template <bool Periodic, bool Rate>
StabilizationPower stabilize(const StabilizedPoint& point, const Vector3& period, const Vector4* X, const MotionOf<Rate>* motion,
                             const Gradient& du, [[maybe_unused]] const Gradient& dv, Quad* held, Vector4* f, Gradient& flux) {
  const double* XI = X[point.owner].data();
  const double x_owner[3] = {XI[0], XI[1], XI[2]};
  const Gradient H = du, H_rate = dv;
  Quad origin = quad(displacement(motion[point.owner])), origin_rate = {};
  if constexpr (Rate) origin_rate = quad(motion[point.owner].velocity);
  if constexpr (!Periodic)
    for (int K = 0; K < 3; ++K) {
      origin -= x_owner[K] * H.column[K];
      if constexpr (Rate) origin_rate -= x_owner[K] * H_rate.column[K];
    }
  Quad force_sum = {}, energy = {}, dissipated = {};
  Gradient moment;
  for (std::size_t k = 0; k < point.weights.size(); ++k) {
    const Index J = point.row[k].particle;
    const double* XJ = X[J].data();
    double x[3] = {XJ[0], XJ[1], XJ[2]};
    if constexpr (Periodic)
      for (int K = 0; K < 3; ++K) {
        x[K] -= x_owner[K];
        if (period[K] > 0.0) x[K] -= period[K] * std::round(x[K] / period[K]);
      }
    const double w = point.kappa * static_cast<double>(point.weights[k]);
    const Quad r = quad(displacement(motion[J])) - origin - x[0] * H.column[0] - x[1] * H.column[1] - x[2] * H.column[2];
    Quad force = w * r;
    energy += force * r;
    if constexpr (Rate) {
      const Quad rate = quad(motion[J].velocity) - origin_rate - x[0] * H_rate.column[0] - x[1] * H_rate.column[1] - x[2] * H_rate.column[2];
      const Quad damping = (w * point.tau) * rate;
      dissipated += damping * rate;
      force += damping;
    }
    held[k] = force;
    force_sum += force;
    add_outer(moment, force, x);
  }
  quad(f[point.owner].data()) += force_sum;
  for (int K = 0; K < 3; ++K) {
    flux.column[K] -= moment.column[K];
    if constexpr (!Periodic) flux.column[K] += x_owner[K] * force_sum;
  }
  return {0.5 * (energy[0] + energy[1] + energy[2]), dissipated[0] + dissipated[1] + dissipated[2]};
}

}  // namespace tactoid::rows
