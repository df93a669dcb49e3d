#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <tactoid/contact/contact.hpp>
#include <tactoid/contact/facet_derivatives.hpp>
#include <tactoid/contact/forces_found.hpp>
#include <tactoid/contact/gap_law.hpp>
#include <tactoid/contact/per_dimension.hpp>
#include <tactoid/contact/surface.hpp>
#include <tactoid/contact/surface_transfer.hpp>
#include <tactoid/contact/tracking.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/geometry/particle_fields.hpp>

namespace tactoid {

/// The area that a traction acts on.
enum class ContactArea {
  reference,  ///< per reference area: the force is exactly the gradient of the energy Σ A_q Φ(gap_q)
  current,    ///< per current area (Nanson): a traction, not a gradient; the energy Σ a_q Φ changes also with
              ///< the area a_q, and that power, Σ ȧ_q Φ, is reported as external power
  mobile      ///< per current area, of which there are as many bonds everywhere: a fluid surface, in which receptors drift. The force is
              ///< exactly the gradient of the energy Σ a_q Φ(gap_q): beside the traction it lowers the tension of the sampled surface by −Φ where it adheres,
              ///< which Young's equation needs
};

/// On whose facets the gaps of bodies A and B are sampled, and bonds counted. Forces are exact gradients in each case; they jump where the nearest
/// facet of the *other* surface changes in a concave place. So sample the surface that is hollow, or that carries the ligands, against the one that is round.
enum class ContactSide {
  first,   ///< A's: bonds per area of A
  second,  ///< B's: bonds per area of B
  both     ///< both, with half the weight each
};

/// One side of a contact: the quadrature points on the facets of one body (the slave) against the facets of the
/// other (the master). The force f = A_q t(g) n at a point is handed to the slave's nodes by its facet's shape
/// functions, its opposite to the master's nodes by the shape functions at the closest point; since g is
/// stationary in the closest point, this is the exact gradient of A_q Φ(g) in the positions of both bodies.
template <int D>
class ContactPass {
 public:
  /// Builds both surfaces and looks for all closest points. `reach` (m): gaps beyond it need not be followed. Throws
  /// GeometryError for a cloud without facets or with periodic directions, ParameterError unless points_per_direction
  /// is 1 to 4.
  void initialize(const PointCloud<D>& slave_cloud, const ParticleFields& slave, const PointCloud<D>& master_cloud,
                  const ParticleFields& master, int points_per_direction, double reach);

  /// Adds the forces of `law`, times `factor`, to both bodies.
  template <GapLaw Law>
  TermEnergy apply(const Law& law, const ParticleFields& slave, const ParticleFields& master, ContactArea area,
                   double factor) {
    parallel_for(points_.size(), [&](std::size_t q) { locate(slave, q); });
    tracker_.update(master_, points_, master.position, law.reach(), master.ranks);
    const auto closest = tracker_.closest();
    parallel_for(points_.size(), [&](std::size_t q) { evaluate(law, slave, area, factor, q); });
    TermEnergy total;
    for (std::size_t q = 0; q < points_.size(); ++q) {
      const State& s = states_[q];
      total.potential += s.energy;
      total.external_power += s.area_power;
      if (area == ContactArea::mobile && closest[q].gap < law.reach()) {
        const auto& nodes = slave_.facets[quadrature_.facet_of(q)];
        for (std::size_t k = 0; k < nodes.size(); ++k) slave.force[nodes[k]].template head<3>() += s.along[k];
      }
      if (s.force == 0.0) continue;
      const Vector4 force = pad(Vector3(s.force * closest[q].normal));
      const auto& from = slave_.facets[quadrature_.facet_of(q)];
      const auto& onto = master_.facets[closest[q].facet];
      const auto& n = quadrature_.point(q).shape;
      const auto m = FacetSurface<D>::shape(closest[q].local);
      for (std::size_t k = 0; k < from.size(); ++k) {
        slave.force[from[k]] += n[k] * force;
        master.force[onto[k]] -= m[k] * force;
      }
    }
    return total;
  }

