#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/van_der_waals.hpp>

namespace tactoid {

template <int D>
void ParticlesOnSurface<D>::update(std::span<const Vector4> particles, std::span<const Vector4> surface, Ranks* ranks) {
  tracker.update(master, particles, surface, std::numeric_limits<double>::infinity(), ranks);
  gaps.resize(particles.size());
  const auto closest = tracker.closest();
  for (std::size_t i = 0; i < gaps.size(); ++i) gaps[i] = closest[i].gap;
}

TACTOID_INLINE TermEnergy VanDerWaals::apply(const ParticleFields& a, const ParticleFields& b, double) {
  return particles.visit([&](auto& p) { return apply_to(p, a, b); });
}

TACTOID_INLINE double VanDerWaals::stiffness_rate(const ParticleFields& a, const ParticleFields& b) const {
  return particles.visit([&](const auto& p) { return rate_of(p, a, b); });
}

TACTOID_INLINE std::span<const double> VanDerWaals::gaps() const {
  return particles.visit([](const auto& p) { return std::span<const double>(p.gaps); });
}

template <int D>
  requires(D >= 2)
void VanDerWaals::initialize(const PointCloud<D>&, const ParticleFields& a, const PointCloud<D>& cloud_b, const ParticleFields& b) {
  validate();
  auto& p = particles.emplace<D>();
  p.master = FacetSurface<D>(cloud_b);
  p.update(a.position, b.position);
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template class ParticlesOnSurface<2>;
template class ParticlesOnSurface<3>;
template void VanDerWaals::initialize<2>(const PointCloud<2>&, const ParticleFields& a, const PointCloud<2>& cloud_b, const ParticleFields& b);
template void VanDerWaals::initialize<3>(const PointCloud<3>&, const ParticleFields& a, const PointCloud<3>& cloud_b, const ParticleFields& b);
}  // namespace tactoid
#endif
