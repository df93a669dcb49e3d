#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/director/initial_director.hpp>

namespace tactoid {

TACTOID_INLINE RandomDirector::RandomDirector(const RandomDirectorOptions& options) {
  require_positive("RandomDirector.correlation_length", options.correlation_length, "m");
  if (options.modes < 1) reject("RandomDirector.modes", options.modes, "", "at least 1");
  Random random(options.seed);
  modes_.resize(static_cast<std::size_t>(options.modes));
  for (auto& mode : modes_)
    for (auto& wave : mode) {
      for (int k = 0; k < 3; ++k) wave.number(k) = random.normal() / options.correlation_length;
      wave.phase = 2.0 * std::numbers::pi * random.uniform();
    }
}

}  // namespace tactoid
