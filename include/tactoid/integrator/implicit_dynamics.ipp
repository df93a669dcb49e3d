#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/integrator/implicit_dynamics.hpp>

namespace tactoid {

TACTOID_INLINE void ImplicitDynamics::validate() const {
  if (!(tolerance > 0.0 && tolerance < 1.0)) reject("ImplicitDynamics.tolerance", tolerance, "", "between 0 and 1");
  require_non_negative("ImplicitDynamics.time_step", time_step, "s");
  require_non_negative("ImplicitDynamics.first_time_step", first_time_step, "s");
  require_positive("ImplicitDynamics.min_time_step", min_time_step, "s");
  if (!(max_time_step > 0.0)) reject("ImplicitDynamics.max_time_step", max_time_step, "s", "positive");
  if (!(newton_tolerance > 0.0 && newton_tolerance <= 0.1 * tolerance))
    reject("ImplicitDynamics.newton_tolerance", newton_tolerance, "", "positive and at most a tenth of the tolerance");
  if (max_newton_iterations < 1) reject("ImplicitDynamics.max_newton_iterations", max_newton_iterations, "", "at least 1");
  if (max_cuts < 0) reject("ImplicitDynamics.max_cuts", max_cuts, "", "zero or positive");
  if (!(linear_tolerance > 0.0 && linear_tolerance < 1.0)) reject("ImplicitDynamics.linear_tolerance", linear_tolerance, "", "between 0 and 1");
  if (max_linear_iterations < 1) reject("ImplicitDynamics.max_linear_iterations", max_linear_iterations, "", "at least 1");
  if (refresh_after < 1) reject("ImplicitDynamics.refresh_after", refresh_after, "", "at least 1");
}

TACTOID_INLINE ImplicitDynamics::Formula::Formula(double dt, double last) {
  const double omega = last > 0.0 ? dt / last : 0.0;
  factor = (1.0 + 2.0 * omega) / ((1.0 + omega) * dt);
  now = -(1.0 + omega) / dt;
  before = omega * omega / ((1.0 + omega) * dt);
}

TACTOID_INLINE double ImplicitDynamics::local_error(double dt, const Eigen::VectorXd& difference,
                                                    const Eigen::VectorXd& scale) const {
  double share = 0.5;  // backward Euler after a linear prediction
  if (past.last_step > 0.0) {
    const double omega = dt / past.last_step;
    const double formula = (1.0 + omega) * (1.0 + omega) / (omega * (1.0 + 2.0 * omega));
    const double prediction = (1.0 + 1.0 / omega) * (1.0 + 2.0 / omega);
    share = formula / (formula + prediction);
  }
  return share * difference.cwiseQuotient(scale).cwiseAbs().maxCoeff();
}

TACTOID_INLINE ImplicitDynamics::Attempt ImplicitDynamics::fail(Attempt& attempt, const char* cause) {
  past.cause = cause;
  past.inverse.reset();  // it may be the reason
  past.matrix.resize(0, 0);
  past.last_linear_iterations = 0;
  return std::move(attempt);
}

}  // namespace tactoid
