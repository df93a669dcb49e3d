#pragma once

#include <tactoid/contact/first_touch.hpp>
#include <tactoid/contact/gaps.hpp>
#include <tactoid/contact/per_dimension.hpp>
#include <tactoid/core/errors.hpp>

namespace tactoid {

/// Strong anchoring of the director on the contact surface, h = h̄: a particle of A's surface whose gap to B falls
/// to the capture distance for the first time keeps the director that it has then. Placed among the contacts,
/// `between<0, 1>(ContactAnchoring{})`; it exerts no force. Where particles are redistributed, a particle that is held stays so, with
/// the director of its new place. Zeng and Li, Soft Matter 2012, 8, 5765, below eqn (10).
struct ContactAnchoring {
  static constexpr bool follows_redistribution = true;  ///< who is held remains so
  static constexpr Reads reads_a = Reads::facets;  ///< the surface of A
  static constexpr Reads reads_b = Reads::facets;  ///< the surface of B
  double capture_distance = 100e-9;  ///< m, > 0
  int interval = 10;                 ///< steps between two looks at the gaps
  PerDimension<SurfaceGaps> gaps{};  ///< set by initialize(), as the rest
  FirstTouch touch{};                ///< which particles have touched
  int countdown = 0;                 ///< steps until the next look
  bool fresh = false;                ///< gaps were measured in this step
  double last_time = -1.0;           ///< of the last step that was counted, s: trials of an implicit step are none

  /// Throws ParameterError unless capture_distance > 0 and interval >= 1, GeometryError for a cloud without facets.
  template <int D>
  void initialize(const PointCloud<D>& cloud_a, const ParticleFields& a, const PointCloud<D>& cloud_b, const ParticleFields& b) {
    require_positive("ContactAnchoring.capture_distance", capture_distance, "m");
    if (interval < 1) reject("ContactAnchoring.interval", interval, "", "at least 1");
    gaps.emplace<D>().initialize(cloud_a, a, cloud_b, b);
    touch.capture_distance = capture_distance;
    touch.touched.assign(cloud_a.size(), 0);
  }

  /// Measures the gaps in every `interval`-th step; no force, no energy.
  TermEnergy apply(const ParticleFields& a, const ParticleFields& b, double time);
  /// No force, no limit.
  [[nodiscard]] double stiffness_rate(const ParticleFields&, const ParticleFields&) const { return 0.0; }

  /// Holds the director of the particles that touch for the first time.
  template <class Body>
  void anchor(Body& body) {
    static_assert(Body::has_director, "ContactAnchoring needs a director field on the first body.");
    if (!fresh) return;
    fresh = false;
    if (body.anchored.empty()) body.anchored.assign(body.size(), 0);
    for (Index i : touch.update(gaps.visit([](const auto& g) { return g.gaps(); }))) body.anchored[i] = 1;
  }
  /// For checkpoints: the gaps that are followed, and who has touched.
  template <class Archive>
  void state(Archive& archive) {
    archive.part("gaps", gaps);
    gaps.visit([&](const auto& g) { state_at(archive, "touched", touch.touched, g.surface().nodes); });
    archive("countdown", countdown);
    archive("fresh", fresh);
    archive("last_time", last_time);
  }
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/simulation/contact_anchoring.ipp>
#endif
