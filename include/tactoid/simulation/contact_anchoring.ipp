#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/simulation/contact_anchoring.hpp>

namespace tactoid {

TACTOID_INLINE TermEnergy ContactAnchoring::apply(const ParticleFields& a, const ParticleFields& b, double time) {
  if (!(time > last_time)) return {};
  last_time = time;
  if (countdown-- == 0) {
    countdown = interval - 1;
    fresh = true;
    gaps.visit([&](auto& g) { g.measure(a, b); });
  }
  return {};
}

}  // namespace tactoid
