#pragma once

#include <array>
#include <memory>
#include <vector>

#include <Eigen/SparseCore>

#include <tactoid/boundary/prescribed_motion.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/quadrature/particle_values.hpp>
#include <tactoid/quadrature/row_share.hpp>

namespace tactoid {

/// All essential conditions of one body, enforced on the interpolated field to round-off.
///
/// Where the unknowns are values, the conditions are set directly. Where they are coefficients, the rows
/// N u = ū of shape functions at the prescribed particles are met by the correction of least kinetic energy,
///   Δu = M⁻¹ Nᵀ λ,   (N M⁻¹ Nᵀ) λ = ū − N u,
/// which is what multipliers do in a dynamic step. The velocity of the step changes by Δu/Δt, so the reaction at the
/// particles is λ/(Δt τ), where τ = (Δt₋ + Δt)/2 is the time between the middles of this step and the one before.
class EssentialConditions {
 public:
  EssentialConditions() = default;

  /// Throws ParameterError when a particle does not exist or a component of it is prescribed twice.
  EssentialConditions(std::vector<PrescribedMotion> motions, const ParticleValues& values, const Field& reference,
                      const std::vector<double>& masses);

  [[nodiscard]] bool empty() const { return motions_.empty(); }  ///< nothing is prescribed

  /// Corrects u so that the conditions hold at `time`, and the velocity of the step that led there. `time_step`
  /// is that step (0: an initial state, where no velocity is changed) and `step_before` the one before it (0 in the
  /// first). Returns the work of the conditions on the body up to now, less what was returned before, J. Where several processes have the conditions of their own particles, `share` adds up
  /// the work and the reactions.
  double impose(double time, double time_step, double step_before, Field& displacement, Field& velocity, RowShare* share = nullptr);

  /// Sets prescribed values at `time` in a field of displacements; for unknowns that are values at the particles.
  void prescribe(double time, Field& displacement) const {
    for_each_value([&](int c, std::size_t, const Condition& condition) { displacement[condition.particle][c] = prescribed(condition, time)[c]; });
  }

  /// Takes the forces that hold the prescribed values (N per particle) as those of the conditions at `time`, the end of a
  /// step. Returns their work over the step, by the mean of the forces at its ends, J; with `from_rest`, where none is known at the
  /// start, by that at the end. For unknowns that are values.
  double accept(double time, double time_step, const Field& holding, bool from_rest);

  /// The unknowns are values at the particles, so that conditions are set directly.
  [[nodiscard]] bool on_values() const { return identity_; }

  /// Forces of all conditions on the unknowns in the last step, N; empty without conditions.
  [[nodiscard]] const Field& forces() const { return forces_; }
  /// Force of the constraint m on the body in the last step, N.
  [[nodiscard]] const Vector3& reaction(std::size_t m) const { return reactions_[m]; }
  /// In the order in which reactions are numbered.
  [[nodiscard]] const std::vector<PrescribedMotion>& motions() const { return motions_; }

  /// For checkpoints: the forces, and what the work of the next step begins with. Of a body with a part of a cloud (null: the whole) those of the particles in `rows`; `share` is null where
  /// one process has all of them. Collective.
  template <class Archive>
  void state(Archive& archive, const StateRows* rows, const CloudPart* part, RowShare* share) {
    archive("forces", forces_, rows);
    archive("reactions", reactions_);
    for (int c = 0; c < 3; ++c) {
      const StateRows of_conditions = part != nullptr ? condition_rows(c, *part, share) : StateRows();
      auto& last = directions_[static_cast<std::size_t>(c)].last;
      std::vector<Vector4> flat(last.size());
      for (std::size_t k = 0; k < last.size(); ++k) flat[k] = {last[k].value, last[k].rate, last[k].ahead, last[k].force};
      if (part == nullptr || of_conditions.length > 0) archive(c == 0 ? "last_x" : c == 1 ? "last_y" : "last_z", flat, part != nullptr ? &of_conditions : nullptr);
      if constexpr (Archive::restoring)
        for (std::size_t k = 0; k < last.size(); ++k) last[k] = {flat[k][0], flat[k][1], flat[k][2], flat[k][3]};
    }
  }

  /// A component of a particle that is prescribed.
  struct Condition {
    Index particle;      ///< number of the particle
    std::size_t motion;  ///< number of the motion that it follows
    Vector3 place;       ///< X of the particle in the first configuration, m
  };
  /// The prescribed particles of a component.
  [[nodiscard]] const std::vector<Condition>& conditions(int component) const {
    return directions_[static_cast<std::size_t>(component)].conditions;
  }

 private:
  struct Solver;  // of N M⁻¹ Nᵀ
  struct Direction {
    std::vector<Condition> conditions;
    Eigen::SparseMatrix<double, Eigen::RowMajor> rows;  // N
    std::shared_ptr<Solver> solver;
    /// What the next step needs of the last one.
    struct Last {
      double value = 0.0;  ///< prescribed value, m
      double rate = 0.0;   ///< its rate in the step, m/s
      double ahead = 0.0;  ///< work taken in advance, J
      double force = 0.0;  ///< of the condition, N
    };
    std::vector<Last> last;  // of each condition, from the last step

    [[nodiscard]] double interpolate(std::size_t k, const Field& u, int c) const;
  };

  /// Calls f(component, number, condition) for all conditions.
  template <class F>
  void for_each_value(const F& f) const {
    for (int c = 0; c < 3; ++c) {
      const auto& conditions = directions_[static_cast<std::size_t>(c)].conditions;
      for (std::size_t k = 0; k < conditions.size(); ++k) f(c, k, conditions[k]);
    }
  }
  [[nodiscard]] Vector3 prescribed(const Condition& condition, double time) const {
    return motions_[condition.motion].value(condition.place, time);
  }

  void factorize(Direction& direction, const ParticleValues& values) const;
  /// The conditions of a component among those of all processes: by motion, and number of the particle.
  [[nodiscard]] StateRows condition_rows(int c, const CloudPart& part, RowShare* share) const;

  std::vector<PrescribedMotion> motions_;
  const std::vector<double>* masses_ = nullptr;
  bool identity_ = true;
  std::array<Direction, 3> directions_;
  std::vector<Vector3> reactions_;
  Field forces_;
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/boundary/essential_conditions.ipp>
#endif
