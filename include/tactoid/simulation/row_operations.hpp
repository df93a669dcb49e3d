#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>

#include <tactoid/core/lanes.hpp>
#include <tactoid/core/quad.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/quadrature/point_table.hpp>

/// What happens per pair of a quadrature point and a particle. Everything in this file is the hot path: fixed sizes, contiguous
/// rows, no branch that depends on data. A padded vector is a register, and two of them are one where registers are long enough
/// (core/quad.hpp): u and v of one particle, or the same quantity of two.
namespace tactoid::rows {

/// What a particle does, side by side: one line of the cache.
struct alignas(64) Motion {
  double displacement[4];  ///< u_I, m
  double velocity[4];      ///< v_I, m/s
};

/// What the force loop knows of a particle's motion: u and v, or u alone where no rate is needed.
template <bool Rate>
using MotionOf = std::conditional_t<Rate, Motion, Vector4>;
/// u and v of a particle as one vector.
[[nodiscard, gnu::always_inline]] inline Octet in_vector(const Motion& motion) { return octet(motion.displacement); }
/// u alone.
[[nodiscard, gnu::always_inline]] inline Quad in_vector(const Vector4& u) { return quad(u.data()); }

/// Columns of a referential gradient: column[K] = ∂f/∂X_K.
struct Gradient {
  Quad column[3] = {};  ///< 1/m times the unit of f
};

/// Columns of two of them side by side.
struct TwoGradients {
  Octet column[3] = {};  ///< 1/m times the units
  TwoGradients() = default;
  /// Of both.
  TwoGradients(const Gradient& first, const Gradient& second) {
    for (int K = 0; K < 3; ++K) column[K] = join(first.column[K], second.column[K]);
  }
};

/// sum ← sum + f ⊗ gradient, of one quantity or of two, with three numbers in memory.
template <class Sum, class F>
[[gnu::always_inline]] inline void add_outer(Sum& sum, const F& f, const PackedVector& gradient) {
  sum.column[0] += gradient[0] * f;
  sum.column[1] += gradient[1] * f;
  sum.column[2] += gradient[2] * f;
}
/// The same in single precision, of two.
[[gnu::always_inline]] inline void add_outer(TwoGradients& sum, const Octet& f, const float* gradient) {
  Quad G;
  widen(gradient, G);
  sum.column[0] += twice<0>(G) * f;
  sum.column[1] += twice<1>(G) * f;
  sum.column[2] += twice<2>(G) * f;
}
/// The same with one quantity at each of two particles, each with three numbers of its own.
[[gnu::always_inline]] inline void add_outer(TwoGradients& sum, const Octet& f, const Octet& gradients) {
  sum.column[0] += spread<0>(gradients) * f;
  sum.column[1] += spread<1>(gradients) * f;
  sum.column[2] += spread<2>(gradients) * f;
}
/// The same with two entries that follow each other.
[[gnu::always_inline]] inline void add_outer(TwoGradients& sum, const Octet& f, const SingleTableEntry* two) {
  Octet G;
  widen(two->gradient, G);
  add_outer(sum, f, G);
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
    add_outer(even, quad(f[a.particle].data()), a.gradient);
    add_outer(odd, quad(f[b.particle].data()), b.gradient);
  }
  for (int K = 0; K < 3; ++K) df.column[K] = even.column[K] + odd.column[K];
}

/// The same in single precision: two entries are widened at once.
inline void gather(std::span<const SingleTableEntry> row, const Vector4* f, Gradient& df) {
  const auto two = [&](std::size_t k) { return join(quad(f[row[k].particle].data()), quad(f[row[k + 1].particle].data())); };
  TwoGradients sum, other;
  std::size_t k = 0;
  for (; k + 4 <= row.size(); k += 4) {
    add_outer(sum, two(k), &row[k]);
    add_outer(other, two(k + 2), &row[k + 2]);
  }
  if (k < row.size()) add_outer(sum, two(k), &row[k]);  // rows are even
  for (int K = 0; K < 3; ++K) {
    const Octet column = sum.column[K] + other.column[K];
    df.column[K] = low(column) + high(column);
  }
}

