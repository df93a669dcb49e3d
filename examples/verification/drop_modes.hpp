#pragma once

#include <cmath>
#include <complex>

namespace tactoid::verification {

/// A viscous drop of unit radius, density and tension; its viscosity is the Ohnesorge number Oh = μ/√(ρ σ₀ R), and
/// times are in √(ρ R³/σ₀).
///
/// The complex rate s of the n = 2 normal mode, shape ~ exp(s t), from the linearised Navier-Stokes equations
/// (Chandrasekhar, Proc. London Math. Soc. 1959, 9, 141; Miller and Scriven, J. Fluid Mech. 1968, 32, 417; Prosperetti,
/// J. Fluid Mech. 1980, 100, 333): u = ∇(A rⁿ Y) + B ∇×∇×(x i_n(k r) Y), k² = s/ν, with the conditions at r = 1
///
///   tangential   ∂u_t/∂r − u_t/r + u_r/r = 0,
///   normal       −p + 2 μ ∂u_r/∂r + (n − 1)(n + 2) u_r/s = 0,   p = −s A rⁿ Y,
///
/// whose determinant vanishes. `start` chooses the root: a secant method goes on from there. Limits: ±i√8 − 5 Oh
/// (Rayleigh 1879; Lamb, Hydrodynamics, § 355) for Oh → 0, −(20/19)/Oh for Oh → ∞.
[[nodiscard]] inline std::complex<double> drop_mode_rate(double ohnesorge, std::complex<double> start) {
  using Complex = std::complex<double>;
  constexpr double n = 2.0;
  const auto determinant = [&](Complex s) {
    const Complex k = std::sqrt(s / ohnesorge), k2 = k * k;
    const Complex i1 = (k * std::cosh(k) - std::sinh(k)) / k2;  // modified spherical Bessel functions
    const Complex i = ((k2 + 3.0) * std::sinh(k) - 3.0 * k * std::cosh(k)) / (k * k2);
    const Complex di = i1 - (n + 1.0) / k * i, ddi = -2.0 / k * di + (1.0 + n * (n + 1.0) / k2) * i;
    // Columns: u_r = n rⁿ⁻¹, u_t = rⁿ⁻¹ of the potential; u_r = n (n + 1) i/r, u_t = i/r + k i' of the vortical part.
    const Complex radial = n * (n + 1.0) * i, radial_slope = n * (n + 1.0) * (k * di - i);
    const Complex tangential = i + k * di, tangential_slope = k * di - i + k2 * ddi;
    const double capillary = (n - 1.0) * (n + 2.0);
    const Complex shear_a = 2.0 * (n - 1.0), shear_b = tangential_slope - tangential + radial;
    const Complex normal_a = s + 2.0 * ohnesorge * n * (n - 1.0) + capillary * n / s;
    const Complex normal_b = 2.0 * ohnesorge * radial_slope + capillary * radial / s;
    return (normal_a * shear_b - normal_b * shear_a) / i;
  };
  Complex before = start, now = start * (1.0 + 1e-4);
  Complex f_before = determinant(before), f_now = determinant(now);
  for (int iteration = 0; iteration < 100 && std::abs(now - before) > 1e-13 * std::abs(now); ++iteration) {
    const Complex next = now - f_now * (now - before) / (f_now - f_before);
    before = now;
    f_before = f_now;
    now = next;
    f_now = determinant(now);
  }
  return now;
}

}  // namespace tactoid::verification