  /// The same where each of several processes does so for the facets that belong to it, by their first node: it tells what it has found, and adds nothing. Collective.
  template <GapLaw Law>
  TermEnergy find(const Law& law, const ParticleFields& slave, const ParticleFields& master, ContactArea area, double factor, ForcesFound& on_slave,
                  ForcesFound& on_master) {
    follow_own(slave, master, law.reach());
    const auto closest = tracker_.closest();
    parallel_for(own_.size(), [&](std::size_t k) { evaluate(law, slave, area, factor, own_[k]); });
    TermEnergy total;
    for (const Index q : own_) {
      const State& s = states_[q];
      total.potential += s.energy;
      total.external_power += s.area_power;
      if (!(closest[q].gap < law.reach())) continue;
      const double stiffness = 2.0 * factor * s.area * law.stiffness(closest[q].gap);
      const Vector3 force = s.force * closest[q].normal;
      const auto& from = slave_.facets[quadrature_.facet_of(q)];
      const auto& onto = master_.facets[closest[q].facet];
      const auto& n = quadrature_.point(q).shape;
      const auto m = FacetSurface<D>::shape(closest[q].local);
      for (std::size_t k = 0; k < from.size(); ++k) {
        on_slave.add(from[k], area == ContactArea::mobile ? Vector3(n[k] * force + s.along[k]) : Vector3(n[k] * force), stiffness * n[k]);
        on_master.add(onto[k], -m[k] * force, stiffness * m[k]);
      }
    }
    return total;
  }
  /// Makes the closest points that each process follows known to all. Collective.
  void tell_own(Ranks& ranks) { tracker_.tell_own(ranks, own_); }

  /// Row sums of the stiffness (N/m) at the gaps of the last step, added per particle: Gershgorin's bound of
  /// ω² is their largest ratio to the mass. The turning of the normal around edges and corners is left out: it is
  /// confined to where they are closest.
  template <GapLaw Law>
  void add_stiffness(const Law& law, double factor, std::vector<double>& slave, std::vector<double>& master) const {
    const auto closest = tracker_.closest();
    for (std::size_t q = 0; q < points_.size(); ++q) {
      const double gap = closest[q].gap;
      if (!(gap < law.reach())) continue;
      const double k = 2.0 * factor * states_[q].area * law.stiffness(gap);
      const auto& from = slave_.facets[quadrature_.facet_of(q)];
      const auto& onto = master_.facets[closest[q].facet];
      const auto& n = quadrature_.point(q).shape;
      const auto m = FacetSurface<D>::shape(closest[q].local);
      for (std::size_t c = 0; c < from.size(); ++c) {
        slave[from[c]] += k * n[c];
        master[onto[c]] += k * m[c];
      }
    }
  }

  /// Emits −∂f/∂x at the last step: of the gap, of the turning normal and of the area where the force depends on it; exact where the law's stiffness is.
  template <GapLaw Law, class Emit>
  void emit_stiffness(const Law& law, const ParticleFields& slave, const ParticleFields& master, ContactArea area, double factor, const Emit& emit) const {
    constexpr std::size_t corners = FacetSurface<D>::corners;
    const auto closest = tracker_.closest();
    for (std::size_t q = 0; q < points_.size(); ++q) {
      const double gap = closest[q].gap;
      if (!(gap < law.reach())) continue;
      const auto& point = quadrature_.point(q);
      const Index facet = quadrature_.facet_of(q);
      const auto g = gap_derivatives(master_, closest[q], master.position);
      const Vector3& n = closest[q].normal;
      // Of the potential Φ, by the gap.
      const auto& from = slave_.facets[facet];
      const auto& onto = master_.facets[closest[q].facet];
      const double first = -law.traction(gap), near = 1e-6 * std::max(std::abs(gap), (slave.position[from[0]] - slave.position[from[1]]).norm());
      const double second = std::copysign(law.stiffness(gap), law.traction(gap - near) - law.traction(gap + near));
      // The slave's nodes move the point, the master's the surface.
      std::array<double, 2 * corners> share;
      std::array<std::size_t, 2 * corners> at;
      for (std::size_t k = 0; k < corners; ++k) {
        share[k] = point.shape[k], at[k] = 0;
        share[corners + k] = 1.0, at[corners + k] = k + 1;
      }
      std::array<std::array<Tensor3, 2 * corners>, 2 * corners> K;
      for (std::size_t k = 0; k < K.size(); ++k)
        for (std::size_t l = 0; l < K.size(); ++l)
          K[k][l] = states_[q].area * share[k] * share[l] * (second * g.share[at[k]] * g.share[at[l]] * n * n.transpose() + first * g.second[at[k]][at[l]]);
      if (area != ContactArea::reference) {
        const FacetTangents x = slave_.tangents(facet, point.local, slave.position);
        const Vector3 c = x.area_vector();
        const auto slopes = area_slopes(slave_, point.local, x, c.normalized());
        for (std::size_t k = 0; k < K.size(); ++k)
          for (std::size_t l = 0; l < corners; ++l) {
            const Tensor3 mixed = (first * point.weight * share[k] * g.share[at[k]]) * n * slopes[l].transpose();
            K[k][l] += mixed;
            if (area == ContactArea::mobile) K[l][k] += mixed.transpose();
          }
        if (area == ContactArea::mobile) {
          const auto curvatures = area_curvatures(slave_, point.local, x, c.norm());
          for (std::size_t k = 0; k < corners; ++k)
            for (std::size_t l = 0; l < corners; ++l) K[k][l] += law.potential(gap) * point.weight * curvatures[k][l];
        }
      }
      for (std::size_t k = 0; k < K.size(); ++k)
        for (std::size_t l = 0; l < K.size(); ++l)
          emit(k >= corners, k < corners ? from[k] : onto[k - corners], l >= corners, l < corners ? from[l] : onto[l - corners], Tensor3(factor * K[k][l]));
    }
  }

