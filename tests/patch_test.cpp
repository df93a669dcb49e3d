// The default rule passes the linear patch test and has no zero-energy modes but the rigid ones. The figures of
// the Gauss cells, which need not, are printed: they stand in the documentation.
#include <string>

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>

#include <tactoid/geometry/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/modified_mooney_rivlin.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/body.hpp>
#include <tactoid/verify/patch_test.hpp>

namespace patch_of_bodies {

using namespace tactoid;

namespace {

// The nucleus of the paper: K/G = 148.
const ModifiedMooneyRivlin nucleus{};

template <class Quadrature, int D>
auto body_of(PointCloud<D> cloud, Quadrature quadrature = {}) {
  const std::string region = cloud.regions[0];
  return Body{"patch", std::move(cloud), Rkpm<D>{}, quadrature, Materials{Region{region, nucleus}}};
}

Tensor3 finite_gradient() {
  Tensor3 F;
  F << 1.20, 0.10, -0.05, 0.05, 0.90, 0.10, -0.10, 0.08, 1.10;
  return F;
}

Tensor3 small_gradient() {
  return Tensor3::Identity() + 1e-4 * (finite_gradient() - Tensor3::Identity());
}

PointCloud<3> jittered_box(int n) {
  return jitter(box({.size = {1e-6, 1e-6, 1e-6}, .cells = {n, n, n}}), 0.2);
}
PointCloud<2> jittered_rectangle(int n) {
  return jitter(rectangle({.size = {1e-6, 1e-6}, .cells = {n, n}}), 0.2);
}
PointCloud<3> one_region_ball() {
  return ball({.radius = 5e-6,
               .core_radius = 2e-6,
               .core_cells = 4,
               .shells = 2,
               .core_region = "body",
               .shell_region = "body"});
}

template <class Body>
void passes(Body body, const std::string& name) {
  for (const Tensor3& F : {small_gradient(), finite_gradient()}) {
    const PatchReport report = patch_test(body, F);
    MESSAGE(name << ": displacement " << report.displacement_error << ", stress " << report.stress_error << ", "
                 << report.solution.iterations << " iterations");
    CHECK(report.displacement_error < 1e-9);
    CHECK(report.stress_error < 1e-9);
  }
}

/// Prints the error of a rule that passes only approximately; its solution must still be near the affine motion.
template <class Body>
void measures(Body body, const std::string& name) {
  try {
    const PatchReport report = patch_test(body, small_gradient());
    MESSAGE(name << ": displacement " << report.displacement_error << ", stress " << report.stress_error);
    CHECK(report.displacement_error < 0.2);
  } catch (const ComputationError& error) {
    MESSAGE(name << ": " << std::string(error.what()));
  }
}

/// Eigenvalues of the stiffness of the free block at rest, over the largest, ascending.
template <class Body>
Eigen::VectorXd modes(const Body& body) {
  const Eigen::MatrixXd K(assemble_stiffness(body));
  CHECK((K - K.transpose()).norm() < 1e-13 * K.norm());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, Eigen::EigenvaluesOnly);
  return solver.eigenvalues() / solver.eigenvalues().tail<1>()[0];
}

template <class Body>
int zero_modes(const Body& body, int rigid, const std::string& name) {
  const Eigen::VectorXd values = modes(body);
  int zero = 0;
  while (values[zero] < 1e-9) ++zero;
  MESSAGE(name << ": " << zero << " zero modes, the last " << values[zero - 1] << ", the next " << values[zero]
               << " of the largest; number " << rigid + 1
               << " over the largest zero: " << values[rigid] / std::abs(values[rigid - 1]));
  return zero;
}

}  // namespace

TEST_CASE("Linear patch test, 3D: jittered box, disc and ball") {
  passes(body_of<NodalCentroids>(jittered_box(5)), "box");
  passes(body_of<NodalCentroids>(disc({.radius = 5e-6, .height = 2e-6, .core_cells = 4, .rings = 3, .layers = 5})),
         "disc");
  passes(body_of<NodalCentroids>(one_region_ball()), "ball");
}

TEST_CASE("Linear patch test, 2D and 1D") {
  passes(body_of<NodalCentroids>(jittered_rectangle(8)), "rectangle");
  passes(body_of<NodalCentroids>(circle({.radius = 5e-6, .core_cells = 4, .rings = 3})), "circle");
  passes(body_of<NodalCentroids>(jitter(bar({.length = 1e-6, .cells = 12}), 0.2)), "bar");
}

TEST_CASE("Without the correction the patch test fails: the test can tell") {
  auto body = body_of(jittered_rectangle(8), NodalCentroids{.consistency_tolerance = 0.0});
  CHECK(patch_test(body, small_gradient()).displacement_error > 1e-4);
}

TEST_CASE("Figures of the Gauss cells in the patch test") {
  measures(body_of<GaussCells<1>>(jittered_rectangle(8)), "rectangle, GaussCells<1>");
  measures(body_of<GaussCells<2>>(jittered_rectangle(8)), "rectangle, GaussCells<2>");
  measures(body_of<GaussCells<2>>(jittered_box(4)), "box, GaussCells<2>");
}

TEST_CASE("Free blocks have the rigid modes and no other zero-energy modes") {
  CHECK(zero_modes(body_of<NodalCentroids>(jittered_box(5)), 6, "jittered box") == 6);
  CHECK(zero_modes(body_of<NodalCentroids>(box({.size = {1e-6, 1e-6, 1e-6}, .cells = {4, 4, 4}})), 6, "regular box") ==
        6);
  CHECK(zero_modes(body_of<NodalCentroids>(jittered_rectangle(8)), 3, "jittered rectangle") == 3);
  CHECK(zero_modes(body_of<NodalCentroids>(bar({.length = 1e-6, .cells = 12})), 1, "bar") == 1);
}

TEST_CASE("Zero-energy modes of the Gauss cells, and of the default rule without its stabilisation") {
  CHECK(zero_modes(body_of<GaussCells<2>>(jittered_box(4)), 6, "box, GaussCells<2>") == 6);
  zero_modes(body_of<GaussCells<1>>(jittered_box(4)), 6, "box, GaussCells<1>");
  CHECK(zero_modes(body_of<GaussCells<2>>(jittered_rectangle(8)), 3, "rectangle, GaussCells<2>") == 3);
  zero_modes(body_of<GaussCells<1>>(jittered_rectangle(8)), 3, "rectangle, GaussCells<1>");
  zero_modes(body_of(jittered_box(4), NodalCentroids{.solid_ratio = 0.0}), 6,
             "box, NodalCentroids without stabilisation");
}

TEST_CASE("The patch test rejects what it cannot do") {
  auto body = body_of<NodalCentroids>(bar({.length = 1e-6, .cells = 12, .periodic = true}));
  CHECK_THROWS_WITH_AS((void)patch_test(body, small_gradient()), doctest::Contains("periodic"), ParameterError);
}

}  // namespace patch_of_bodies
