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
  locate(slave);
  tracker_.search(master_, points_, master.position, reach);
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