  /// Closest points of the slave's quadrature points, facet by facet.
  [[nodiscard]] std::span<const ClosestPoint<D>> closest() const { return tracker_.closest(); }
  [[nodiscard]] const FacetSurface<D>& slave() const { return slave_; }               ///< whose quadrature points are tried
  [[nodiscard]] const FacetSurface<D>& master() const { return master_; }             ///< on which they look for closest points
  [[nodiscard]] const FacetQuadrature<D>& quadrature() const { return quadrature_; }  ///< of the slave's facets

  /// The slave's particles slid along its surface: the reference area of each point is that of the matter that is there now.
  void redistribute(const SurfaceTransfer& surface) { quadrature_.area = surface.carry(quadrature_.weights(), quadrature_.area); }

  /// For checkpoints: the closest points that are followed, and the areas, which redistribution changes.
  template <class Archive>
  void state(Archive& archive) {
    archive.part("tracker", tracker_);
    archive("area", quadrature_.area);
  }

 private:
  struct State {
    double area = 0.0, force = 0.0, energy = 0.0, area_power = 0.0;
    std::array<Vector3, FacetSurface<D>::corners> along{};  // on the nodes, of the tension that adhesion takes away (ContactArea::mobile)
  };
  void locate(const ParticleFields& slave, std::size_t q) {
    points_[q] = slave_.interpolate(quadrature_.facet_of(q), quadrature_.point(q).local, slave.position);
  }
  /// Brings the closest points of own points to the present positions.
  void follow_own(const ParticleFields& slave, const ParticleFields& master, double reach);

  /// What the law says at point q.
  template <GapLaw Law>
  void evaluate(const Law& law, const ParticleFields& slave, ContactArea area, double factor, std::size_t q) {
    State& s = states_[q];
    const double gap = tracker_.closest()[q].gap;
    s.force = s.energy = s.area_power = 0.0;
    if (gap >= law.reach()) return;
    const double density = law.potential(gap);
    double a = quadrature_.area[q];
    if (area == ContactArea::mobile) {
      const auto& p = quadrature_.point(q);
      const Index f = quadrature_.facet_of(q);
      const FacetTangents x = slave_.tangents(f, p.local, slave.position);
      const Vector3 c = x.area_vector();
      a = p.weight * c.norm();
      const auto slopes = area_slopes(slave_, p.local, x, c.normalized());
      for (std::size_t k = 0; k < slopes.size(); ++k) s.along[k] = (-factor * density * p.weight) * slopes[k];
    } else if (area == ContactArea::current) {
      const auto& p = quadrature_.point(q);
      const FacetTangents x = slave_.tangents(quadrature_.facet_of(q), p.local, slave.position);
      const FacetTangents v = slave_.tangent_rates(quadrature_.facet_of(q), p.local, slave.velocity);
      const Vector3 normal = x.area_vector();
      a = p.weight * normal.norm();
      s.area_power = factor * p.weight * density * normal.normalized().dot(v.s.cross(x.t) + x.s.cross(v.t));
    }
    s.area = a;
    s.force = factor * a * law.traction(gap);
    s.energy = factor * a * density;
  }

