#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/SVD>

#include <tactoid/core/dual.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/kinematics/kinematics.hpp>
#include <tactoid/material/material.hpp>
#include <tactoid/simulation/body.hpp>

namespace tactoid::verification {

/// A motion x(X) that is made up, and what it takes to be an equilibrium. `Map` has
/// `Vector<T> operator()(const Vector<T>& X) const` for any scalar T.
template <class Map>
struct ManufacturedMotion {
  Map map;

  [[nodiscard]] Vector3 displacement(const Vector3& X) const { return map(X) - X; }

  /// F = ∂x/∂X by automatic differentiation.
  [[nodiscard]] Tensor3 gradient(const Vector3& X) const {
    using D = Dual<double, 3>;
    Vector<D> Y;
    for (int k = 0; k < 3; ++k) Y(k) = D::variable(X[k], k);
    const Vector<D> x = map(Y);
    Tensor3 F;
    for (int i = 0; i < 3; ++i)
      for (int K = 0; K < 3; ++K) F(i, K) = x(i).derivative[static_cast<std::size_t>(K)];
    return F;
  }

  /// Force per mass that holds the motion in equilibrium, b = −Div P / ρ₀, P = ∂W/∂F: second derivatives of x and W by
  /// nested automatic differentiation. Of the law only the energy is used, not the stress that it writes by hand.
  template <class Law>
  [[nodiscard]] Vector3 body_force(const Law& law, const Vector3& X) const {
    using Inner = Dual<double, 3>;
    using Outer = Dual<Inner, 3>;
    Vector<Outer> Y;
    for (int k = 0; k < 3; ++k) Y(k) = Outer::variable(Inner::variable(X[k], k), k);
    const Vector<Outer> x = map(Y);
    Tensor<Inner> F;
    for (int i = 0; i < 3; ++i)
      for (int K = 0; K < 3; ++K) F(i, K) = x(i).derivative[static_cast<std::size_t>(K)];
    const Tensor<Inner> P = stress_of_energy(law, F);
    Vector3 b = Vector3::Zero();
    for (int i = 0; i < 3; ++i)
      for (int K = 0; K < 3; ++K) b[i] -= P(i, K).derivative[static_cast<std::size_t>(K)] / law.density;
    return b;
  }

  /// Largest |principal stretch − 1| over the given points.
  [[nodiscard]] double largest_strain(const std::vector<Vector3>& points) const {
    double largest = 0.0;
    for (const Vector3& X : points) {
      const Vector3 stretches = Eigen::JacobiSVD<Tensor3>(gradient(X)).singularValues();
      largest = std::max(largest, (stretches.array() - 1.0).abs().maxCoeff());
    }
    return largest;
  }
};

/// Relative errors of a solution against the exact one, each over the norm of what is compared.
struct SolutionErrors {
  double displacement = 0.0;    ///< L2: of the values at the particles (or of the field at the points of integration)
  double gradient = 0.0;        ///< L2 of F − F_exact at the points of integration, over that of F_exact − 1
  double field = 0.0;           ///< L2 of the multilinear interpolant of the particles' values, integrated by 3ᴰ points
  double field_gradient = 0.0;  ///< of its gradient: the H1 seminorm
  double pressure = 0.0;        ///< L2 of the pressure at the points of integration
};

namespace detail {
template <int D>
[[nodiscard]] Vector3 padded(const Point<D>& x) {
  return pad(x).template head<3>();
}
}  // namespace detail

/// Errors of a body of one region whose displacement should be that of the motion.
template <class Map, class Law, class Body>
[[nodiscard]] SolutionErrors errors_of(const ManufacturedMotion<Map>& exact, const Law& law, Body& body) {
  constexpr int D = Body::dimension;
  const PointTable& table = body.table();
  const Field values = body.at_particles(body.displacement);
  double u_error = 0.0, u_size = 0.0, F_error = 0.0, F_size = 0.0, p_error = 0.0, p_size = 0.0;
  const std::vector<PointSample> samples = body.sample_points();
  for (std::size_t q = 0; q < table.points(); ++q) {
    const Vector3& X = table.position[q];
    Tensor3 F = Tensor3::Identity();
    Vector3 u = Vector3::Zero();
    for (std::size_t e = table.offsets[q]; e < table.offsets[q + 1]; ++e) {
      const TableEntry& entry = table.entries[e];
      const Vector3 uI = body.displacement[entry.particle].template head<3>();
      for (int k = 0; k < 3; ++k) F.col(k) += entry.gradient[k] * uI;
      if (!table.value_based()) u += table.point_values[e] * uI;
    }
    const Tensor3 F_exact = exact.gradient(X);
    const double V = table.volume[q];
    F_error += V * (F - F_exact).squaredNorm();
    F_size += V * (F_exact - Tensor3::Identity()).squaredNorm();
    const double p = -cauchy_from_piola(stress_of_energy(law, F_exact), F_exact).trace() / 3.0;
    p_error += V * std::pow(-samples[q].cauchy.trace() / 3.0 - p, 2);
    p_size += V * p * p;
    if (!table.value_based()) {
      u_error += V * (u - exact.displacement(X)).squaredNorm();
      u_size += V * exact.displacement(X).squaredNorm();
    }
  }
  if (table.value_based())
    for (std::size_t i = 0; i < body.size(); ++i) {
      const Vector3 u = exact.displacement(table.particle_position[i].template head<3>());
      u_error += body.nodal_volumes()[i] * (values[i].template head<3>() - u).squaredNorm();
      u_size += body.nodal_volumes()[i] * u.squaredNorm();
    }
  double f_error = 0.0, f_size = 0.0, g_error = 0.0, g_size = 0.0;
  for (const auto& cell : body.cloud().cells) {
    const Corners<D> corners = cell_corners(body.cloud(), cell);
    for_each_gauss_point<3, D>(Point<D>::Zero(), 1.0, [&](const Point<D>& xi, double weight) {
      const Eigen::Matrix<double, D, D> jacobian = cell_jacobian(corners, xi);
      const Vector3 X = detail::padded<D>(cell_position(corners, xi));
      Vector3 u = Vector3::Zero();
      Eigen::Matrix<double, 3, D> slope = Eigen::Matrix<double, 3, D>::Zero();
      Corners<D> unit;  // the Jacobian of the map (N_a, 0, …) holds the slopes of N_a
      unit.fill(Point<D>::Zero());
      for (std::size_t a = 0; a < corners.size(); ++a) {
        const Vector3 ua = values[cell[a]].template head<3>();
        u += corner_function<D>(a, xi) * ua;
        unit[a][0] = 1.0;
        slope += ua * cell_jacobian<D>(unit, xi).row(0);
        unit[a][0] = 0.0;
      }
      const Eigen::Matrix<double, 3, D> gradient = slope * jacobian.inverse();
      const Tensor3 H = exact.gradient(X) - Tensor3::Identity();
      const double V = weight * jacobian.determinant();
      f_error += V * (u - exact.displacement(X)).squaredNorm();
      f_size += V * exact.displacement(X).squaredNorm();
      g_error += V * (gradient - H.template leftCols<D>()).squaredNorm();
      g_size += V * H.squaredNorm();
    });
  }
  return {.displacement = std::sqrt(u_error / u_size),
          .gradient = std::sqrt(F_error / F_size),
          .field = std::sqrt(f_error / f_size),
          .field_gradient = std::sqrt(g_error / g_size),
          .pressure = std::sqrt(p_error / p_size)};
}

}  // namespace tactoid::verification
