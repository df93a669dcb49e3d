#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/ligand_receptor.hpp>

namespace tactoid {

TACTOID_INLINE void LigandReceptorLaw::validate() const {
  require_non_negative("LigandReceptor.bond_density", bond_density, "1/m^2");
  require_non_negative("LigandReceptor.binding_energy", binding_energy, "J");
  require_positive("LigandReceptor.range", range, "m");
  if (!(floor > 0.0 && floor < 1.0)) reject("LigandReceptor.floor", floor, "(x range)", "between 0 and 1");
  if (!(cutoff > std::sqrt(5.0 / 3.0)) || !std::isfinite(cutoff))
    reject("LigandReceptor.cutoff", cutoff, "(x range)",
           "finite and above sqrt(5/3) = 1.291, the gap of peak attraction");
}

TACTOID_INLINE TermEnergy LigandReceptor::apply(const ParticleFields& a, const ParticleFields& b, double) {
  return engine.apply(law(), a, b, area);
}

TACTOID_INLINE void LigandReceptor::redistribute(const SurfaceTransfer& surface, const ParticleFields&, const ParticleFields&) {
  engine.redistribute(surface);
}

TACTOID_INLINE double LigandReceptor::stiffness_rate(const ParticleFields& a, const ParticleFields& b) const {
  return engine.stiffness_rate(law(), a, b);
}

template <int D>
  requires(D >= 2)
void LigandReceptor::initialize(const PointCloud<D>& cloud_a, const ParticleFields& a, const PointCloud<D>& cloud_b, const ParticleFields& b) {
  engine.initialize<D>(law(), cloud_a, a, cloud_b, b, points_per_direction, sampled);
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template void LigandReceptor::initialize<2>(const PointCloud<2>& cloud_a, const ParticleFields& a, const PointCloud<2>& cloud_b, const ParticleFields& b);
template void LigandReceptor::initialize<3>(const PointCloud<3>& cloud_a, const ParticleFields& a, const PointCloud<3>& cloud_b, const ParticleFields& b);
}  // namespace tactoid
#endif