  FacetSurface<D> slave_, master_;
  FacetQuadrature<D> quadrature_;
  ClosestPointTracker<D> tracker_;
  Field points_;
  std::vector<State> states_;
  std::vector<Index> own_;                         // points of this process, where each finds some
  const std::vector<Index>* own_of_ = nullptr;     // the particles that they are points of
};

/// The passes of a contact: body A's facets against B's, B's against A's, or both with half the weight each.
class SurfaceContactEngine {
 public:
  /// Validates the law and builds the passes; throws what they throw.
  template <int D, GapLaw Law>
  void initialize(const Law& law, const PointCloud<D>& cloud_a, const ParticleFields& a, const PointCloud<D>& cloud_b,
                  const ParticleFields& b, int points_per_direction, ContactSide sampled) {
    law.validate();
    forth_ = back_ = {};
    if (sampled != ContactSide::second) forth_.emplace<D>().initialize(cloud_a, a, cloud_b, b, points_per_direction, law.reach());
    if (sampled != ContactSide::first) back_.emplace<D>().initialize(cloud_b, b, cloud_a, a, points_per_direction, law.reach());
  }

  /// Adds the forces of the passes; returns their energy, and the power of growing areas.
  template <GapLaw Law>
  TermEnergy apply(const Law& law, const ParticleFields& a, const ParticleFields& b, ContactArea area) {
    divided_ = a.own != nullptr && b.own != nullptr && points() >= a.ranks->divided_contacts_from;
    if (divided_) return apply_own(law, a, b, area);
    TermEnergy total;
    if (first_sampled()) total += forth_.visit([&](auto& pass) { return pass.apply(law, a, b, area, factor()); });
    if (!back_.empty()) total += back_.visit([&](auto& pass) { return pass.apply(law, b, a, area, factor()); });
    return total;
  }

  /// A's particles slid along its surface; see ContactPass. Bonds that are counted on B stay where they are.
  void redistribute(const SurfaceTransfer& surface);

  /// Gershgorin's bound of ω² at the gaps of the last call of apply, 1/s².
  template <GapLaw Law>
  double stiffness_rate(const Law& law, const ParticleFields& a, const ParticleFields& b) const {
    if (divided_) return rate_;
    std::vector<double> sum_a(a.mass.size(), 0.0), sum_b(b.mass.size(), 0.0);
    if (first_sampled()) forth_.visit([&](const auto& pass) { pass.add_stiffness(law, factor(), sum_a, sum_b); });
    if (!back_.empty()) back_.visit([&](const auto& pass) { pass.add_stiffness(law, factor(), sum_b, sum_a); });
    double rate = 0.0;
    for (std::size_t i = 0; i < sum_a.size(); ++i) rate = std::max(rate, sum_a[i] / a.mass[i]);
    for (std::size_t i = 0; i < sum_b.size(); ++i) rate = std::max(rate, sum_b[i] / b.mass[i]);
    return rate;
  }

  /// Emits the stiffness of the passes; see ContactPass::emit_stiffness.
  template <GapLaw Law, class Emit>
  void emit_stiffness(const Law& law, const ParticleFields& a, const ParticleFields& b, ContactArea area, const Emit& emit) const {
    if (first_sampled()) forth_.visit([&](const auto& pass) { pass.emit_stiffness(law, a, b, area, factor(), emit); });
    if (!back_.empty()) back_.visit([&](const auto& pass) { pass.emit_stiffness(law, b, a, area, factor(), detail::exchanged(emit)); });
  }

  /// Makes the closest points that each process follows known to all. Collective.
  void tell_own(Ranks& ranks);

  /// The pass of A's facets (of B's, where these alone are sampled): closest points, quadrature, surfaces, as f(const ContactPass<D>&).
  template <class F>
  decltype(auto) visit(F&& f) const {
    return (first_sampled() ? forth_ : back_).visit(std::forward<F>(f));
  }

