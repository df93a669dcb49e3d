#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include <tactoid/core/tensor.hpp>
#include <tactoid/quadrature/point_table.hpp>
#include <tactoid/simulation/body.hpp>

namespace tactoid {

/// The largest stable step of a body. At the first state, Lanczos iterations find
///   - the largest squared wave number of each region's rows alone, from the scalar operator M⁻¹ Σ_q V_q ρ G_q G_qᵀ,
///   - the highest frequency of the body, from its internal forces, and the fastest decay of its viscous ones.
/// They calibrate bounds per point, ω_q² ∝ c² k_q² ‖F_q⁻¹‖² and d_q ∝ ν k_q² ‖F_q⁻¹‖² (viscosity, and damping of the
/// stabilisation), which follow the deformation at no cost. Since forces see the velocity half a step late, the step is
/// stable for ω² Δt² + 2 d Δt <= 4.
class StableStep {
 public:
  /// Measures a body at its first state. Its displacement and velocity are as before afterwards; costs some hundred
  /// evaluations of the forces at most.
  template <class Body>
  void calibrate(Body& body) {
    const Field present = body.displacement;
    body.displacement = body.displacement_of_table();
    const std::vector<double> reference = wave_numbers(body);
    ratio_.assign(reference.size(), 1.0);
    body.for_each_region([&](const auto& region, Index r) {
      if (reference[r] > 0.0) ratio_[r] = largest_wave_number(body, region, r) / reference[r];
    });
    body.displacement = present;
    const std::vector<double> waves = wave_numbers(body);
    double elastic = 0.0, viscous = 0.0;  // ω² and d of the regions, as the wave numbers have it
    body.for_each_region([&](const auto& region, Index r) {
      elastic = std::max(elastic, region.wave_speed_squared * ratio_[r] * waves[r]);
      viscous = std::max(viscous, diffusivity(region) * ratio_[r] * waves[r]);
    });
    const double frequency_squared = largest_eigenvalue(body, body.displacement, 1.0);
    elastic_ = elastic > 0.0 ? frequency_squared / elastic : 1.0;
    viscous_ = 1.0;
    // Velocities are tried at the size that the tried displacements have at the highest frequency.
    if (viscous > 0.0 && frequency_squared > 0.0)
      viscous_ = largest_eigenvalue(body, body.velocity, std::sqrt(frequency_squared)) / viscous;
  }

  /// For checkpoints: what was measured, at the configuration that is the reference.
  template <class Archive>
  void state(Archive& archive) {
    archive("ratio", ratio_);
    archive("elastic", elastic_);
    archive("viscous", viscous_);
  }

  /// Largest stable step at the present state; `term_rate` is ω² of what acts on the body's particles, 1/s².
  template <class Body>
  [[nodiscard]] double largest_step(const Body& body, double term_rate) const {
    const std::vector<double>& waves = body.region_wave_numbers();
    double step = std::numeric_limits<double>::infinity();
    body.for_each_region([&](const auto& region, Index r) {
      const double k2 = ratio_[r] * waves[r];
      const double omega2 = elastic_ * region.wave_speed_squared * k2 + term_rate;
      const double damping = viscous_ * diffusivity(region) * k2;
      if (omega2 > 0.0) step = std::min(step, (std::sqrt(damping * damping + 4.0 * omega2) - damping) / omega2);
    });
    if constexpr (Body::has_director) {
      // Explicit diffusion and penalty of the director, whose strength goes with the volume ratio: D J (k² + 2/ε_d²) Δt <= 2.
      double k2 = 0.0;
      for (std::size_t r = 0; r < waves.size(); ++r) k2 = std::max(k2, ratio_[r] * waves[r]);
      const auto& law = body.director_law();
      step = std::min(step, 2.0 / (law.diffusivity * body.largest_volume_ratio() * (k2 + 2.0 / (law.core_size * law.core_size))));
    }
    return step;
  }

 private:
  /// Of velocities, by viscosity and by the damping of the stabilisation, m²/s.
  template <class Region>
  [[nodiscard]] static double diffusivity(const Region& region) {
    const Stabilization& s = region.stabilization;
    return region.kinematic_viscosity + 2.0 * s.modulus * s.damping_time / region.least_density;
  }

