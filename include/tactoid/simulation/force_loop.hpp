#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include <tactoid/core/compiled.hpp>
#include <tactoid/core/lanes.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/director/all.hpp>
#include <tactoid/kinematics/kinematics.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/point_table.hpp>
#include <tactoid/simulation/earlier_configuration.hpp>
#include <tactoid/simulation/region_laws.hpp>
#include <tactoid/simulation/row_operations.hpp>

namespace tactoid {

/// A body without a director field.
struct NoDirector {
  void validate() const {}  ///< nothing can be wrong
};

/// Energies and powers of a body at one instant, in J and W.
struct BodyTotals {
  double strain_energy = 0.0;         ///< of the laws
  double stabilization_energy = 0.0;  ///< of the quadrature's stabilisation
  double dissipated_power = 0.0;      ///< of the laws, and of the damping of the stabilisation
  double active_power = 0.0;          ///< given to the motion by stresses without an energy
  /// Sums of the parts: chunks of one body, or several bodies.
  BodyTotals& operator+=(const BodyTotals& other) {
    strain_energy += other.strain_energy;
    stabilization_energy += other.stabilization_energy;
    dissipated_power += other.dissipated_power;
    active_power += other.active_power;
    return *this;
  }
};

/// What the force loop found in a chunk.
struct ChunkResult {
  BodyTotals totals;                                               ///< of its points
  double stretch = 0.0;                                            ///< max_q k_q² ‖F_q⁻¹‖², 1/m²
  double largest_volume_ratio = 0.0;                               ///< max_q J_q, where a director sees it
  std::size_t failure = std::numeric_limits<std::size_t>::max();   ///< first point whose volume ratio is not positive, or is NaN
};

/// The loop over the quadrature points of a body, block by block: gather, law, scatter. It refers to what it reads and writes of its
/// body and knows nothing else of that: so it is the same for all bodies that have a law in common. D is the dimension, Director the
/// law of the director or NoDirector, Entry what the table keeps of a pair.
template <int D, class Director, class Entry>
struct ForceLoop {
  static constexpr bool has_director = !std::is_same_v<Director, NoDirector>;  ///< a director field is carried along
  /// The laws of Region are always given rates, whatever the stabilisation.
  template <class Region>
  static constexpr bool always_with_rates = has_director || uses_rate<typename Region::Law>;

  const PointTable& table;              ///< of the body
  const EarlierConfiguration& earlier;  ///< before the reference was updated
  const Vector4* displacement;          ///< of the particles since the configuration of the table, m
  const rows::Motion* motion;           ///< the same and the velocity, where a region needs rates
  const Vector4* director;              ///< h_I; null without a director field
  const char* evaluated;                ///< per point: 1 where this process evaluates it; null: everywhere
  const double* point_scale;            ///< k_q², 1/m²
  std::size_t longest_row;              ///< of the table, entries
  double velocity_lag;                  ///< of the velocity behind the displacement, steps
  Vector4* force;                       ///< on the particles, N; is added to
  Vector4* director_flux;               ///< is added to; null without a director field
  Tensor3* point_rate;                  ///< operator A of the director at each point
  double* point_volume_ratio;           ///< J at each point

  /// One chunk of one region. With `advance` the histories advanced by `time_step` are kept beside the present ones.
  template <bool Rate, class Region>
  ChunkResult pass(Region& region, const PointChunk& chunk, double time_step, bool advance) const;

  /// Stress and volume ratio at the points of a region, without advancing any history; needs `motion`.
  template <class Region>
  void sample(const Region& region, std::vector<PointSample>& samples) const;

 private:
  /// Gradients of the fields at the points of a block, which has as many as a law has lanes.
  template <int W>
  struct BlockGradients {
    rows::Gradient motion[W], rate[W], director[W];
  };

  /// The gradients at points [begin, end).
  template <bool Rate, int W>
  void gather_block(std::size_t begin, std::size_t end, BlockGradients<W>& g) const {
    for (std::size_t q = begin; q < end; ++q) {
      const std::size_t l = q - begin;
      const auto row = table.template stored_row<Entry>(q);
      if constexpr (Rate) rows::gather(row, motion, g.motion[l], g.rate[l]);
      else rows::gather(row, displacement, g.motion[l]);
      if constexpr (has_director) rows::gather(row, director, g.director[l]);
      if constexpr (D == 2)
        if (table.axisymmetric) {
          rows::turn_around_axis(g.motion[l]);
          rows::turn_around_axis(g.rate[l]);
          rows::turn_around_axis(g.director[l]);
        }
    }
  }

