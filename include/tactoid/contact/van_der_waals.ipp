#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/van_der_waals.hpp>

namespace tactoid {

template <int D>
void ParticlesOnSurface<D>::update(std::span<const Vector4> particles, std::span<const Vector4> surface, Ranks* ranks, const std::vector<Index>* own) {
  constexpr double everywhere = std::numeric_limits<double>::infinity();
  gaps.resize(particles.size());
  if (own != nullptr) {
    tracker.update_own(master, particles, surface, everywhere, *ranks, *own);
    for (const Index i : *own) gaps[i] = tracker.closest()[i].gap;
    return;
  }
  tracker.update(master, particles, surface, everywhere, ranks);
  for (std::size_t i = 0; i < gaps.size(); ++i) gaps[i] = tracker.closest()[i].gap;
}

template <int D>
void ParticlesOnSurface<D>::tell_own(Ranks& ranks, const std::vector<Index>& own) {
  tracker.tell_own(ranks, own);
  for (std::size_t i = 0; i < gaps.size(); ++i) gaps[i] = tracker.closest()[i].gap;
}

TACTOID_INLINE TermEnergy VanDerWaals::apply(const ParticleFields& a, const ParticleFields& b, double) {
  return particles.visit([&](auto& p) { return apply_to(p, a, b); });
}

TACTOID_INLINE double VanDerWaals::stiffness_rate(const ParticleFields& a, const ParticleFields& b) const {
  return particles.visit([&](const auto& p) { return rate_of(p, a, b); });
}

TACTOID_INLINE void VanDerWaals::tell_own(Ranks& ranks, const std::vector<Index>& own) {
  if (reads_own_alone()) particles.visit([&](auto& p) { p.tell_own(ranks, own); });
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
