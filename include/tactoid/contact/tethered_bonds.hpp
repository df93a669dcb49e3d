#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <tactoid/contact/contact.hpp>
#include <tactoid/contact/per_dimension.hpp>
#include <tactoid/contact/surface.hpp>
#include <tactoid/contact/surface_contact.hpp>
#include <tactoid/contact/surface_transfer.hpp>
#include <tactoid/contact/tracking.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/core/random.hpp>
#include <tactoid/geometry/particle_fields.hpp>

namespace tactoid {

/// How fast a bond forms and breaks. Under a tension F ≥ 0 it breaks at the rate
///   k_off(F) = k_s e^{F/F_s} + k_c e^{−F/F_c} ,
/// slip alone for k_c = 0 (G. I. Bell, Science 1978, 200, 618), else catch and slip: the lifetime first grows with the force
/// (Y. V. Pereverzev et al., Biophys. J. 2005, 89, 1446). Compressed bonds break as unloaded ones.
struct BondKinetics {
  double on_rate = 1e6;        ///< k_on of a free receptor within reach, 1/s; >= 0
  double off_rate = 1e5;       ///< k_s, 1/s; >= 0
  double slip_force = 10e-12;  ///< F_s, N; > 0, may be infinite: force does not matter
  double catch_rate = 0.0;     ///< k_c, 1/s; >= 0
  double catch_force = 5e-12;  ///< F_c, N; > 0

  /// k_off at a tension, 1/s; finite for every force.
  [[nodiscard]] double detachment_rate(double tension) const {
    const double f = std::max(tension, 0.0);
    return off_rate * std::exp(std::min(f / slip_force, 300.0)) + catch_rate * std::exp(-f / catch_force);
  }

  /// Throws ParameterError for a value out of its range.
  void validate() const;
};

struct TetheredBonds;

/// The receptors of a body's facets, which bind to material points of another body's surface: what TetheredBonds keeps. Here A is the body with the
/// receptors.
///
/// A *site* is a place on A's facets (a quadrature point) with room for `capacity` bonds: all receptors of the quadrature point
/// in the mean field, a single one where bonds are stochastic. It knows how many bonds hold, where they are anchored, and
/// what is stored in them.
template <int D>
class TetherSites {
 public:
  /// Builds surfaces and sites; no bond holds.
  void initialize(const TetheredBonds& law, const PointCloud<D>& cloud_a, const ParticleFields& a, const PointCloud<D>& cloud_b,
                  const ParticleFields& b);
  /// Breaks and forms bonds over the time since the last call, and adds the forces of those that hold.
  TermEnergy apply(const TetheredBonds& law, const ParticleFields& a, const ParticleFields& b, double time);
  /// Bound of ω² if every receptor within reach, and every one that is bound, were a spring; 1/s².
  [[nodiscard]] double stiffness_rate(const TetheredBonds& law, const ParticleFields& a, const ParticleFields& b) const;

  /// Emits −∂f/∂x of the bonds that hold; see ContactWithStiffness.
  template <class Emit>
  void add_stiffness(const TetheredBonds& law, const Emit& emit) const;

  [[nodiscard]] std::size_t size() const { return capacity_.size(); }                  ///< number of sites
  [[nodiscard]] std::span<const double> capacity() const { return capacity_; }         ///< receptors per site
  [[nodiscard]] std::span<const double> bound() const { return bound_; }               ///< bonds that hold, per site
  [[nodiscard]] std::span<const Vector4> extension() const { return extension_; }      ///< from anchor to site, m; 0 where nothing is bound
  [[nodiscard]] std::span<const double> stored() const { return shown_; }              ///< energy of the bonds of each site, J
  /// Where a site was at the last call, m.
  [[nodiscard]] const Vector4& place(std::size_t site) const { return points_[point_of_[site]]; }

  /// Receptors and bonds are carried along with A's surface, along which its particles slid; see TetheredBonds::redistribute.
  void redistribute(const TetheredBonds& law, const SurfaceTransfer& surface, const ParticleFields& a, const ParticleFields& b);

  /// The particles of the surface with the anchors slid along it: anchors stay in their places.
  void redistribute_anchors(const TetheredBonds& law, const ParticleFields& a, const ParticleFields& b);

