#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <tactoid/boundary/body_force.hpp>
#include <tactoid/boundary/prescribed_motion.hpp>
#include <tactoid/director/director_field.hpp>
#include <tactoid/geometry/box.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/rkpm.hpp>
#include <tactoid/material/nematic_gel.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/simulation/simulation.hpp>

namespace tactoid::verification {

/// The director at the start.
using DirectorFunction = std::function<Vector3(const Vector3& X)>;

/// A gel in plane strain: one body, two prescribed motions and a body force; the same type for every case.
template <ObjectiveRate Rate>
struct PlaneGel {
  PointCloud<2> cloud;
  NematicGel<> gel = {};
  DirectorField<Rate> field = {};
  DirectorFunction director = [](const Vector3&) { return Vector3(Vector3::UnitX()); };
  NodalCentroids rule = {};
  PrescribedMotion first = {}, second = {};
  Vector3 acceleration = Vector3::Zero();
  CentralDifference integrator = {};

  /// The simulation; it holds copies.
  [[nodiscard]] auto simulation() const {
    return Simulation{
        Bodies{Body{"gel", cloud, Rkpm<2>{}, rule, Materials{Region{"body", gel}}, field, director}}, Contacts{},
        Boundaries{on<0>(first), on<0>(second), on<0>(BodyForce<>{.acceleration = acceleration})}, integrator};
  }
};

/// Between walls at y = 0 and y = height, periodic along x and a few cells long.
[[nodiscard]] inline PointCloud<2> strip(double height, int cells) {
  constexpr int along = 4;
  return rectangle({.size = {along * height / cells, height}, .cells = {along, cells}, .periodic = {true, false}});
}
/// The particles of its walls.
[[nodiscard]] inline std::vector<Index> lower_wall(const PointCloud<2>& cloud) {
  return select(cloud, [](const Point<2>& X) { return X[1] == 0.0; });
}
[[nodiscard]] inline std::vector<Index> upper_wall(const PointCloud<2>& cloud, double height) {
  return select(cloud, [=](const Point<2>& X) { return X[1] > height * (1.0 - 1e-9); });
}

/// No stabilisation: the flows of the verification are smooth and have no free surface to be kept in order.
[[nodiscard]] inline NodalCentroids unstabilised() {
  return {.fluid_modulus = 0.0};
}

}  // namespace tactoid::verification
