#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <tactoid/contact/gap_law.hpp>
#include <tactoid/contact/per_dimension.hpp>
#include <tactoid/contact/repulsive_wall.hpp>
#include <tactoid/contact/rigid_surface.hpp>
#include <tactoid/contact/surface.hpp>
#include <tactoid/contact/surface_transfer.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/geometry/particle_fields.hpp>

namespace tactoid {

/// A body's facets with the force of a rigid surface at their quadrature points.
template <int D>
class RigidPass {
 public:
  /// Builds the facets of the body. Throws GeometryError for a cloud without facets or with periodic directions,
  /// ParameterError unless points_per_direction is 1 to 4.
  void initialize(const PointCloud<D>& cloud, const ParticleFields& body, int points_per_direction) {
    surface_ = FacetSurface<D>(cloud);
    quadrature_ = FacetQuadrature<D>(surface_, body.reference, points_per_direction);
    states_.resize(quadrature_.size());
  }

  /// Adds the forces on the body; `on_surface` becomes the total force on the rigid surface.
  template <GapLaw Law, RigidSurface Surface>
  TermEnergy apply(const Law& law, const Surface& rigid, const ParticleFields& body, double time, Vector3& on_surface) {
    // The next step must be short enough for what a point meets in it: the stiffness at the gap of two steps ahead.
    const double ahead = 2.0 * std::max(0.0, time - last_time_);
    last_time_ = time;
    parallel_for(states_.size(), [&](std::size_t q) {
      const Index f = quadrature_.facet_of(q);
      const auto& local = quadrature_.point(q).local;
      const Vector4 x = surface_.interpolate(f, local, body.position);
      const RigidGap g = rigid.at(x.template head<3>(), time);
      const double here = law.stiffness(g.gap);
      double stiffness = here;
      if (ahead > 0.0) {
        const Vector4 v = surface_.interpolate(f, local, body.velocity);
        const double closing = g.normal.dot(g.velocity - v.template head<3>());
        if (closing > 0.0) stiffness = std::max(stiffness, law.stiffness(g.gap - ahead * closing));
      }
      const double area = quadrature_.area[q], pressure = area * law.traction(g.gap);
      states_[q] = {pad(Vector3(pressure * g.normal)), g.normal, area * law.potential(g.gap),
                    pressure * g.normal.dot(g.velocity), area * here, area * stiffness};
    });
    on_surface.setZero();
    TermEnergy total;
    for (std::size_t q = 0; q < states_.size(); ++q) {
      const State& s = states_[q];
      total.potential += s.energy;
      total.external_power += s.power;
      on_surface -= s.force.template head<3>();
      const auto& nodes = surface_.facets[quadrature_.facet_of(q)];
      for (std::size_t k = 0; k < nodes.size(); ++k) body.force[nodes[k]] += quadrature_.point(q).shape[k] * s.force;
    }
    return total;
  }

  /// Gershgorin's bound of ω² at the gaps of the last call of apply (and of two steps ahead), 1/s².
  [[nodiscard]] double stiffness_rate(const ParticleFields& body) const;

  /// Calls emit(i, j, K), K = −∂f_i/∂x_j in the normal direction; the turn of the normal of a curved surface is left out.
  template <class Emit>
  void add_stiffness(const Emit& emit) const {
    for (std::size_t q = 0; q < states_.size(); ++q) {
      const State& s = states_[q];
      if (s.stiffness == 0.0) continue;
      const auto& nodes = surface_.facets[quadrature_.facet_of(q)];
      const auto& shape = quadrature_.point(q).shape;
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (std::size_t b = 0; b < nodes.size(); ++b)
          emit(nodes[a], nodes[b], Tensor3((s.stiffness * shape[a] * shape[b]) * s.normal * s.normal.transpose()));
    }
  }

  /// Particles slid along the surface: the reference area of each point is that of the matter that is there now.
  void redistribute(const SurfaceTransfer& surface) { quadrature_.area = surface.carry(quadrature_.weights(), quadrature_.area); }

  /// For checkpoints: the time of the last call, and the areas, which redistribution changes.
  template <class Archive>
  void state(Archive& archive) {
    archive("last_time", last_time_);
    archive("area", quadrature_.area);
  }

 private:
  struct State {
    Vector4 force = Vector4::Zero();
    Vector3 normal = Vector3::Zero();
    double energy = 0.0, power = 0.0;
    double stiffness = 0.0, stiffness_ahead = 0.0;  // at the gap, and the largest on the way of two steps
  };
  FacetSurface<D> surface_;
  FacetQuadrature<D> quadrature_;
  std::vector<State> states_;
  double last_time_ = std::numeric_limits<double>::infinity();
};

/// Contact of a body with a rigid surface under any GapLaw (per reference area), a BoundaryTerm in 2 and 3 dimensions:
/// `OnRigid{.law = LigandReceptorLaw{}, .surface = RigidSphere{…}}`. The power of a moving surface is external power.
/// On a meridian section the surface must be one of revolution about the same axis: a plane across it, a sphere on it; else
/// ParameterError.
template <GapLaw Law = RepulsiveWall, RigidSurface Surface = RigidPlane>
struct OnRigid {
  static constexpr Reads reads = Reads::facets;  ///< the surface
  Law law{};                             ///< of the gap
  Surface surface{};                     ///< against which the body is pressed
  int points_per_direction = 2;          ///< Gauss points along each side of a facet, 1 to 4
  PerDimension<RigidPass> pass{};        ///< set by initialize()
  Vector3 on_surface = Vector3::Zero();  ///< see force()
  double stored = 0.0;                   ///< see energy()

