#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/integrator/static_newton.hpp>

namespace tactoid {

TACTOID_INLINE void StaticNewton::validate() const {
  require_positive("StaticNewton.tolerance", tolerance);
  if (max_iterations < 1) reject("StaticNewton.max_iterations", max_iterations, "", "at least 1");
  if (load_steps < 1) reject("StaticNewton.load_steps", load_steps, "", "at least 1");
  if (max_cuts < 0) reject("StaticNewton.max_cuts", max_cuts, "", "zero or positive");
  if (!(linear_tolerance > 0.0 && linear_tolerance < 1.0))
    reject("StaticNewton.linear_tolerance", linear_tolerance, "", "between 0 and 1");
  if (max_linear_iterations < 1) reject("StaticNewton.max_linear_iterations", max_linear_iterations, "", "at least 1");
}

TACTOID_INLINE void StaticNewton::fail(double fraction, int iteration, double residual, const std::string& cause) {
  throw ComputationError(fmt::format(
      "StaticNewton found no equilibrium at {:.4g} of the load: relative residual {:.2e} after {} iterations; {}.",
      fraction, residual, iteration, cause));
}

}  // namespace tactoid
