#pragma once

#include <cmath>

#include <tactoid/contact/surface_contact.hpp>
#include <tactoid/core/errors.hpp>

namespace tactoid {

/// Specific adhesion by ligand–receptor bonds as a law of the gap r: Zeng and Li, Soft Matter 2012, 8, 5765,
/// eqns (13)–(16),
///
///   N_b Φ(r) = N_b σ_b [(ε/r)⁴ − 2 (ε/r)²],      t = N_b (4 σ_b/ε) [(ε/r)⁵ − (ε/r)³],
///
/// attractive for r > ε. Its strongest attraction, N_b (4σ_b/ε) · 0.6^{3/2} · 0.4, is at r = √(5/3) ε; its work of
/// adhesion, from r = ε to infinity, is N_b σ_b. Below the floor gap the traction continues along its tangent and the
/// potential as the parabola that belongs to it: a point that penetrates is pushed back by a finite force
/// that grows with its depth. At the cutoff the potential is shifted to zero, by N_b Φ(cutoff) = −N_b σ_b · 0.005 with
/// the default, so that the energy is continuous; the traction left there, 10⁻³ of its peak, drops to zero.
struct LigandReceptorLaw {
  double bond_density = 500e12;       ///< N_b, bonds per area, 1/m²
  double binding_energy = 0.024e-18;  ///< σ_b, J (pN·µm)
  double range = 100e-9;              ///< ε, gap of lowest energy, m
  double floor = 0.3;                 ///< gap below which the traction is linear, × ε, in (0, 1)
  double cutoff = 20.0;               ///< gap beyond which there is no force, × ε, > √(5/3)

  /// Throws ParameterError for a value that is not in its range.
  void validate() const;

  [[nodiscard]] double reach() const { return cutoff * range; }  ///< cutoff ε, m

  /// N_b (Φ(g) − Φ(cutoff)), J/m².
  [[nodiscard]] double potential(double gap) const {
    if (gap >= reach()) return 0.0;
    const double r = gap / range;
    if (r >= floor) return bond_density * binding_energy * (well(r) - well(cutoff));
    const double below = r - floor;
    return bond_density * binding_energy *
           (well(floor) - well(cutoff) - below * (4.0 * pull(floor) + 2.0 * pull_slope(floor) * below));
  }

  /// t(g), Pa; positive pushes apart.
  [[nodiscard]] double traction(double gap) const {
    if (gap >= reach()) return 0.0;
    const double r = gap / range, scale = 4.0 * bond_density * binding_energy / range;
    return scale * (r >= floor ? pull(r) : pull(floor) + pull_slope(floor) * (r - floor));
  }

  /// |dt/dg|, Pa/m; below the floor that of the floor.
  [[nodiscard]] double stiffness(double gap) const {
    if (gap >= reach()) return 0.0;
    const double r = std::fmax(gap / range, floor);
    return 4.0 * bond_density * binding_energy / (range * range) * std::abs(pull_slope(r));
  }

  /// Gap of the strongest attraction, √(5/3) ε, m, and the attraction there, Pa (positive).
  [[nodiscard]] double peak_gap() const { return std::sqrt(5.0 / 3.0) * range; }
  [[nodiscard]] double peak_attraction() const { return -traction(peak_gap()); }  ///< largest attraction, Pa (positive)

 private:
  static double well(double r) {
    const double i2 = 1.0 / (r * r);
    return i2 * i2 - 2.0 * i2;
  }
  static double pull(double r) {
    const double i = 1.0 / r, i2 = i * i;
    return i * i2 * (i2 - 1.0);
  }
  static double pull_slope(double r) {
    const double i2 = 1.0 / (r * r);
    return i2 * i2 * (3.0 - 5.0 * i2);
  }
};

/// Ligand–receptor adhesion between the surfaces of bodies A and B (see LigandReceptorLaw): a Contact in 2 and 3
/// dimensions. The gap is measured from quadrature points on A's facets (or B's: `sampled`) to the nearest point of the other deformed
/// surface; the force on A has its exact opposite on B.
struct LigandReceptor {
  static constexpr Reads reads_a = Reads::facets;  ///< the surface of A
  static constexpr Reads reads_b = Reads::facets;  ///< the surface of B
  double bond_density = 500e12;               ///< N_b, bonds per area, 1/m²
  double binding_energy = 0.024e-18;          ///< σ_b, J (pN·µm)
  double range = 100e-9;                      ///< ε, gap of lowest energy, m
  double floor = 0.3;                         ///< gap below which the traction is linear, × ε, in (0, 1)
  double cutoff = 20.0;                       ///< gap beyond which there is no force, × ε, > √(5/3)
  ContactArea area = ContactArea::reference;  ///< bonds per reference or per current area, or mobile
  ContactSide sampled = ContactSide::first;   ///< on whose facets bonds are
  int points_per_direction = 2;               ///< Gauss points along each side of a facet, 1 to 4
  SurfaceContactEngine engine{};              ///< set by initialize()

  /// The law of the gap with these numbers.
  [[nodiscard]] LigandReceptorLaw law() const { return {bond_density, binding_energy, range, floor, cutoff}; }
  void validate() const { law().validate(); }  ///< throws ParameterError for a value that is not in its range

  /// Throws ParameterError for a value that is not in its range, GeometryError for a cloud without facets or with
  /// periodic directions.
  template <int D>
    requires(D >= 2)
  void initialize(const PointCloud<D>& cloud_a, const ParticleFields& a, const PointCloud<D>& cloud_b,
                  const ParticleFields& b);
  /// See SurfaceContactEngine.
  TermEnergy apply(const ParticleFields& a, const ParticleFields& b, double);
  /// Bonds are carried along with A's surface, also where particles slide along it: their number stays. Those on B's stay where they are.
  void redistribute(const SurfaceTransfer& surface, const ParticleFields&, const ParticleFields&);
  /// See SurfaceContactEngine.
  void tell_own(Ranks& ranks, const std::vector<Index>&) { engine.tell_own(ranks); }
  /// Bound of ω² at the present gaps, 1/s².
  [[nodiscard]] double stiffness_rate(const ParticleFields& a, const ParticleFields& b) const;
  /// At the gaps of the last call of apply; see ContactPass::emit_stiffness.
  template <class Emit>
  void add_stiffness(const ParticleFields& a, const ParticleFields& b, const Emit& emit) const {
    engine.emit_stiffness(law(), a, b, area, emit);
  }
  /// For checkpoints: the closest points that are followed.
  template <class Archive>
  void state(Archive& archive) { archive.part("engine", engine); }
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/ligand_receptor.ipp>
#endif