  /// For checkpoints: those of the passes.
  template <class Archive>
  void state(Archive& archive) {
    archive.expect("passes", (forth_.empty() ? 0 : 1) + (back_.empty() ? 0 : 2));
    archive.part("forth", forth_);
    archive.part("back", back_);
  }

 private:
  [[nodiscard]] bool first_sampled() const { return !forth_.empty() || back_.empty(); }  // before initialize() too: visit() throws then
  [[nodiscard]] double factor() const { return forth_.empty() || back_.empty() ? 1.0 : 0.5; }

  /// Number of sampled points.
  [[nodiscard]] std::size_t points() const {
    const auto of = [](const auto& passes) { return passes.empty() ? std::size_t{0} : passes.visit([](const auto& pass) { return pass.quadrature().size(); }); };
    return of(forth_) + of(back_);
  }
  template <GapLaw Law>
  TermEnergy apply_own(const Law& law, const ParticleFields& a, const ParticleFields& b, ContactArea area) {
    TermEnergy total;
    if (first_sampled()) total += forth_.visit([&](auto& pass) { return pass.find(law, a, b, area, factor(), on_a_, on_b_); });
    if (!back_.empty()) total += back_.visit([&](auto& pass) { return pass.find(law, b, a, area, factor(), on_b_, on_a_); });
    const double rate = bring_to_owners(on_a_, a, on_b_, b);
    const std::vector<double> all = a.ranks->gather_from_each(std::array{total.potential, total.external_power, rate});
    total = {};
    rate_ = 0.0;
    for (std::size_t k = 0; k < all.size(); k += 3) {
      total.potential += all[k];
      total.external_power += all[k + 1];
      rate_ = std::max(rate_, all[k + 2]);
    }
    return total;
  }

  PerDimension<ContactPass> forth_, back_;
  ForcesFound on_a_, on_b_;
  bool divided_ = false;  // each process finds the forces at its own facets
  double rate_ = 0.0;     // of all processes at the last call of apply, where they are divided
};

/// A Contact in 2 and 3 dimensions from any GapLaw: `SurfaceContact{.law = MyLaw{…}}`.
template <GapLaw Law>
struct SurfaceContact {
  static constexpr Reads reads_a = Reads::facets;  ///< the surface of A
  static constexpr Reads reads_b = Reads::facets;  ///< the surface of B
  Law law{};                                  ///< of the gap
  ContactArea area = ContactArea::reference;  ///< what the law's traction is per
  ContactSide sampled = ContactSide::first;   ///< on whose facets
  int points_per_direction = 2;               ///< Gauss points along each side of a facet, 1 to 4
  SurfaceContactEngine engine{};              ///< set by initialize()

  /// Throws ParameterError where the law does, GeometryError for a cloud without facets or with periodic directions.
  template <int D>
    requires(D >= 2)
  void initialize(const PointCloud<D>& cloud_a, const ParticleFields& a, const PointCloud<D>& cloud_b,
                  const ParticleFields& b) {
    engine.initialize<D>(law, cloud_a, a, cloud_b, b, points_per_direction, sampled);
  }
  /// See SurfaceContactEngine.
  TermEnergy apply(const ParticleFields& a, const ParticleFields& b, double) { return engine.apply(law, a, b, area); }
  /// Bound of ω² at the present gaps, 1/s².
  [[nodiscard]] double stiffness_rate(const ParticleFields& a, const ParticleFields& b) const {
    return engine.stiffness_rate(law, a, b);
  }
  /// At the gaps of the last call of apply; see ContactPass::emit_stiffness.
  template <class Emit>
  void add_stiffness(const ParticleFields& a, const ParticleFields& b, const Emit& emit) const {
    engine.emit_stiffness(law, a, b, area, emit);
  }
  /// See SurfaceContactEngine.
  void redistribute(const SurfaceTransfer& surface, const ParticleFields&, const ParticleFields&) { engine.redistribute(surface); }
  /// See SurfaceContactEngine.
  void tell_own(Ranks& ranks, const std::vector<Index>&) { engine.tell_own(ranks); }
  /// For checkpoints: the closest points that are followed.
  template <class Archive>
  void state(Archive& archive) { archive.part("engine", engine); }
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/surface_contact.ipp>
#endif
