#pragma once

#include <algorithm>
#include <vector>

#include <tactoid/boundary/prescribed_motion.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/integrator/static_newton.hpp>
#include <tactoid/simulation/body.hpp>
#include <tactoid/simulation/static_problem.hpp>

namespace tactoid {

/// Errors of a patch test, both relative.
struct PatchReport {
  double displacement_error = 0.0;  ///< largest error at a particle inside, over the largest |u| of the affine motion
  double stress_error = 0.0;        ///< largest ‖σ − σ̄‖ (Cauchy) at a point, over the largest ‖σ̄‖ of the affine motion
  StaticReport solution;            ///< what the equilibrium took
};

/// Linear patch test of a body: the particles on the facets are moved by u = (F − 1) X, the others find their static
/// equilibrium, which for one material at constant stress is the same affine motion. Only the first D rows and
/// columns of F count. The body is left in that equilibrium. In a meridian section the affine motions at constant stress are
/// diagonal, and F₀₀ is the stretch around the axis, too.
/// Throws ParameterError for a periodic body, F = 1, or a motion that is not axisymmetric, ComputationError where there is
/// no equilibrium.
template <class Body>
[[nodiscard]] PatchReport patch_test(Body& body, const Tensor3& F, const StaticNewton& newton = {}) {
  constexpr int D = Body::dimension;
  const auto& cloud = body.cloud();
  if (cloud.period.any()) throw ParameterError("patch_test: the body must not be periodic: affine motions are not.");
  Tensor3 H = Tensor3::Zero();
  H.topLeftCorner<D, D>() = F.template topLeftCorner<D, D>() - Eigen::Matrix<double, D, D>::Identity();
  if (cloud.axisymmetric && (H(0, 1) != 0.0 || H(1, 0) != 0.0))
    throw ParameterError("patch_test: F of an axisymmetric body must be diagonal: shear is no axisymmetric motion at constant stress.");
  if (H.isZero(0.0)) throw ParameterError("patch_test: F = 1 moves nothing.");
  std::vector<char> on_facet(body.size(), 0);
  for (const auto& facet : cloud.facets)
    for (Index i : facet) on_facet[i] = 1;
  PrescribedMotion motion{{}, [H](const Vector3& X, double) { return Vector3(H * X); }, {true, true, true}};
  for (Index i = 0; i < body.size(); ++i)
    if (on_facet[i]) motion.particles.push_back(i);

  StaticProblem problem(body, {motion});
  PatchReport report;
  report.solution = newton.solve(problem);
  const Field u = body.at_particles(body.displacement);
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector3 exact = H * body.table().particle_position[i].template head<3>();
    size = std::max(size, exact.norm());
    if (!on_facet[i]) error = std::max(error, (u[i].template head<3>() - exact).norm());
  }
  report.displacement_error = error / size;

  error = size = 0.0;
  Tensor3 affine = H + Tensor3::Identity();
  if (cloud.axisymmetric) affine(2, 2) = affine(0, 0);
  const std::vector<PointSample> samples = body.sample_points();
  body.for_each_region([&](const auto& region, Index) {
    using Law = typename std::decay_t<decltype(region)>::Law;
    for (std::size_t q = region.begin; q < region.end; ++q) {
      PointState<double> state;
      state.deformation_gradient = affine;
      HistoryOf<Law, double> history{};
      const Tensor3 exact = cauchy_from_piola(Tensor3(respond(region.law(q), state, history).stress), affine);
      size = std::max(size, exact.norm());
      error = std::max(error, (samples[q].cauchy - exact).norm());
    }
  });
  report.stress_error = size > 0.0 ? error / size : error;
  return report;
}

}  // namespace tactoid
