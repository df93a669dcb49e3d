#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/SparseCore>

#include <tactoid/core/errors.hpp>

namespace tactoid {

/// What updates of the reference did since the start.
struct ReferenceReport {
  std::size_t updates = 0;        ///< of a body
  std::size_t refused = 0;        ///< that the quadrature could not sample
  double lost_energy = 0.0;       ///< by all of them, J: what was stored before, minus what is stored after
  double largest_distortion = 1.0;  ///< seen, of any body since its last update

  /// For checkpoints: all of it.
  template <class Archive>
  void state(Archive& archive) {
    archive("updates", updates);
    archive("refused", refused);
    archive("lost_energy", lost_energy);
    archive("largest_distortion", largest_distortion);
  }
};

/// How particles of fluids are redistributed when the reference of their body is updated, in planes and meridian sections. A fluid
/// has no preferred particles: those on its surface slide along it towards the relative spacing of the first configuration,
/// those inside follow (see Body::update_reference). So neither crowds nor gaps grow, and the cells go on to be the volume of the body.
struct Redistribution {
  double share = 1.0;    ///< of the way along the surface that is gone in an update; in (0, 1]
  double corner = 0.35;  ///< turn of the surface at a particle above which it is an edge, at which there remains one, rad; in (0, π]

  /// Throws ParameterError for a value out of its range.
  void validate() const {
    if (!(share > 0.0 && share <= 1.0)) reject("Redistribution.share", share, "", "above 0 and at most 1");
    if (!(corner > 0.0 && corner <= std::numbers::pi)) reject("Redistribution.corner", corner, "rad", "above 0 and at most pi");
  }
};

/// What a system did to update the references of its bodies.
struct ReferenceUpdate {
  std::size_t updates = 0;   ///< bodies that have a new reference
  double lost_energy = 0.0;  ///< J
  double distortion = 1.0;   ///< largest of the bodies before
  std::string refused;       ///< why a body keeps its reference; empty where none had to
  /// Per body, where particles were redistributed: from values at the particles as they were to values where they are now; else empty.
  std::vector<Eigen::SparseMatrix<double, Eigen::RowMajor>> rows{};
};

/// An integrator that updates the reference configuration: the steps are those of `Inner` (CentralDifference, ImplicitDynamics, …),
///
///   Simulation{Bodies{…}, Contacts{…}, Boundaries{…}, UpdatedReference{ImplicitDynamics{}, 2.0}}.
///
/// A total Lagrangian description keeps the neighbours of the first configuration. A fluid has no rest shape and flows out of them: after
/// large stretches gradients are sums of large parts that cancel, and a point is inverted at last. Here a body whose `distortion` since its last
/// update exceeds the bound gets neighbours, shape functions and points on its present configuration (Body::update_reference):
/// particles, masses, velocities, stresses and histories stay as they are; the stabilisation starts anew, the volume ratio of fluids is smoothed, and what is
/// lost with it is reported, and booked in EnergyLedger::reference_updates.
///
/// With a Redistribution, `UpdatedReference{ImplicitDynamics{}, 1.5, 10, Redistribution{}}`, particles of fluids are moved in each update.
///
/// The system offers `ReferenceUpdate update_references(double distortion)`, and `require_updatable()`, which throws ParameterError; with a Redistribution also
/// `update_references(double distortion, const Redistribution&)` and `require_redistributable()`. A body that cannot be sampled anew keeps its reference, and
/// is asked again when it is distorted a tenth more.
template <class Inner>
struct UpdatedReference : Inner {
  double distortion = 2.0;   ///< stretch (or its inverse) of any point since the last update that calls for one; > 1, infinite: never
  int interval = 10;         ///< steps between two looks at it, >= 1
  std::optional<Redistribution> redistribution{};  ///< of the particles of fluids, in each update; none: particles are matter
  ReferenceReport reference{};  ///< set by the steps
  int since = 0;                ///< steps since the last look
  double bound = 0.0;           ///< that is in force, m/m

  /// Throws ParameterError for values out of their range, and what `Inner` throws.
  template <class System>
  void initialize(System& system) {
    if (!(distortion > 1.0)) reject("UpdatedReference.distortion", distortion, "", "above 1");
    if (interval < 1) reject("UpdatedReference.interval", interval, "", "at least 1");
    if (std::isfinite(distortion)) system.require_updatable();
    if (redistribution) {
      redistribution->validate();
      if (std::isfinite(distortion)) system.require_redistributable();
    }
    reference = {};
    since = 0;
    bound = distortion;
    Inner::initialize(system);
  }

  /// One step of `Inner`, and an update after it where it is due.
  template <class System>
  void step(System& system, double until) {
    Inner::step(system, until);
    if (!std::isfinite(distortion) || ++since < interval) return;
    since = 0;
    const ReferenceUpdate update = redistribution ? system.update_references(bound, *redistribution) : system.update_references(bound);
    if constexpr (requires { Inner::carry_over(system, update.rows); })
      if (!update.rows.empty()) Inner::carry_over(system, update.rows);
    reference.updates += update.updates;
    reference.lost_energy += update.lost_energy;
    reference.largest_distortion = std::max(reference.largest_distortion, update.distortion);
    if (!update.refused.empty()) ++reference.refused;
    if (!update.refused.empty()) bound = std::max(bound, 1.1 * update.distortion);
    else if (update.updates > 0) bound = distortion;
  }

  /// For checkpoints: the state of `Inner`, and what was counted.
  template <class Archive>
  void state(Archive& archive) {
    if constexpr (requires(Inner& inner) { inner.state(archive); }) Inner::state(archive);
    archive.part("reference", reference);
    archive("since", since);
    archive("bound", bound);
  }
};
/// Deduced from the integrator; distortion, interval and redistribution may follow it.
template <class Inner>
UpdatedReference(Inner, double = 2.0, int = 10, std::optional<Redistribution> = {}) -> UpdatedReference<Inner>;

}  // namespace tactoid
