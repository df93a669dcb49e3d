#pragma once

#include <tactoid/core/parallel.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/geometry/particle_fields.hpp>

namespace tactoid {

/// The values of a body at its particles, which contacts, boundary terms and observers see.
struct BodyFields {
  Field position;          ///< x, m
  Field velocity;          ///< v at the present instant, m/s
  Field force;             ///< of contacts and boundary terms, N
  Ranks* ranks = nullptr;  ///< that share the body
  const std::vector<Index>* own = nullptr;  ///< particles of this one, as ParticleFields has them
  const std::vector<int>* owner = nullptr;  ///< beside them

  /// The reference configuration of a body, at rest.
  template <class Body>
  void prepare(const Body& body) {
    position = body.reference();
    velocity.assign(body.size(), Vector4::Zero());
    force.assign(body.size(), Vector4::Zero());
  }

  /// Positions at the present state, velocities extrapolated by `lag` (s), how far they are behind it, with the forces
  /// of the step before; forces are cleared.
  template <class Body>
  void refresh(const Body& body, double lag) {
    const Field& reference = body.reference();
    if (body.particle_values().identity()) {
      body.for_each_particle([&](std::size_t i) {
        position[i] = reference[i] + body.displacement[i];
        velocity[i] = body.velocity[i];
        if (lag > 0.0) velocity[i] += (lag / body.masses()[i]) * body.force[i];  // else the forces may be those of a state that broke down
        force[i].setZero();
      });
    } else {
      Field v = body.velocity;
      if (lag > 0.0)
        for (std::size_t i = 0; i < v.size(); ++i) v[i] += (lag / body.masses()[i]) * body.force[i];
      show(body, std::move(v));
    }
  }

  /// All positions at the present state, with these velocities of the unknowns (m/s); forces are cleared.
  template <class Body>
  void show(const Body& body, Field unknowns) {
    const Field& reference = body.reference();
    if (body.particle_values().identity()) {
      position = body.displacement;
      velocity = std::move(unknowns);
    } else {
      position = body.at_particles(body.displacement);
      velocity = body.at_particles(unknowns);
    }
    for (std::size_t i = 0; i < position.size(); ++i) position[i] += reference[i];
    force.assign(position.size(), Vector4::Zero());
  }

  /// For checkpoints: positions, velocities and forces, of the particles in `rows`; the rest comes from the body.
  template <class Archive>
  void state(Archive& archive, const StateRows* rows) {
    archive("position", position, rows);
    archive("velocity", velocity, rows);
    archive("force", force, rows);
  }

  /// As contacts and terms take it; valid as long as this object and the body, and until its reference is updated.
  template <class Body>
  [[nodiscard]] ParticleFields view(const Body& body) {
    return {body.reference(), position, velocity, body.masses(), body.nodal_volumes(), force, ranks, own, owner};
  }
};

}  // namespace tactoid
