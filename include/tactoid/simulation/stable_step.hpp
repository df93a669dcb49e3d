#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <tactoid/core/tensor.hpp>
#include <tactoid/simulation/body.hpp>

namespace tactoid {

/// The largest stable step of a body. The highest frequency of the discrete body at its first state is found by
/// power iteration on the internal forces; it calibrates a bound per point, ω_q² = r c² k_q² ‖F_q⁻¹‖², which follows
/// the deformation at no cost. For a point with the frequency ω and the rate of damping ν k² (viscosity, damping of
/// the stabilisation) that sees the velocity half a step late, the step is stable for ω² Δt² + 2 ν k² Δt <= 4.
class StableStep {
 public:
  template <class Body>
  void calibrate(Body& body) {
    const double frequency_squared = largest_eigenvalue(body);
    body.force.assign(body.size(), Vector4::Zero());
    body.add_internal_forces(0.0, false);
    const std::vector<double> waves = body.region_wave_numbers();
    double bound = 0.0;
    body.for_each_region([&](const auto& region, Index r) { bound = std::max(bound, region.wave_speed_squared * waves[r]); });
    ratio_ = bound > 0.0 ? frequency_squared / bound : 1.0;
  }

  /// Largest stable step at the present state; `term_rate` is ω² of what acts on the body's particles, 1/s².
  template <class Body>
  [[nodiscard]] double largest_step(const Body& body, double term_rate) const {
    const std::vector<double> waves = body.region_wave_numbers();
    double step = std::numeric_limits<double>::infinity();
    body.for_each_region([&](const auto& region, Index r) {
      const double k2 = ratio_ * waves[r];
      const double omega2 = region.wave_speed_squared * k2 + term_rate;
      const double stabilization = region.stabilization.modulus * region.stabilization.damping_time / region.laws.front().density;
      const double damping = (region.kinematic_viscosity + 2.0 * stabilization) * k2;
      if (omega2 > 0.0) step = std::min(step, (std::sqrt(damping * damping + 4.0 * omega2) - damping) / omega2);
    });
    if constexpr (Body::has_director) {
      // Explicit diffusion and penalty of the director: D (k² + 2/ε_d²) Δt <= 2.
      double k2 = 0.0;
      for (double w : waves) k2 = std::max(k2, ratio_ * w);
      const auto& law = body.director_law();
      step = std::min(step, 2.0 / (law.diffusivity * (k2 + 2.0 / (law.core_size * law.core_size))));
    }
    return step;
  }

 private:
  /// Largest eigenvalue of M⁻¹K at the present state, from differences of the internal forces; 1/s².
  template <class Body>
  static double largest_eigenvalue(Body& body) {
    const Field start = body.displacement, velocity = body.velocity;
    const std::size_t n = body.size();
    std::fill(body.velocity.begin(), body.velocity.end(), Vector4::Zero());
    auto internal_forces = [&] {
      std::fill(body.force.begin(), body.force.end(), Vector4::Zero());
      body.add_internal_forces(0.0, false);
      return body.force;
    };
    const Field rest = internal_forces();
    Field mode(n, Vector4::Zero());
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < Body::dimension; ++k)
        mode[i][k] = std::sin(12.9898 * static_cast<double>(3 * i + static_cast<std::size_t>(k) + 1) * 1.61803398875);
    double length = std::numeric_limits<double>::infinity();
    for (std::size_t q = 0; q < body.table().points(); ++q)
      length = std::min(length, std::pow(body.table().volume[q], 1.0 / Body::dimension));
    const double size = 1e-6 * length;  // amplitude of the perturbation, m
    double eigenvalue = 0.0;
    for (int iteration = 0; iteration < 60; ++iteration) {
      double largest = 0.0;
      for (const Vector4& m : mode) largest = std::max(largest, m.cwiseAbs().maxCoeff());
      if (!(largest > 0.0)) break;
      for (std::size_t i = 0; i < n; ++i) {
        mode[i] /= largest;
        body.displacement[i] = start[i] + size * mode[i];
      }
      const Field force = internal_forces();
      double mm = 0.0, mk = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        const Vector4 K_mode = (1.0 / size) * (rest[i] - force[i]);
        mm += body.masses()[i] * mode[i].squaredNorm();
        mk += mode[i].dot(K_mode);
        mode[i] = K_mode / body.masses()[i];
      }
      const double next = mk / mm;
      const bool settled = std::abs(next - eigenvalue) < 1e-3 * std::abs(next);
      eigenvalue = next;
      if (settled && iteration > 8) break;
    }
    body.displacement = start;
    body.velocity = velocity;
    // The Rayleigh quotient approaches the eigenvalue from below.
    return 1.02 * std::max(eigenvalue, 0.0);
  }

  double ratio_ = 1.0;
};

}  // namespace tactoid