  /// What a checkpoint keeps.
  template <class Archive>
  void state(Archive& archive) {
    using Place = Eigen::Matrix<double, D - 1, 1>;
    std::vector<Place> place(anchor_.size());
    for (std::size_t s = 0; s < place.size(); ++s) place[s] = Eigen::Map<const Place>(anchor_[s].data());
    archive.part("tracker", tracker_);
    archive("capacity", capacity_);  // redistribution changes it
    archive("bound", bound_);
    archive("stored", stored_);
    archive("potential", potential_);
    archive("anchor_facet", anchor_facet_);
    archive("anchor", place);
    archive("last_time", last_time_);
    archive("calls", calls_);
    for (std::size_t s = 0; s < place.size(); ++s) Eigen::Map<Place>(anchor_[s].data()) = place[s];
    if constexpr (Archive::restoring) shown_ = stored_;
  }

 private:
  using Local = typename FacetSurface<D>::Local;

  /// Positions of the quadrature points of A, and B's nearest points.
  void locate(const ParticleFields& a, const ParticleFields& b, double reach) {
    for (std::size_t q = 0; q < points_.size(); ++q)
      points_[q] = slave_.interpolate(quadrature_.facet_of(q), quadrature_.point(q).local, a.position);
    tracker_.update(master_, points_, b.position, reach, b.ranks);
  }

  /// Anchors each site's bonds, which start in the facet anchor_facet_, at the point of B that is nearest to where extension_ leads; clears extension_.
  void find_anchors(const TetheredBonds& law, const ParticleFields& b);

  FacetSurface<D> slave_, master_;
  FacetQuadrature<D> quadrature_;
  ClosestPointTracker<D> tracker_;
  Field points_;                       // of the quadrature
  std::vector<Index> point_of_;        // per site: its quadrature point
  std::vector<double> capacity_;       // receptors
  std::vector<double> bound_;          // bonds that hold
  std::vector<double> stored_;         // energy of the bonds when time last moved on, J
  std::vector<double> potential_;      // ½κ(|s| − ℓ)² of a bond of the mean extension s at that time, J
  std::vector<double> shown_;          // energy of the bonds at the last call, J
  std::vector<Index> anchor_facet_;    // of B, of the bonds that hold
  std::vector<Local> anchor_;          // place on that facet
  Field extension_, force_;            // per site, from anchor to site, m; on A, N
  std::vector<double> dissipated_, supplied_;  // in the last step, J
  double last_time_ = 0.0;
  std::uint64_t calls_ = 0;  // numbers the calls for the random numbers
};

/// Bonds that hold where they formed: a Contact in which the receptors of A's surface bind to *material points* of B's (or those of B's to points of A's: `sampled`), so that
/// bonds resist sliding as well as pulling off. (The law of a gap, such as LigandReceptor, lets surfaces slide freely.)
///
/// A receptor whose nearest point of B is closer than `capture_distance` binds to that point at the rate k_on, as a spring of
/// stiffness κ and rest length ℓ between the two material points. It pulls both along the line between them: momentum and
/// angular momentum are conserved to round-off. It breaks at the rate k_off of its tension (BondKinetics).
///
/// - *Mean field* (default): the receptors of a quadrature point share one extension, the mean of their own; a bond that forms
///   moves the mean anchor. Per quadrature point dn/dt = k_on (N − n) − k_off n, solved exactly for the rates of a step. The
///   mean force is exact for ℓ = 0 and rates that do not depend on the force; else bonds differ from their mean, and that is
///   neglected (stochastic bonds show by how much).
/// - *Stochastic*: every receptor binds and breaks by itself, by numbers that are drawn by seed, receptor and step: the same
///   for any number of threads.
///
/// Energy: what bonds store follows the work that is done on them, the spread of their extensions included. What is in bonds
/// that break is dissipated; what bonds hold as they form comes from outside (external power). Rates times the step should be
/// small: kinetics are first order in the step, and so is the balance of energy in what bonds take in and lose.
struct TetheredBonds {
  static constexpr Reads reads_a = Reads::facets;  ///< the surface of A
  static constexpr Reads reads_b = Reads::facets;  ///< the surface of B
  double density = 1e14;             ///< receptors per reference area of their surface, 1/m² (plane: 1/m); > 0
  double stiffness = 1e-3;           ///< κ of a bond, N/m; >= 0
  double rest_length = 0.0;          ///< ℓ, m; >= 0
  double capture_distance = 30e-9;   ///< gap below which bonds form, m; > 0
  BondKinetics kinetics{};           ///< rates
  bool stochastic = false;           ///< every bond by itself
  std::uint64_t seed = 1;            ///< of the stochastic bonds
  int points_per_direction = 2;      ///< quadrature points along each side of a facet, 1 to 4
  ContactSide sampled = ContactSide::first;  ///< whose surface has the receptors, A's or B's; not both
  PerDimension<TetherSites> sites{};  ///< set by initialize()

