#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/tethered_bonds.hpp>

namespace tactoid {

TACTOID_INLINE void BondKinetics::validate() const {
  require_non_negative("BondKinetics.on_rate", on_rate, "1/s");
  require_non_negative("BondKinetics.off_rate", off_rate, "1/s");
  if (!(slip_force > 0.0)) reject("BondKinetics.slip_force", slip_force, "N", "positive (infinite: force does not matter)");
  require_non_negative("BondKinetics.catch_rate", catch_rate, "1/s");
  require_positive("BondKinetics.catch_force", catch_force, "N");
}

TACTOID_INLINE void TetheredBonds::validate() const {
  require_positive("TetheredBonds.density", density, "1/m^2");
  require_non_negative("TetheredBonds.stiffness", stiffness, "N/m");
  require_non_negative("TetheredBonds.rest_length", rest_length, "m");
  require_positive("TetheredBonds.capture_distance", capture_distance, "m");
  kinetics.validate();
  if (sampled == ContactSide::both) throw ParameterError("TetheredBonds.sampled = both is not allowed: receptors are on the first or on the second body.");
}

TACTOID_INLINE double TetheredBonds::bonds() const {
  return sites.visit([](const auto& s) {
    double sum = 0.0;
    for (const double n : s.bound()) sum += n;
    return sum;
  });
}

template <int D>
void TetherSites<D>::initialize(const TetheredBonds& law, const PointCloud<D>& cloud_a, const ParticleFields& a,
                                const PointCloud<D>& cloud_b, const ParticleFields& b) {
  slave_ = FacetSurface<D>(cloud_a);
  master_ = FacetSurface<D>(cloud_b);
  quadrature_ = FacetQuadrature<D>(slave_, a.reference, law.points_per_direction);
  points_.resize(quadrature_.size());
  Random random(law.seed);
  for (std::size_t q = 0; q < quadrature_.size(); ++q) {
    const double receptors = law.density * quadrature_.area[q];
    if (!law.stochastic) {
      point_of_.push_back(static_cast<Index>(q));
      capacity_.push_back(receptors);
      continue;
    }
    const auto whole = static_cast<std::size_t>(receptors + random.uniform());  // the right number on average
    point_of_.insert(point_of_.end(), whole, static_cast<Index>(q));
    capacity_.insert(capacity_.end(), whole, 1.0);
  }
  const std::size_t n = size();
  bound_.assign(n, 0.0);
  stored_ = potential_ = shown_ = dissipated_ = supplied_ = bound_;
  anchor_facet_.assign(n, 0);
  anchor_.assign(n, Local{});
  extension_.assign(n, Vector4::Zero());
  force_ = extension_;
  locate(a, b, law.capture_distance);
}

template <int D>
TermEnergy TetherSites<D>::apply(const TetheredBonds& law, const ParticleFields& a, const ParticleFields& b,
                                 double time) {
  locate(a, b, law.capture_distance);
  const double step = std::max(0.0, time - last_time_);  // after a step that broke down, time has gone back
  last_time_ = time;
  const auto closest = tracker_.closest();
  const auto extension = [&](std::size_t s, const Vector4& at) {
    return Vector4(at - master_.interpolate(anchor_facet_[s], anchor_[s], b.position));
  };
  // What the time of the step does to the bonds of a site, at the rate `off` of those that hold.
  const auto kinetics = [&](std::size_t s, const Vector4& at, const ClosestPoint<D>& nearest, double off) {
    double& n = bound_[s];
    const double on = nearest.gap < law.capture_distance ? law.kinetics.on_rate : 0.0, free = capacity_[s] - n;
    double left = n * std::exp(-off * step), joined = 0.0;
    if (law.stochastic) {
      const double drawn = Random(law.seed + 0x9e3779b97f4a7c15ULL * (calls_ * size() + s + 1)).uniform();
      left = n > 0.0 && drawn < std::exp(-off * step) ? 1.0 : 0.0;
      joined = free > 0.0 && drawn < -std::expm1(-on * step) ? 1.0 : 0.0;
    } else if (on > 0.0) {
      const double rest = capacity_[s] * on / (on + off);
      joined = std::max(0.0, rest + (n - rest) * std::exp(-(on + off) * step) - left);
    }
    if (n > 0.0) dissipated_[s] = shown_[s] * (n - left) / n;
    shown_[s] -= dissipated_[s];
    supplied_[s] = joined * law.potential((at.template head<3>() - nearest.point).norm());
    shown_[s] += supplied_[s];
    if (joined > 0.0) {
      if (left > 0.0) {
        const Vector4 anchor = at - extension(s, at);
        const Vector3 mean = (left * anchor.template head<3>() + joined * nearest.point) / (left + joined);
        const ClosestPoint<D> place = ClosestPointTracker<D>::walk(master_, anchor_facet_[s], b.position, mean);
        anchor_facet_[s] = place.facet;
        anchor_[s] = place.local;
      } else {
        anchor_facet_[s] = nearest.facet;
        anchor_[s] = nearest.local;
      }
    }
    n = left + joined;
    stored_[s] = shown_[s];
  };
  parallel_for(size(), [&](std::size_t s) {
    const Vector4 at = points_[point_of_[s]];
    const ClosestPoint<D>& nearest = closest[point_of_[s]];
    const double& n = bound_[s];
    dissipated_[s] = supplied_[s] = shown_[s] = 0.0;
    if (!(n > 0.0) && !(nearest.gap < law.capture_distance)) return;
    shown_[s] = stored_[s];
    double off = law.kinetics.detachment_rate(0.0);
    if (n > 0.0) {  // the motion has done work on the bonds
      const double r = extension(s, at).norm();
      shown_[s] += n * (law.potential(r) - potential_[s]);
      off = law.kinetics.detachment_rate(law.tension(r));
    }
    const bool moved_on = step > 0.0;  // else positions are tried, and the bonds stay as they are
    if (moved_on) kinetics(s, at, nearest, off);
    extension_[s] = force_[s] = Vector4::Zero();
    if (!(n > 0.0)) return;
    extension_[s] = extension(s, at);
    const double r = extension_[s].norm();
    if (moved_on) potential_[s] = law.potential(r);
    if (r > 0.0) force_[s] = (-n * law.tension(r) / r) * extension_[s];
  });
  ++calls_;
  TermEnergy total;
  for (std::size_t s = 0; s < size(); ++s) {
    total.potential += shown_[s];
    if (step > 0.0) {
      total.dissipated_power += dissipated_[s] / step;
      total.external_power += supplied_[s] / step;
    }
    if (!(bound_[s] > 0.0)) continue;
    const std::size_t q = point_of_[s];
    const auto& from = slave_.facets[quadrature_.facet_of(q)];
    const auto& onto = master_.facets[anchor_facet_[s]];
    const auto& shape = quadrature_.point(q).shape;
    const auto anchored = FacetSurface<D>::shape(anchor_[s]);
    for (std::size_t c = 0; c < from.size(); ++c) {
      a.force[from[c]] += shape[c] * force_[s];
      b.force[onto[c]] -= anchored[c] * force_[s];
    }
  }
  return total;
}

template <int D>
void TetherSites<D>::redistribute(const TetheredBonds& law, const SurfaceTransfer& surface, const ParticleFields& a,
                                  const ParticleFields& b) {
  const std::vector<double> weights = quadrature_.weights();
  std::vector<double> bound(size(), 0.0);
  Field extension(size(), Vector4::Zero());
  std::vector<double> most(size(), 0.0);
  std::vector<Index> from_site(size(), 0);
  surface.for_each_share(weights, [&](std::size_t to, std::size_t from, double share) {
    const double n = share * bound_[from];
    bound[to] += n;
    extension[to] += n * extension_[from];
    if (n > most[to]) most[to] = n, from_site[to] = static_cast<Index>(from);
  });
  quadrature_.area = surface.carry(weights, quadrature_.area);
  capacity_ = surface.carry(weights, capacity_);
  stored_ = surface.carry(weights, stored_);
  locate(a, b, law.capture_distance);
  const std::vector<Index> facet = anchor_facet_;
  for (std::size_t s = 0; s < size(); ++s) {
    bound_[s] = bound[s];
    if (!(bound[s] > 0.0)) continue;
    extension_[s] = extension[s] / bound[s];
    anchor_facet_[s] = facet[from_site[s]];
  }
  find_anchors(law, b);
}

template <int D>
void TetherSites<D>::redistribute_anchors(const TetheredBonds& law, const ParticleFields& a, const ParticleFields& b) {
  locate(a, b, law.capture_distance);
  find_anchors(law, b);
}

template <int D>
void TetherSites<D>::find_anchors(const TetheredBonds& law, const ParticleFields& b) {
  for (std::size_t s = 0; s < size(); ++s) {
    const Vector4& at = points_[point_of_[s]];
    const Vector4 anchor = at - extension_[s];
    extension_[s] = force_[s] = Vector4::Zero();
    if (!(bound_[s] > 0.0)) continue;
    const ClosestPoint<D> place = ClosestPointTracker<D>::walk(master_, anchor_facet_[s], b.position, Vector3(anchor.template head<3>()));
    anchor_facet_[s] = place.facet;
    anchor_[s] = place.local;
    potential_[s] = law.potential((at - master_.interpolate(place.facet, place.local, b.position)).norm());
  }
  shown_ = stored_;
}

template <int D>
double TetherSites<D>::stiffness_rate(const TetheredBonds& law, const ParticleFields& a,
                                      const ParticleFields& b) const {
  std::vector<double> on_a(a.mass.size(), 0.0), on_b(b.mass.size(), 0.0);
  const auto closest = tracker_.closest();
  for (std::size_t s = 0; s < size(); ++s) {
    const std::size_t q = point_of_[s];
    const bool near = closest[q].gap < 2.0 * law.capture_distance;
    if (!near && !(bound_[s] > 0.0)) continue;
    const double k = 2.0 * capacity_[s] * law.stiffness;
    const auto& from = slave_.facets[quadrature_.facet_of(q)];
    const auto& onto = master_.facets[bound_[s] > 0.0 ? anchor_facet_[s] : closest[q].facet];
    const auto& shape = quadrature_.point(q).shape;
    const auto anchored = FacetSurface<D>::shape(bound_[s] > 0.0 ? anchor_[s] : closest[q].local);
    for (std::size_t c = 0; c < from.size(); ++c) {
      on_a[from[c]] += k * shape[c];
      on_b[onto[c]] += k * anchored[c];
    }
  }
  double rate = 0.0;
  for (std::size_t i = 0; i < on_a.size(); ++i) rate = std::max(rate, on_a[i] / a.mass[i]);
  for (std::size_t i = 0; i < on_b.size(); ++i) rate = std::max(rate, on_b[i] / b.mass[i]);
  return rate;
}

TACTOID_INLINE TermEnergy TetheredBonds::apply(const ParticleFields& a, const ParticleFields& b, double time) {
  return sites.visit([&](auto& s) { return sampled == ContactSide::first ? s.apply(*this, a, b, time) : s.apply(*this, b, a, time); });
}

TACTOID_INLINE void TetheredBonds::redistribute(const SurfaceTransfer& surface, const ParticleFields& a,
                                                const ParticleFields& b) {
  sites.visit([&](auto& s) {
    if (sampled == ContactSide::first) s.redistribute(*this, surface, a, b);
    else s.redistribute_anchors(*this, b, a);
  });
}

TACTOID_INLINE double TetheredBonds::stiffness_rate(const ParticleFields& a, const ParticleFields& b) const {
  return sites.visit([&](const auto& s) { return sampled == ContactSide::first ? s.stiffness_rate(*this, a, b) : s.stiffness_rate(*this, b, a); });
}

template <int D>
  requires(D >= 2)
void TetheredBonds::initialize(const PointCloud<D>& cloud_a, const ParticleFields& a, const PointCloud<D>& cloud_b, const ParticleFields& b) {
  validate();
  if (sampled == ContactSide::first) sites.emplace<D>().initialize(*this, cloud_a, a, cloud_b, b);
  else sites.emplace<D>().initialize(*this, cloud_b, b, cloud_a, a);
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template class TetherSites<2>;
template class TetherSites<3>;
template void TetheredBonds::initialize<2>(const PointCloud<2>& cloud_a, const ParticleFields& a, const PointCloud<2>& cloud_b, const ParticleFields& b);
template void TetheredBonds::initialize<3>(const PointCloud<3>& cloud_a, const ParticleFields& a, const PointCloud<3>& cloud_b, const ParticleFields& b);
}  // namespace tactoid
#endif
