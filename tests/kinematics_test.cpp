#include <doctest/doctest.h>

#include <cmath>
#include <type_traits>

#include <Eigen/Dense>

#include <tactoid/core/dual.hpp>
#include <tactoid/core/lanes.hpp>
#include <tactoid/core/random.hpp>
#include <tactoid/kinematics/all.hpp>

#include "relative.hpp"

namespace kinematics_test {

using namespace tactoid;

namespace {

Tensor3 random_tensor(Random& random, double size = 1.0) {
  Tensor3 A;
  for (int k = 0; k < 9; ++k) A(k / 3, k % 3) = random.uniform(-size, size);
  return A;
}

Tensor3 random_rotation(Random& random) {
  return Eigen::AngleAxisd(random.uniform(0.0, 3.0),
                           Vector3(random.normal(), random.normal(), random.normal()).normalized())
      .toRotationMatrix();
}

double distance(const Tensor3& A, const Tensor3& B) { return (A - B).norm(); }

}  // namespace

TEST_CASE("the cofactors give determinant and inverse, also in lanes and duals") {
  Random random(1);
  for (int sample = 0; sample < 50; ++sample) {
    const Tensor3 F = Tensor3::Identity() + random_tensor(random, 0.5);
    const auto r = invert(F);
    CHECK(std::abs(r.determinant - F.determinant()) < 1e-14);
    CHECK(std::abs(determinant(F) - F.determinant()) < 1e-14);
    CHECK(distance(r.inverse * F, Tensor3::Identity()) < 1e-12);
    CHECK(distance(inverse(F), F.inverse()) < 1e-12);
    CHECK(distance(r.cofactors, r.determinant * Tensor3(F.inverse().transpose())) < 1e-13);

    // cof F = ∂J/∂F, by differentiation
    Tensor<Dual<double, 9>> G;
    Tensor<Lanes<4>> packed;
    for (int i = 0; i < 3; ++i)
      for (int K = 0; K < 3; ++K) {
        G(i, K) = Dual<double, 9>::variable(F(i, K), 3 * i + K);
        packed(i, K) = Lanes<4>(F(i, K));
      }
    const auto J = determinant(G);
    const auto lanes = invert(packed);
    for (int i = 0; i < 3; ++i)
      for (int K = 0; K < 3; ++K) {
        CHECK(std::abs(J.derivative[static_cast<std::size_t>(3 * i + K)] - r.cofactors(i, K)) < 1e-15);
        CHECK(lanes.inverse(i, K).lane[2] == test::relative(r.inverse(i, K)).epsilon(1e-14));
      }
  }
  Tensor3 singular;
  singular << 1, 2, 3, 2, 4, 6, 0, 1, 1;
  CHECK(determinant(singular) == 0.0);
  CHECK(distance(cofactor(singular) * singular.transpose(), Tensor3::Zero()) < 1e-15);
}

TEST_CASE("strains: definitions, rigid motion, small strain without cancellation") {
  Random random(2);
  const Tensor3 F = Tensor3::Identity() + random_tensor(random, 0.4), Q = random_rotation(random);
  CHECK(distance(right_cauchy_green(F), Tensor3(F.transpose() * F)) < 1e-15);
  CHECK(distance(left_cauchy_green(F), Tensor3(F * F.transpose())) < 1e-15);
  CHECK(distance(right_cauchy_green(Tensor3(Q * F)), right_cauchy_green(F)) < 1e-14);
  CHECK(distance(left_cauchy_green(Tensor3(F * Q)), left_cauchy_green(F)) < 1e-14);
  CHECK(distance(green_lagrange(F), Tensor3(0.5 * (F.transpose() * F - Tensor3::Identity()))) < 1e-15);
  CHECK(green_lagrange(Q).norm() < 1e-15);

  Tensor3 stretch = Tensor3::Identity();
  stretch(0, 0) = 1.5;
  CHECK(green_lagrange(stretch)(0, 0) == test::relative(0.625).epsilon(1e-15));
  stretch(0, 0) = 1.0 + 0x1.0p-40;  // a strain of 1e-12 keeps its digits
  CHECK(green_lagrange(stretch)(0, 0) == 0x1.0p-40 + 0x1.0p-81);
}

TEST_CASE("rates: L of a motion, d and w, and E's rate Fᵀ d F") {
  Random random(3);
  const Tensor3 F = Tensor3::Identity() + random_tensor(random, 0.4), rate = random_tensor(random, 2.0);
  const Tensor3 L = velocity_gradient(rate, inverse(F));
  CHECK(distance(L * F, rate) < 1e-14);
  const Tensor3 d = rate_of_deformation(L), w = spin(L);
  CHECK(distance(d + w, L) < 1e-14);
  CHECK(distance(d, d.transpose()) == 0.0);
  CHECK(distance(w, -w.transpose()) == 0.0);
  CHECK(distance(symmetric_part(L), d) == 0.0);
  CHECK(distance(skew_part(L), w) == 0.0);

  const double h = 1e-5;
  const Tensor3 E_rate = (green_lagrange(Tensor3(F + h * rate)) - green_lagrange(Tensor3(F - h * rate))) / (2.0 * h);
  CHECK(distance(E_rate, F.transpose() * d * F) < 1e-9);

  // simple shear v = γ̇ y e₁: the spin is clockwise: (w e₁)·e₂ = −γ̇/2
  Tensor3 shear = Tensor3::Zero();
  shear(0, 1) = 4.0;
  CHECK(spin(shear)(1, 0) == -2.0);
  CHECK(spin(shear)(0, 1) == 2.0);
  CHECK(rate_of_deformation(shear)(1, 0) == 2.0);
}

TEST_CASE("Nanson: the area vector of a deformed parallelogram") {
  Random random(4);
  const Tensor3 F = Tensor3::Identity() + random_tensor(random, 0.5);
  const Vector3 a(1.0, 0.2, -0.3), b(0.1, 0.8, 0.4);
  const Vector3 before = a.cross(b), after = Vector3(F * a).cross(Vector3(F * b));
  CHECK((nanson(F, before) - after).norm() < 1e-14);
}

TEST_CASE("Cauchy and Piola stress are each other's inverse and give the same power") {
  Random random(5);
  const Tensor3 F = Tensor3::Identity() + random_tensor(random, 0.3), rate = random_tensor(random);
  const Tensor3 sigma = symmetric_part(random_tensor(random, 3.0));
  const Tensor3 P = piola_from_cauchy(sigma, F);
  CHECK(distance(P, F.determinant() * Tensor3(sigma * F.inverse().transpose())) < 1e-13);
  CHECK(distance(cauchy_from_piola(P, F), sigma) < 1e-13);
  CHECK(contract(P, rate) ==
        test::relative(F.determinant() * contract(sigma, rate_of_deformation(velocity_gradient(rate, inverse(F)))))
            .epsilon(1e-12));
  Tensor3 A, B;
  A << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  B << 1, 0, 2, 0, 3, 0, 0, 5, 7;
  CHECK(contract(A, B) == 1 + 6 + 15 + 40 + 63);
}

TEST_CASE("invariants and the effective stress, from principal values") {
  Random random(6);
  const Tensor3 Q = random_rotation(random);
  const Vector3 s(3.0, 0.5, -2.0);
  const Tensor3 A = Q * s.asDiagonal() * Q.transpose();
  CHECK(first_invariant(A) == test::relative(1.5).epsilon(1e-14));
  CHECK(second_invariant(A) == test::relative(1.5 - 1.0 - 6.0).epsilon(1e-14));
  CHECK(third_invariant(A) == test::relative(-3.0).epsilon(1e-14));
  CHECK(effective_stress(A) == test::relative(std::sqrt(0.5 * (2.5 * 2.5 + 2.5 * 2.5 + 25.0))).epsilon(1e-14));
  CHECK(effective_stress(Tensor3(A + 100.0 * Tensor3::Identity())) ==
        test::relative(effective_stress(A)).epsilon(1e-12));
  Tensor3 uniaxial = Tensor3::Zero(), shear = Tensor3::Zero();
  uniaxial(2, 2) = -7.0;
  shear(0, 2) = shear(2, 0) = 2.0;
  CHECK(effective_stress(uniaxial) == test::relative(7.0).epsilon(1e-15));
  CHECK(effective_stress(shear) == test::relative(2.0 * std::sqrt(3.0)).epsilon(1e-15));
}

}  // namespace kinematics_test