  /// Throws ParameterError for a value out of its range.
  void validate() const;

  /// Tension of a bond of length r, N; negative where it is compressed.
  [[nodiscard]] double tension(double r) const { return stiffness * (r - rest_length); }
  /// Energy of a bond of length r, J.
  [[nodiscard]] double potential(double r) const { return 0.5 * stiffness * (r - rest_length) * (r - rest_length); }

  /// Throws ParameterError, and GeometryError for clouds without facets.
  template <int D>
    requires(D >= 2)
  void initialize(const PointCloud<D>& cloud_a, const ParticleFields& a, const PointCloud<D>& cloud_b, const ParticleFields& b);
  /// Forces of the bonds at the present positions, after the kinetics of the time since the last call.
  TermEnergy apply(const ParticleFields& a, const ParticleFields& b, double time);
  /// A's particles slid along its surface. The receptors and the bonds of each part of it go to the sites that cover it now: their numbers, and
  /// what bonds store, stay. The bonds that meet in a site have the mean of their extensions, and are anchored where that leads. Where B has the
  /// receptors, bonds stay in their sites, and their anchors in their places of A's surface.
  void redistribute(const SurfaceTransfer& surface, const ParticleFields& a, const ParticleFields& b);
  /// Throws ParameterError for stochastic bonds of A: each is at its place of a facet.
  void require_redistributable() const {
    if (stochastic && sampled == ContactSide::first) throw ParameterError("Redistribution: stochastic TetheredBonds keep their places on the facets; use the mean field.");
  }
  /// Bound of ω², 1/s².
  [[nodiscard]] double stiffness_rate(const ParticleFields& a, const ParticleFields& b) const;
  /// Of the bonds that hold, at the last call of apply; exact.
  template <class Emit>
  void add_stiffness(const ParticleFields&, const ParticleFields&, const Emit& emit) const {
    sites.visit([&](const auto& s) {
      if (sampled == ContactSide::first) s.add_stiffness(*this, emit);
      else s.add_stiffness(*this, detail::exchanged(emit));
    });
  }
  /// Bonds that hold.
  [[nodiscard]] double bonds() const;
  /// What a checkpoint keeps.
  template <class Archive>
  void state(Archive& archive) {
    archive.expect("receptors_on", sampled == ContactSide::first ? 0 : 1);
    archive.part("sites", sites);
  }
};
template <int D>
template <class Emit>
void TetherSites<D>::add_stiffness(const TetheredBonds& law, const Emit& emit) const {
  for (std::size_t s = 0; s < size(); ++s) {
    const Vector3 extension = extension_[s].template head<3>();
    const double r = extension.norm();
    if (!(bound_[s] > 0.0) || !(r > 0.0)) continue;
    const Tensor3 along = extension * extension.transpose() / (r * r);
    const Tensor3 k = bound_[s] * (law.stiffness * along + law.tension(r) / r * (Tensor3::Identity() - along));
    const std::size_t q = point_of_[s];
    detail::emit_spring(slave_.facets[quadrature_.facet_of(q)], quadrature_.point(q).shape, master_.facets[anchor_facet_[s]],
                        FacetSurface<D>::shape(anchor_[s]), k, emit);
  }
}

static_assert(Contact<TetheredBonds, 2> && Contact<TetheredBonds, 3>);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/tethered_bonds.ipp>
#endif