  /// Of the points of each region alone, at the present displacement, 1/m².
  template <class Body>
  [[nodiscard]] static std::vector<double> wave_numbers(Body& body) {
    body.force.assign(body.size(), Vector4::Zero());
    body.add_internal_forces(0.0, false);
    return body.region_wave_numbers();
  }

  /// The operator of an eigenvalue problem K x = λ M x on so many numbers of each particle, of a body that one process has or several.
  struct Operator {
    std::size_t per_particle = 1;
    const std::vector<double>& masses;                                                ///< M, kg
    std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& y)> multiply;  ///< y = K x, at the particles of this process
  };
  /// Whose particles they are, and which.
  struct Particles {
    BodyShare* share = nullptr;       ///< null where this process has all of them
    const CloudPart* part = nullptr;  ///< which has their numbers in the whole cloud; null: they are those
    [[nodiscard]] std::size_t number(std::size_t i) const { return part != nullptr ? part->number[i] : i; }
  };

  /// Largest eigenvalue of M⁻¹ K with K symmetric, by Lanczos' method in the inner product of M. Power iterations settle long
  /// before they arrive where the highest modes lie close together: steps of a viscous gel, taken at their result, were
  /// unstable. The rest of the error is covered by 2 %.
  [[nodiscard]] static double largest_eigenvalue(const Operator& of, const Particles& particles);

  /// Largest eigenvalue of M⁻¹ Σ_q m_q G_q G_qᵀ over the points of region r, with their masses m_q (kg), in the configuration of
  /// the table; 1/m².
  [[nodiscard]] static double largest_wave_number(const PointTable& table, const std::vector<double>& masses,
                                                  const std::vector<double>& point_masses, Index r, const Particles& particles);

  /// Largest eigenvalue of the derivative of −M⁻¹ f in `field`, which the forces depend on, from differences of them: of `size` (in
  /// the unit of the field) at most in each of the first D components.
  [[nodiscard]] static double largest_eigenvalue(int D, const std::vector<double>& masses, Field& field, double size,
                                                 const std::function<const Field&()>& internal_forces, const Particles& particles);

  template <class Body>
  [[nodiscard]] static Particles particles(const Body& body) { return {body.share(), body.cloud().part.get()}; }

  template <class Body, class Region>
  [[nodiscard]] static double largest_wave_number(const Body& body, const Region& region, Index r) {
    std::vector<double> point_masses(body.table().points(), 0.0);
    for (std::size_t q = region.begin; q < region.end; ++q) point_masses[q] = body.point_volume(q) * region.law(q).density;
    return largest_wave_number(body.table(), body.masses(), point_masses, r, particles(body));
  }

  /// Largest eigenvalue of the derivative of −M⁻¹ f in `field`, which is the body's displacement (1/s²) or velocity
  /// (1/s), at the present displacement and no velocity. The difference in `field` is 1e-6 of the smallest spacing times
  /// `rate`.
  template <class Body>
  [[nodiscard]] static double largest_eigenvalue(Body& body, Field& field, double rate) {
    constexpr int D = Body::dimension;
    const Field displacement = body.displacement, velocity = body.velocity;
    std::fill(body.velocity.begin(), body.velocity.end(), Vector4::Zero());
    double length = std::numeric_limits<double>::infinity();
    for (std::size_t q = 0; q < body.table().points(); ++q) {
      const Point<D> X = body.table().position[q].template head<D>();
      length = std::min(length, std::pow(body.table().volume[q] / body.cloud().circumference(X), 1.0 / D));
    }
    if (body.share() != nullptr) length = -body.share()->largest(-length);
    const double eigenvalue = largest_eigenvalue(D, body.masses(), field, 1e-6 * length * rate, [&]() -> const Field& {
      std::fill(body.force.begin(), body.force.end(), Vector4::Zero());
      body.add_internal_forces(0.0, false);
      return body.force;
    }, particles(body));
    body.displacement = displacement;
    body.velocity = velocity;
    (void)wave_numbers(body);  // which the body remembers
    return eigenvalue;
  }

  std::vector<double> ratio_;             // per region: largest k² of the body over the largest of a point alone
  double elastic_ = 1.0, viscous_ = 1.0;  // measured over c² k² and over ν k²
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/simulation/stable_step.ipp>
#endif