  /// Asks for the positions that the stabilisation of a block needs, which no other sweep reads: one sweep before it waits for them.
  void prefetch_positions(std::size_t begin, std::size_t end) const {
    for (std::size_t q = begin; q < end; ++q) {
      const auto row = table.template stored_row<Entry>(q).first(table.bonds(q).size());
      for (const Entry& entry : row) rows::prefetch(&table.particle_position[entry.particle], 1);
    }
  }

  /// What the laws are told about a block. Lanes beyond its last point are at rest.
  template <bool Rate, class T, int W>
  [[nodiscard]] PointState<T> block_state(std::size_t begin, std::size_t end, const BlockGradients<W>& g) const {
    PointState<T> state;
    rows::to_lanes(g.motion, state.deformation_gradient);
    for (int i = 0; i < 3; ++i) state.deformation_gradient(i, i) += T(1.0);
    if constexpr (Rate) rows::to_lanes(g.rate, state.deformation_rate);
    if constexpr (has_director) {
      rows::to_lanes(g.director, state.director_gradient);
      for (std::size_t q = begin; q < end; ++q)
        for (int i = 0; i < 3; ++i) set_lane(state.director(i), static_cast<int>(q - begin), director[table.owner[q]][i]);
    }
    return state;
  }

  /// F₀ at the points of a block; lanes beyond its last point are at rest.
  template <class T>
  [[nodiscard]] Tensor<T> earlier_gradients(std::size_t begin, std::size_t end) const {
    Tensor<T> F = Tensor<T>::Identity();
    for (std::size_t q = begin; q < end; ++q)
      for (int a = 0; a < 9; ++a) set_lane(F(a % 3, a / 3), static_cast<int>(q - begin), earlier.gradient[q](a % 3, a / 3));
    return F;
  }

  /// Whether other processes evaluate these points, and this one need not.
  [[nodiscard]] bool is_elsewhere(std::size_t begin, std::size_t end) const {
    return evaluated != nullptr && std::none_of(evaluated + begin, evaluated + end, [](char here) { return here != 0; });
  }

  template <bool Rate>
  rows::StabilizationPower stabilize(const rows::StabilizedPoint<Entry>& point, const rows::Gradient& du, const rows::Gradient& dv,
                                     Quad* held, rows::Gradient& flux) const {
    const Vector4* X = table.particle_position.data();
    const rows::MotionOf<Rate>* moving;
    if constexpr (Rate) moving = motion;
    else moving = displacement;
    if (table.period.any()) return rows::stabilize<true, Rate>(point, table.period, X, moving, du, dv, held, force, flux);
    return rows::stabilize<false, Rate>(point, table.period, X, moving, du, dv, held, force, flux);
  }