/// ∂f/∂X of a field at a point of the table, the parts around an axis included; outside of the hot path.
[[nodiscard]] inline Tensor3 gradient_at(const PointTable& table, std::size_t q, const Field& f) {
  Gradient df;
  if (table.single_entries.empty()) gather(table.stored_row<TableEntry>(q), f.data(), df);
  else gather(table.stored_row<SingleTableEntry>(q), f.data(), df);
  if (table.axisymmetric) turn_around_axis(df);
  Tensor3 gradient;
  for (int K = 0; K < 3; ++K)
    for (int i = 0; i < 3; ++i) gradient(i, K) = df.column[K][i];
  return gradient;
}

/// The gradients of displacement and velocity in one sweep.
template <class Entry>
inline void gather(std::span<const Entry> row, const Motion* motion, Gradient& du, Gradient& dv) {
  TwoGradients even, odd;
  for (std::size_t k = 0; k < row.size(); k += 2) {
    add_outer(even, octet(motion[row[k].particle].displacement), row[k].gradient);
    add_outer(odd, octet(motion[row[k + 1].particle].displacement), row[k + 1].gradient);
  }
  for (int K = 0; K < 3; ++K) {
    const Octet column = even.column[K] + odd.column[K];
    du.column[K] = low(column);
    dv.column[K] = high(column);
  }
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

/// f = Σ_K flux_K G_K: what the stress columns V_q P_·K do to the particle of a pair; of one flux or of two.
template <class Flux, class F>
[[gnu::always_inline]] inline void contract(const Flux& flux, const PackedVector& gradient, F& f) {
  f = gradient[0] * flux.column[0] + gradient[1] * flux.column[1] + gradient[2] * flux.column[2];
}
/// The same in single precision, of two.
[[gnu::always_inline]] inline void contract(const TwoGradients& flux, const float* gradient, Octet& f) {
  Quad G;
  widen(gradient, G);
  f = twice<0>(G) * flux.column[0] + twice<1>(G) * flux.column[1] + twice<2>(G) * flux.column[2];
}
/// The same for two entries that follow each other and one flux, which comes twice.
[[gnu::always_inline]] inline void contract(const TwoGradients& flux, const SingleTableEntry* two, Octet& f) {
  Octet G;
  widen(two->gradient, G);
  f = spread<0>(G) * flux.column[0] + spread<1>(G) * flux.column[1] + spread<2>(G) * flux.column[2];
}

/// f_I ← f_I − Σ_K flux_K G_qI,K, and − held for the first pairs, which have a force of their own.
inline void scatter(std::span<const TableEntry> row, const Gradient& flux, std::span<const Quad> held, Vector4* f) {
  const Gradient local = flux;  // what a store to a force may have changed, a compiler must load anew
  const auto subtract = [&](const TableEntry& entry, const auto&... own) {
    Quad force;
    contract(local, entry.gradient, force);
    quad(f[entry.particle].data()) -= (force + ... + own);
  };
  for (std::size_t k = 0; k < held.size(); ++k) subtract(row[k], held[k]);
  for (std::size_t k = held.size(); k < row.size(); ++k) subtract(row[k]);
}

/// The same in single precision: two entries at once. `held` has an even length.
inline void scatter(std::span<const SingleTableEntry> row, const Gradient& flux, std::span<const Quad> held, Vector4* f) {
  const TwoGradients local(flux, flux);
  const auto subtract = [&](const SingleTableEntry* two, const auto&... own) {
    Octet force;
    contract(local, two, force);
    force = (force + ... + own);
    quad(f[two[0].particle].data()) -= low(force);  // one after the other: the two may be the same particle
    quad(f[two[1].particle].data()) -= high(force);
  };
  for (std::size_t k = 0; k < held.size(); k += 2) subtract(&row[k], join(held[k], held[k + 1]));
  for (std::size_t k = held.size(); k < row.size(); k += 2) subtract(&row[k]);
}

/// The same, and the flux of the director in the same sweep.
template <class Entry>
inline void scatter(std::span<const Entry> row, const Gradient& flux, std::span<const Quad> held, Vector4* f,
                    const Gradient& director_flux, Vector4* h) {
  const TwoGradients local(flux, director_flux);
  const auto subtract = [&](const Entry& entry, const auto&... own) {
    Octet both;
    contract(local, entry.gradient, both);
    quad(f[entry.particle].data()) -= (low(both) + ... + own);
    quad(h[entry.particle].data()) -= high(both);
  };
  for (std::size_t k = 0; k < held.size(); ++k) subtract(row[k], held[k]);
  for (std::size_t k = held.size(); k < row.size(); ++k) subtract(row[k]);
}

/// Asks for what will be needed soon, so that it comes from memory while something else is computed.
template <class T>
void prefetch(const T* begin, std::size_t count) {
  const char* line = reinterpret_cast<const char*>(begin);
  for (std::size_t k = 0; k < count * sizeof(T); k += 64) __builtin_prefetch(line + k);
}

/// Energy and dissipated power of the stabilisation of one point.
struct StabilizationPower {
  double energy = 0.0;      ///< ½ κ Σ_J w_J |r_J|², J
  double dissipated = 0.0;  ///< κ τ Σ_J w_J |ṙ_J|², W
};

/// A point whose pairs are stabilised.
template <class Entry>
struct StabilizedPoint {
  std::span<const Entry> row;      ///< its pairs
  std::span<const float> weights;  ///< w_J, of the first entries of the row
  Index owner;                     ///< I
  double kappa;                    ///< κ, N/m
  double tau;                      ///< τ, s
};

/// The stabilising energy of a point q with the owner I (NodalCentroids), its exact variation and its damping:
///   r_J = u_J − u_I − H ΔX_J,  H = F_q − 1,   energy ½ κ Σ_J w_J |r_J|²,   force from κ w_J (r_J + τ ṙ_J).
/// Writes the force of each of these pairs to `held`, adds the owner's to f, and subtracts from `flux` the part that acts
/// through F_q. `periodic` directions take the nearest images. Without them r_J = (u_J − H X_J) − (u_I − H X_I), which saves
/// the differences of positions. r_J and ṙ_J are one vector.
template <bool Periodic, bool Rate, class Entry>
StabilizationPower stabilize(const StabilizedPoint<Entry>& point, const Vector3& period, const Vector4* X, const MotionOf<Rate>* motion,
                             const Gradient& du, const Gradient& dv, Quad* held, Vector4* f, Gradient& flux) {
  using Deviation = std::conditional_t<Rate, Octet, Quad>;
  const Vector4 XI = X[point.owner];
  Deviation H[3], origin = in_vector(motion[point.owner]);
  for (int K = 0; K < 3; ++K) {
    if constexpr (Rate) H[K] = join(du.column[K], dv.column[K]);
    else H[K] = du.column[K];
    if constexpr (!Periodic) origin -= XI[K] * H[K];
  }
  Deviation work = {};
  Quad sum = {};
  Gradient moments;
  for (std::size_t k = 0; k < point.weights.size(); ++k) {
    const Index J = point.row[k].particle;
    const double weight = point.kappa * static_cast<double>(point.weights[k]);
    const Vector4* x = &X[J];
    Vector4 nearest;
    if constexpr (Periodic) {
      nearest = X[J] - XI;
      for (int K = 0; K < 3; ++K)
        if (period[K] > 0.0) nearest[K] -= period[K] * std::round(nearest[K] / period[K]);
      x = &nearest;
    }
    const Deviation r = in_vector(motion[J]) - origin - (*x)[0] * H[0] - (*x)[1] * H[1] - (*x)[2] * H[2];
    const Deviation weighted = weight * r;
    work += weighted * r;
    Quad force;
    if constexpr (Rate) force = low(weighted) + point.tau * high(weighted);
    else force = weighted;
    held[k] = force;
    sum += force;
    for (int K = 0; K < 3; ++K) moments.column[K] += (*x)[K] * force;
  }
  quad(f[point.owner].data()) += sum;
  for (int K = 0; K < 3; ++K) {
    flux.column[K] -= moments.column[K];
    if constexpr (!Periodic) flux.column[K] += XI[K] * sum;
  }
  Quad stored, lost = {};
  if constexpr (Rate) stored = low(work), lost = high(work);
  else stored = work;
  return {0.5 * (stored[0] + stored[1] + stored[2]), point.tau * (lost[0] + lost[1] + lost[2])};
}

}  // namespace tactoid::rows
