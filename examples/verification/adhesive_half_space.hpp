#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

namespace tactoid::verification {

/// The largest pull of a curve force(separation), followed from `start` outwards in steps of `step` until the force has
/// fallen clearly or the equilibrium is lost; the peak is that of the parabola through the three highest points.
/// `force` returns NaN where it finds no equilibrium near the one before. `record(separation, force)` sees all.
template <class Force, class Record>
[[nodiscard]] double pull_off_force(const Force& force, double start, double step, const Record& record) {
  std::vector<double> pull;
  double peak = -std::numeric_limits<double>::infinity();
  std::size_t top = 0;
  for (int i = 0; i < 400; ++i) {
    const double x = start + i * step, f = force(x);
    if (!std::isfinite(f)) break;
    record(x, f);
    pull.push_back(f);
    if (f > peak) {
      peak = f;
      top = pull.size() - 1;
    } else if (f < 0.9 * peak || pull.size() > top + 3) {
      break;
    }
  }
  if (top == 0 || top + 1 >= pull.size()) return peak;
  const double a = pull[top - 1], b = pull[top], c = pull[top + 1];
  return b - (c - a) * (c - a) / (8.0 * (a - 2.0 * b + c));
}

/// Adhesion of a paraboloid of radius R on an elastic half-space, without a sharp crack: the gap at every radius obeys
/// the law of the traction and the elastic deflection (Muller, Yushchenko and Derjaguin, J. Colloid Interface Sci.
/// 1980, 77, 91; Greenwood, Proc. R. Soc. A 1997, 453, 1277, for the Lennard-Jones law):
///
///   H(ρ) = H₀ + ½ρ² + μ^{3/2} (1/π) ∫ T(H(ρ')) dA'/|ρ − ρ'| ,
///
/// with H = gap/ε, ρ = r/√(R ε), T = traction ε/W (positive pushes), and Tabor's number μ = (R W²/(E*² ε³))^{1/3}.
/// On rings of equal width; the kernel of a ring is (4/π) K(k) ρ'/(ρ + ρ'), the elliptic integral's logarithm at the
/// ring itself averaged over its width. Newton's method, one equilibrium after the other.
template <class Law>
class AdhesiveHalfSpace {
 public:
  /// `traction(H)` is T; `extent` is the largest ρ.
  AdhesiveHalfSpace(Law traction, double tabor, double extent, int rings)
      : traction_(std::move(traction)), rho_(rings), H_(rings), width_(extent / rings) {
    for (int i = 0; i < rings; ++i) rho_[i] = (i + 0.5) * width_;
    kernel_.resize(rings, rings);
    const double scale = std::pow(tabor, 1.5) * 4.0 / std::numbers::pi * width_;
    for (int i = 0; i < rings; ++i)
      for (int j = 0; j < rings; ++j) {
        const double sum = rho_[i] + rho_[j];
        // K(k) ≈ ln(4/k'), k' = |ρ − ρ'|/(ρ + ρ'), whose mean over the width w is ln(8 (ρ + ρ')/w) + 1 (exactly: at k'
        // → 0).
        const double K =
            i == j ? std::log(8.0 * sum / width_) + 1.0 : std::comp_ellint_1(2.0 * std::sqrt(rho_[i] * rho_[j]) / sum);
        kernel_(i, j) = scale * K * rho_[j] / sum;
      }
  }

  /// The equilibrium at the approach H₀ (in contact), by making the half-space soft in steps.
  void settle(double H0) {
    H_ = Eigen::VectorXd::Constant(rho_.size(), H0) + 0.5 * rho_.cwiseAbs2();
    const Eigen::MatrixXd full = kernel_;
    for (double part = 1e-3; part < 1.0; part *= 2.0) {
      kernel_ = part * full;
      (void)pull(H0);
    }
    kernel_ = full;
  }

  /// Pull over 2π R W at the approach H₀, from the equilibrium before; NaN where Newton's method finds none near it.
  [[nodiscard]] double pull(double H0) {
    const Eigen::Index n = rho_.size();
    for (int iteration = 0; iteration < 60; ++iteration) {
      Eigen::VectorXd T(n), slope(n);
      for (Eigen::Index i = 0; i < n; ++i) {
        constexpr double d = 1e-6;
        T[i] = traction_(H_[i]);
        slope[i] = (traction_(H_[i] + d) - traction_(H_[i] - d)) / (2.0 * d);
      }
      const Eigen::VectorXd residual = H_ - Eigen::VectorXd::Constant(n, H0) - 0.5 * rho_.cwiseAbs2() - kernel_ * T;
      const Eigen::MatrixXd tangent = Eigen::MatrixXd::Identity(n, n) - kernel_ * slope.asDiagonal();
      const Eigen::VectorXd step = tangent.partialPivLu().solve(residual);
      const double largest = step.cwiseAbs().maxCoeff();
      H_ -= std::min(1.0, 0.3 / largest) * step;
      if (largest < 1e-9) {
        double sum = 0.0;
        for (Eigen::Index i = 0; i < n; ++i) sum -= traction_(H_[i]) * rho_[i] * width_;
        return sum;
      }
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

 private:
  Law traction_;
  Eigen::VectorXd rho_, H_;
  double width_;
  Eigen::MatrixXd kernel_;
};

}  // namespace tactoid::verification