  /// Components beyond the dimension are no unknowns, whatever the stress; but the stretch around an axis is u_R/R.
  void restrict_to_dimension([[maybe_unused]] rows::Gradient& flux) const {
    if constexpr (D < 3) {
      const double around = table.axisymmetric ? flux.column[2][2] : 0.0;
      for (int K = 0; K < 3; ++K)
        for (int i = 0; i < 3; ++i)
          if (i >= D || K >= D) flux.column[K][i] = 0.0;
      flux.column[2][0] = around;
    }
  }
};

template <int D, class Director, class Entry>
template <bool Rate, class Region>
ChunkResult ForceLoop<D, Director, Entry>::pass(Region& region, const PointChunk& chunk, double time_step, bool advance) const {
  using T = typename Region::Scalar;
  constexpr std::size_t W = Region::width;
  const double kappa = table.stabilization_scale.empty() ? 0.0 : region.stabilization.modulus;
  const double tau = region.stabilization.damping_time;
  const bool stabilized = kappa > 0.0;
  thread_local std::vector<Quad> held;  // forces of the pairs of a row, one row after the other, until they are scattered
  held.resize(std::max(held.size(), W * longest_row));
  ChunkResult result;
  BodyTotals totals;
  double stretch = 0.0;
  for (std::size_t first = chunk.begin; first < chunk.end; first += W) {
    const std::size_t last = std::min(chunk.end, first + W);
    if (is_elsewhere(first, last)) continue;
    if (stabilized) prefetch_positions(first, last);
    BlockGradients<W> gradients;
    gather_block<Rate>(first, last, gradients);
    PointState<T> state = block_state<Rate, T>(first, last, gradients);
    state.time_step = time_step;
    auto history = region.histories[region.block(first)];
    Tensor<T> before;
    const bool updated = !earlier.empty();
    if (updated) {
      before = earlier_gradients<T>(first, last);
      refer_to_first(state, before);
    }
    Response<T> response = respond(region.law(first), state, history);
    if (updated) {
      response.stress = (response.stress * before.transpose()).eval();
      state = block_state<Rate, T>(first, last, gradients);
    }
    const Inversion<T> F = invert(state.deformation_gradient);
    if (advance) region.advanced[region.block(first)] = history;
    if constexpr (history_size<typename Region::Law> > 0)
      if (last < chunk.end) {
        rows::prefetch(&region.histories[region.block(last)], 1);
        if (advance) rows::prefetch(&region.advanced[region.block(last)], 1);
      }
    const Tensor<T> inverse_C = F.inverse * F.inverse.transpose();
    const T bound = largest_eigenvalue_bound<T>(inverse_C);

    double volume[W] = {}, volume_in_table[W] = {};
    for (std::size_t q = first; q < last; ++q) {
      volume_in_table[q - first] = table.volume[q];
      volume[q - first] = updated ? earlier.volume[q] : table.volume[q];
    }
    rows::Gradient flux[W], flux_h[W];
    rows::to_points(response.stress, volume, flux);
    if constexpr (has_director) {
      const Tensor<T> middle = state.deformation_gradient - state.deformation_rate * T(velocity_lag * time_step);
      const Tensor<T> A = Director::rate_operator(velocity_gradient(state.deformation_rate, inverse(middle)));
      const Tensor<T> diffusion = state.director_gradient * inverse_C * F.determinant;
      rows::to_points(diffusion, volume_in_table, flux_h);
      for (std::size_t q = first; q < last; ++q) {
        for (int a = 0; a < 9; ++a) point_rate[q](a % 3, a / 3) = lane(A(a % 3, a / 3), int(q - first));
        point_volume_ratio[q] = lane(F.determinant, int(q - first)) * (volume_in_table[q - first] / volume[q - first]);
        result.largest_volume_ratio = std::max(result.largest_volume_ratio, point_volume_ratio[q]);
      }
    }
    for (std::size_t q = first; q < last; ++q) {
      const int l = static_cast<int>(q - first);
      const double V = volume[l], J = lane(F.determinant, l);
      if (!(J > 0.0) || !std::isfinite(J)) result.failure = std::min(result.failure, q);
      stretch = std::max(stretch, point_scale[q] * lane(bound, l));
      totals.strain_energy += V * lane(response.energy, l);
      totals.dissipated_power += V * lane(response.dissipated_power, l);
      totals.active_power += V * lane(response.active_power, l);
      restrict_to_dimension(flux[l]);
      if constexpr (has_director && D == 2)
        if (table.axisymmetric) rows::turn_back(flux_h[l]);
    }
    // All rows are stabilised before the first is scattered: they do not wait for each other.
    for (std::size_t q = first; stabilized && q < last; ++q) {
      const std::size_t l = q - first;
      const rows::StabilizedPoint<Entry> point{table.template stored_row<Entry>(q), table.bonds(q), table.owner[q], kappa * table.stabilization_scale[q], tau};
      const auto power = stabilize<Rate>(point, gradients.motion[l], gradients.rate[l], held.data() + l * longest_row, flux[l]);
      totals.stabilization_energy += power.energy;
      totals.dissipated_power += power.dissipated;
    }
    for (std::size_t q = first; q < last; ++q) {
      const std::size_t l = q - first;
      if (q + W < chunk.end) {
        const auto next = table.template stored_row<Entry>(q + W);
        rows::prefetch(next.data(), next.size());
      }
      const auto forces_of_bonds = std::span<const Quad>(held).subspan(l * longest_row, stabilized ? table.bonds(q).size() : 0);
      const auto row = table.template stored_row<Entry>(q);
      if constexpr (has_director) rows::scatter(row, flux[l], forces_of_bonds, force, flux_h[l], director_flux);
      else rows::scatter(row, flux[l], forces_of_bonds, force);
    }
  }
  result.totals = totals;
  result.stretch = stretch;
  return result;
}

template <int D, class Director, class Entry>
template <class Region>
void ForceLoop<D, Director, Entry>::sample(const Region& region, std::vector<PointSample>& samples) const {
  using T = typename Region::Scalar;
  constexpr std::size_t W = Region::width;
  parallel_for(region.end - region.begin, [&](std::size_t i) {
    const std::size_t first = region.begin + i;
    if (i % W != 0) return;
    const std::size_t last = std::min(region.end, first + W);
    if (is_elsewhere(first, last)) return;
    BlockGradients<W> gradients;
    gather_block<true>(first, last, gradients);
    auto state = block_state<true, T>(first, last, gradients);
    if (!earlier.empty()) refer_to_first(state, earlier_gradients<T>(first, last));
    auto history = region.histories[region.block(first)];
    state.time_step = 0.0;
    const Response<T> response = respond(region.law(first), state, history);
    for (std::size_t q = first; q < last; ++q) {
      const int l = static_cast<int>(q - first);
      Tensor3 F, P;
      for (int a = 0; a < 9; ++a) {
        F(a % 3, a / 3) = lane(state.deformation_gradient(a % 3, a / 3), l);
        P(a % 3, a / 3) = lane(response.stress(a % 3, a / 3), l);
      }
      samples[q] = {cauchy_from_piola(P, F), determinant(F)};
    }
  });
}

#if defined(TACTOID_COMPILED)
extern template ChunkResult ForceLoop<2, NoDirector, TableEntry>::pass<true>(RegionLaw<NeoHookean>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<2, NoDirector, TableEntry>::pass<false>(RegionLaw<NeoHookean>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<2, NoDirector, TableEntry>::pass<true>(RegionLaw<ModifiedMooneyRivlin>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<2, NoDirector, TableEntry>::pass<false>(RegionLaw<ModifiedMooneyRivlin>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<2, NoDirector, TableEntry>::pass<true>(RegionLaw<YangVisco<>>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<2, DirectorField<>, TableEntry>::pass<true>(RegionLaw<ModifiedMooneyRivlin>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<2, DirectorField<>, TableEntry>::pass<true>(RegionLaw<NematicGel<>>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<3, NoDirector, TableEntry>::pass<true>(RegionLaw<NeoHookean>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<3, NoDirector, TableEntry>::pass<false>(RegionLaw<NeoHookean>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<3, NoDirector, TableEntry>::pass<true>(RegionLaw<ModifiedMooneyRivlin>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<3, NoDirector, TableEntry>::pass<false>(RegionLaw<ModifiedMooneyRivlin>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<3, NoDirector, TableEntry>::pass<true>(RegionLaw<YangVisco<>>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<3, DirectorField<>, TableEntry>::pass<true>(RegionLaw<ModifiedMooneyRivlin>&, const PointChunk&, double, bool) const;
extern template ChunkResult ForceLoop<3, DirectorField<>, TableEntry>::pass<true>(RegionLaw<NematicGel<>>&, const PointChunk&, double, bool) const;
extern template void ForceLoop<2, NoDirector, TableEntry>::sample(const RegionLaw<NeoHookean>&, std::vector<PointSample>&) const;
extern template void ForceLoop<2, NoDirector, TableEntry>::sample(const RegionLaw<ModifiedMooneyRivlin>&, std::vector<PointSample>&) const;
extern template void ForceLoop<2, NoDirector, TableEntry>::sample(const RegionLaw<YangVisco<>>&, std::vector<PointSample>&) const;
extern template void ForceLoop<2, DirectorField<>, TableEntry>::sample(const RegionLaw<ModifiedMooneyRivlin>&, std::vector<PointSample>&) const;
extern template void ForceLoop<2, DirectorField<>, TableEntry>::sample(const RegionLaw<NematicGel<>>&, std::vector<PointSample>&) const;
extern template void ForceLoop<3, NoDirector, TableEntry>::sample(const RegionLaw<NeoHookean>&, std::vector<PointSample>&) const;
extern template void ForceLoop<3, NoDirector, TableEntry>::sample(const RegionLaw<ModifiedMooneyRivlin>&, std::vector<PointSample>&) const;
extern template void ForceLoop<3, NoDirector, TableEntry>::sample(const RegionLaw<YangVisco<>>&, std::vector<PointSample>&) const;
extern template void ForceLoop<3, DirectorField<>, TableEntry>::sample(const RegionLaw<ModifiedMooneyRivlin>&, std::vector<PointSample>&) const;
extern template void ForceLoop<3, DirectorField<>, TableEntry>::sample(const RegionLaw<NematicGel<>>&, std::vector<PointSample>&) const;
#endif

}  // namespace tactoid
