#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/surface_contact.hpp>

namespace tactoid {

template <int D>
void ContactPass<D>::initialize(const PointCloud<D>& slave_cloud, const ParticleFields& slave, const PointCloud<D>& master_cloud,
                                const ParticleFields& master, int points_per_direction, double reach) {
  slave_ = FacetSurface<D>(slave_cloud);
  master_ = FacetSurface<D>(master_cloud);
  quadrature_ = FacetQuadrature<D>(slave_, slave.reference, points_per_direction);
  points_.resize(quadrature_.size());
  states_.resize(quadrature_.size());
  parallel_for(points_.size(), [&](std::size_t q) { locate(slave, q); });
  tracker_.search(master_, points_, master.position, reach);
}

template <int D>
void ContactPass<D>::follow_own(const ParticleFields& slave, const ParticleFields& master, double reach) {
  if (own_of_ != slave.own) {
    own_of_ = slave.own;
    own_.clear();
    for (std::size_t q = 0; q < points_.size(); ++q)
      if ((*slave.owner)[slave_.facets[quadrature_.facet_of(q)][0]] == slave.ranks->rank()) own_.push_back(static_cast<Index>(q));
  }
  parallel_for(own_.size(), [&](std::size_t k) { locate(slave, own_[k]); });
  tracker_.update_own(master_, points_, master.position, reach, *slave.ranks, own_);
}

TACTOID_INLINE void SurfaceContactEngine::tell_own(Ranks& ranks) {
  if (!divided_) return;
  if (!forth_.empty()) forth_.visit([&](auto& pass) { pass.tell_own(ranks); });
  if (!back_.empty()) back_.visit([&](auto& pass) { pass.tell_own(ranks); });
}

TACTOID_INLINE void SurfaceContactEngine::redistribute(const SurfaceTransfer& surface) {
  if (first_sampled()) forth_.visit([&](auto& pass) { pass.redistribute(surface); });
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template class ContactPass<2>;
template class ContactPass<3>;
}  // namespace tactoid
#endif
