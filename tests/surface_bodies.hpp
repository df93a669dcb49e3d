#pragma once

// Bodies of particles with known deformations, for the tests of contact and boundary terms.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include <tactoid/geometry/all.hpp>
#include <tactoid/geometry/particle_fields.hpp>

namespace tactoid::test {

using detail::hashed_uniform;

/// Compares relatively, whatever the magnitude: doctest::Approx adds 1 to the scale, and would take any two
/// areas in m² or energies in J for equal.
struct Close {
  double value, tolerance;
  friend bool operator==(double a, const Close& b) {
    return std::abs(a - b.value) <= b.tolerance * std::max(std::abs(a), std::abs(b.value));
  }
  friend std::ostream& operator<<(std::ostream& out, const Close& c) {
    return out << c.value << " +- " << c.tolerance << " of it";
  }
};

/// Owns what ParticleFields only refers to.
template <int D>
struct TestBody {
  PointCloud<D> cloud;
  Field reference, position, velocity, force;
  std::vector<double> mass, volume;

  explicit TestBody(PointCloud<D> c) : cloud(std::move(c)) {
    for (const auto& X : cloud.positions) reference.push_back(pad(X));
    position = reference;
    velocity.assign(cloud.size(), Vector4::Zero());
    force = velocity;
    volume.resize(cloud.size());
    mass.resize(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      volume[i] = 1e-19 * (1.0 + 0.5 * hashed_uniform(3, i));
      mass[i] = 1000.0 * volume[i];
    }
  }
  ParticleFields fields() {
    std::fill(force.begin(), force.end(), Vector4::Zero());
    return {reference, position, velocity, mass, volume, force};
  }
  /// x = R(angle about `axis`) X + shift + random displacements of the given amplitude (m).
  void place(const Vector3& shift, double amplitude = 0.0, std::uint64_t seed = 1, double angle = 0.0,
             const Vector3& axis = Vector3::UnitZ()) {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      position[i] = pad(Vector3(R * reference[i].template head<3>() + shift));
      for (int k = 0; k < D; ++k)
        position[i][k] += amplitude * hashed_uniform(seed, 3 * i + static_cast<std::uint64_t>(k));
      if (D == 2) position[i][2] = 0.0;
    }
  }
  void random_velocities(double scale, std::uint64_t seed) {
    for (std::size_t i = 0; i < velocity.size(); ++i)
      for (int k = 0; k < D; ++k) velocity[i][k] = scale * hashed_uniform(seed, 3 * i + static_cast<std::uint64_t>(k));
  }
  [[nodiscard]] Vector3 total_force() const {
    Vector4 sum = Vector4::Zero();
    for (const Vector4& f : force) sum += f;
    return sum.head<3>();
  }
  [[nodiscard]] Vector3 total_torque() const {
    Vector3 sum = Vector3::Zero();
    for (std::size_t i = 0; i < force.size(); ++i)
      sum += Vector3(position[i].template head<3>()).cross(Vector3(force[i].template head<3>()));
    return sum;
  }
  [[nodiscard]] double force_scale() const {
    double sum = 0.0;
    for (const Vector4& f : force) sum += f.norm();
    return sum;
  }
  [[nodiscard]] double extent() const {
    double r = 0.0;
    for (const Vector4& x : position) r = std::max(r, x.norm());
    return r;
  }
  [[nodiscard]] double virial() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < force.size(); ++i) sum += force[i].dot(position[i]);
    return sum;
  }
  [[nodiscard]] double power() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < force.size(); ++i) sum += force[i].dot(velocity[i]);
    return sum;
  }
};

}  // namespace tactoid::test
