#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/text.hpp>
#include <tactoid/kernel/shape_functions.hpp>

namespace tactoid {

/// State of a body at one point of its reference configuration.
struct ProbeReading {
  Vector3 position = Vector3::Zero();      ///< x, m
  Vector3 displacement = Vector3::Zero();  ///< u, m
  Vector3 velocity = Vector3::Zero();      ///< at the present instant, m/s
};

/// Reads interpolated fields at any points X of a body, by the shape functions of its kernel:
///
///   Probe probe{body, {{0.0, 0.0, 5_um}}};                       // before or after the body joins a simulation
///   simulation.run(5_us, every(0.1_us, [&](auto& s) { z = probe.read<0>(s)[0].position[2]; }));
///
/// In a body whose unknowns are coefficients these are its own shape functions, and the reading is the field itself. In
/// a value-based body they are applied to the values at the particles, which is exact for fields of the kernel's basis.
/// A point outside the body, but within the reach of enough of its particles, gets the extrapolated field.
template <int D>
class Probe {
 public:
  /// Points in the reference configuration, m. Throws GeometryError that names the point that too few particles reach; ParameterError for a body of which each process has a part.
  template <class Body>
    requires(Body::dimension == D)
  Probe(const Body& body, std::vector<Point<D>> points) : points_(std::move(points)) {
    if (body.in_parts()) throw ParameterError("Probe in body " + in_quotes(body.name()) + ": each process has a part of its cloud, and none knows all around a point.");
    try {
      shapes_ = shape_functions(body.kernel(), body.cloud(), points_);
    } catch (const GeometryError& error) {
      throw GeometryError("Probe in body " + in_quotes(body.name()) + ", outside of it? " + error.what());
    }
  }

  [[nodiscard]] std::size_t size() const { return points_.size(); }              ///< number of points
  [[nodiscard]] const std::vector<Point<D>>& points() const { return points_; }  ///< reference positions, m
  /// Shape functions at the points.
  [[nodiscard]] const ShapeFunctionTable<D>& shapes() const { return shapes_; }

  /// Σ_I φ_I(X_k) f_I at point k: of the unknowns of the body (displacement, velocity, director), or of values at
  /// the particles (stress_fields().pressure).
  template <class T>
  [[nodiscard]] T interpolate(const std::vector<T>& field, std::size_t k) const {
    return tactoid::interpolate<D, T>(shapes_, k, field);
  }

  /// Readings at all points, of body N of a simulation, which must be the body that the probe was made for.
  template <std::size_t N, class S>
  [[nodiscard]] std::vector<ProbeReading> read(const S& simulation) const {
    const auto& body = simulation.template body<N>();
    const Field velocity = simulation.template velocity<N>();
    std::vector<ProbeReading> readings(size());
    for (std::size_t k = 0; k < size(); ++k) {
      readings[k].displacement = interpolate(body.displacement, k).template head<3>();
      readings[k].velocity = interpolate(velocity, k).template head<3>();
      readings[k].position = pad(points_[k]).template head<3>() + readings[k].displacement;
    }
    return readings;
  }

 private:
  std::vector<Point<D>> points_;
  ShapeFunctionTable<D> shapes_;
};

/// Deduced from the body.
template <class Body>
Probe(const Body&, std::vector<Point<Body::dimension>>) -> Probe<Body::dimension>;

}  // namespace tactoid