  /// Throws ParameterError where law or surface do.
  void validate() const {
    law.validate();
    surface.validate();
  }
  /// Throws ParameterError, and GeometryError for a cloud without facets or with periodic directions.
  template <int D>
    requires(D >= 2)
  void initialize(const PointCloud<D>& cloud, const ParticleFields& body) {
    validate();
    if (cloud.axisymmetric) {
      const Vector3 normal = surface.at(Vector3(0.0, cloud.positions[0][1], 0.0), 0.0).normal;
      if (std::hypot(normal[0], normal[2]) > 1e-9)
        throw ParameterError("OnRigid.surface of an axisymmetric body must be a surface of revolution about its axis, which is (0, 1, 0).");
    }
    pass.emplace<D>().initialize(cloud, body, points_per_direction);
  }
  /// See RigidPass.
  void redistribute(const SurfaceTransfer& transfer, const ParticleFields&) {
    pass.visit([&](auto& p) { p.redistribute(transfer); });
  }
  /// Adds A_q t(g) n; returns Σ A_q Φ and the power of a moving surface.
  TermEnergy apply(const ParticleFields& body, double time) {
    const TermEnergy energy = pass.visit([&](auto& p) { return p.apply(law, surface, body, time, on_surface); });
    stored = energy.potential;
    return energy;
  }
  /// At the gaps of the last call of apply.
  [[nodiscard]] double stiffness_rate(const ParticleFields& body) const {
    return pass.visit([&](const auto& p) { return p.stiffness_rate(body); });
  }
  /// At the gaps of the last call of apply: that of a law that only repels. Attraction softens with the distance; here it
  /// counts as if it stiffened, which keeps the matrix of a static solution positive.
  template <class Emit>
  void add_stiffness(const ParticleFields&, const Emit& emit) const {
    pass.visit([&](const auto& p) { p.add_stiffness(emit); });
  }
  /// Force of the body on the rigid surface at the last call of apply, N.
  [[nodiscard]] Vector3 force() const { return on_surface; }
  /// Energy between body and surface at that call, J.
  [[nodiscard]] double energy() const { return stored; }
  /// For checkpoints: force and energy of the last call.
  template <class Archive>
  void state(Archive& archive) {
    archive.part("pass", pass);
    archive("on_surface", on_surface);
    archive("stored", stored);
  }
};

/// A rigid plate, at rest or moving steadily, that a body is pressed or stuck to: a BoundaryTerm in 2 and 3 dimensions.
/// `RigidPlate{.point = …, .normal = …, .velocity = …}` repels; `.law = LigandReceptorLaw{…}` adheres.
/// For another motion, or another surface: OnRigid.
template <GapLaw Law = RepulsiveWall>
struct RigidPlate {
  static constexpr Reads reads = Reads::facets;  ///< the surface
  Vector3 point = Vector3::Zero();     ///< a point of the plate at time 0, m
  Vector3 normal = Vector3::UnitZ();   ///< toward the body
  Vector3 velocity = Vector3::Zero();  ///< m/s
  Law law{};                           ///< force between plate and body, per reference area of the body
  int points_per_direction = 2;        ///< Gauss points along each side of a facet, 1 to 4
  OnRigid<Law, RigidPlane> contact{};  ///< set by initialize()

  /// Throws ParameterError where the law does, for a normal of no length, and for what is not finite.
  void validate() const {
    law.validate();
    RigidPlane{point, normal, velocity}.validate();
  }
  /// Throws as OnRigid does.
  template <int D>
    requires(D >= 2)
  void initialize(const PointCloud<D>& cloud, const ParticleFields& body) {
    contact.law = law;
    contact.surface = {point, normal, velocity};
    contact.points_per_direction = points_per_direction;
    contact.initialize(cloud, body);
  }
  TermEnergy apply(const ParticleFields& body, double time) { return contact.apply(body, time); }  ///< see OnRigid
  void redistribute(const SurfaceTransfer& surface, const ParticleFields& body) { contact.redistribute(surface, body); }  ///< see OnRigid
  /// See OnRigid.
  [[nodiscard]] double stiffness_rate(const ParticleFields& body) const { return contact.stiffness_rate(body); }
  /// See OnRigid.
  template <class Emit>
  void add_stiffness(const ParticleFields& body, const Emit& emit) const {
    contact.add_stiffness(body, emit);
  }
  /// Force of the body on the plate at the last call of apply, N.
  [[nodiscard]] Vector3 force() const { return contact.force(); }
  /// For checkpoints: that of the contact.
  template <class Archive>
  void state(Archive& archive) { archive.part("contact", contact); }
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/on_rigid.ipp>
#endif
