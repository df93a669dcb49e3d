#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/Dense>

#include <tactoid/core/dual.hpp>
#include <tactoid/core/lanes.hpp>
#include <tactoid/director/all.hpp>

#include "relative.hpp"

namespace director_test {

using namespace tactoid;

namespace {

struct NoOperator {};
struct MemberOperator {  // not static
  Tensor3 rate_operator(const Tensor3& L) const { return L; }
};
struct ScalarOperator {
  static double rate_operator(const Tensor3&) { return 0.0; }
};
static_assert(ObjectiveRate<Corotational> && ObjectiveRate<Convected>);
static_assert(!ObjectiveRate<NoOperator>);
static_assert(!ObjectiveRate<MemberOperator>);
static_assert(!ObjectiveRate<ScalarOperator>);

struct ScalarDirector {
  double operator()(const Vector3&) const { return 1.0; }
};
struct ChangingDirector {  // not const
  Vector3 operator()(const Vector3& X) { return X; }
};
static_assert(InitialDirector<RandomDirector>);
static_assert(!InitialDirector<ScalarDirector>);
static_assert(!InitialDirector<ChangingDirector>);

/// The director after `steps` Cayley steps over the time t in the constant velocity gradient L.
template <class Rate>
Vector3 carried(const Tensor3& L, Vector3 h, double t, int steps) {
  for (int k = 0; k < steps; ++k) h = cayley_update(Rate::rate_operator(L), h, t / steps, Vector3(Vector3::Zero()));
  return h;
}

Tensor3 skew(const Vector3& axis) {
  Tensor3 W;
  W << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return W;
}

}  // namespace

TEST_CASE("objective rates under simple shear follow the exact solutions") {
  const double rate = 2.0e5, t = 4.0e-6;
  Tensor3 L = Tensor3::Zero();
  L(0, 1) = rate;
  const Vector3 h0(0.6, 0.48, 0.64);

  const double angle = -0.5 * rate * t;  // corotational: turns with half the shear rate, clockwise
  const Vector3 corotational = Eigen::AngleAxisd(angle, Vector3::UnitZ()) * h0;
  const double coarse = (carried<Corotational>(L, h0, t, 20) - corotational).norm();
  const double fine = (carried<Corotational>(L, h0, t, 40) - corotational).norm();
  CHECK(fine < 2e-5);
  CHECK(std::log2(coarse / fine) == test::relative(2.0).epsilon(0.01));

  const Vector3 convected(h0.x(), h0.y() - rate * t * h0.x(), h0.z());  // F⁻ᵀ h₀
  CHECK((carried<Convected>(L, h0, t, 7) - convected).norm() < 1e-14);
}

TEST_CASE("objective rates under pure stretch") {
  const double rate = 1.0e5, t = 5.0e-6;
  Tensor3 L = Tensor3::Zero();
  L(0, 0) = rate;
  const Vector3 h0(0.6, 0.8, 0.0);
  CHECK((carried<Corotational>(L, h0, t, 10) - h0).norm() == 0.0);
  const Vector3 exact(0.6 * std::exp(-rate * t), 0.8, 0.0);
  const double coarse = (carried<Convected>(L, h0, t, 20) - exact).norm();
  const double fine = (carried<Convected>(L, h0, t, 40) - exact).norm();
  CHECK(fine < 1e-5);
  CHECK(std::log2(coarse / fine) == test::relative(2.0).epsilon(0.01));
}

TEST_CASE("rigid spin turns the director with the body and keeps its length in steps of any size") {
  const Vector3 axis(1.0e6, -2.0e6, 0.5e6);
  const Tensor3 W = skew(axis);
  CHECK((Corotational::rate_operator(W) - W).norm() == 0.0);
  CHECK((Convected::rate_operator(W) - W).norm() == 0.0);

  Vector3 h(0.0, 0.0, 1.0);
  for (int k = 0; k < 2000; ++k) h = cayley_update(Corotational::rate_operator(W), h, 1.0e-6, Vector3(Vector3::Zero()));
  CHECK(std::abs(h.norm() - 1.0) < 4e-13);  // 2000 round-offs

  const double t = 1.0e-6;
  const Vector3 exact = Eigen::AngleAxisd(axis.norm() * t, axis.normalized()) * Vector3(Vector3::UnitZ());
  CHECK((carried<Corotational>(W, Vector3::UnitZ(), t, 2000) - exact).norm() < 1e-6);
}

TEST_CASE("Cayley update with a source") {
  const Vector3 h(0.3, -0.2, 0.9), s(1.0, 2.0, 3.0);
  CHECK((cayley_update(Tensor3(Tensor3::Zero()), h, 0.25, s) - (h + 0.25 * s)).norm() < 1e-15);

  // dh/dt = A h + s with A = diag(−a): h = s/a + (h₀ − s/a) e^{−at}
  const double a = 3.0, t = 0.5;
  const Vector3 exact = s / a + (h - s / a) * std::exp(-a * t);
  const auto error = [&](int steps) {
    Vector3 x = h;
    for (int k = 0; k < steps; ++k) x = cayley_update(Tensor3(-a * Tensor3::Identity()), x, t / steps, s);
    return (x - exact).norm();
  };
  CHECK(error(80) < 1e-4);
  CHECK(std::log2(error(40) / error(80)) == test::relative(2.0).epsilon(0.01));

  Tensor<Lanes<4>> A;
  Vector<Lanes<4>> h_lanes, s_lanes;
  const Tensor3 W = skew(s);
  for (int i = 0; i < 3; ++i) {
    h_lanes(i) = Lanes<4>(h(i));
    s_lanes(i) = Lanes<4>(s(i));
    for (int j = 0; j < 3; ++j) A(i, j) = Lanes<4>(W(i, j));
  }
  const Vector3 single = cayley_update(W, h, 0.1, s);
  const Vector<Lanes<4>> pack = cayley_update(A, h_lanes, 0.1, s_lanes);
  for (int i = 0; i < 3; ++i) CHECK(pack(i).lane[3] == test::relative(single(i)).epsilon(1e-14));
}

TEST_CASE("Ginzburg-Landau: r is the derivative of R, and the wall is tanh(x / (sqrt 2 core size))") {
  const double core = 0.5e-6;
  using D = Dual<double, 3>;
  const Vector3 h(0.4, -0.7, 1.1);
  Vector<D> v;
  for (int i = 0; i < 3; ++i) v(i) = D::variable(h(i), i);
  const D R = ginzburg_landau_energy(v, core);
  const double excess = h.squaredNorm() - 1.0;
  CHECK(R.value == test::relative(excess * excess / (4.0 * core * core)).epsilon(1e-14));
  const Vector3 r = ginzburg_landau(h, core);
  for (int i = 0; i < 3; ++i) CHECK(r(i) == test::relative(R.derivative[static_cast<std::size_t>(i)]).epsilon(1e-14));
  CHECK(ginzburg_landau(Vector3(0.6, 0.0, 0.8), core).norm() * core * core < 1e-15);

  for (const double x : {-1.0e-6, 0.2e-6, 0.9e-6}) {
    const double k = 1.0 / (std::numbers::sqrt2 * core), f = std::tanh(k * x);
    const double second = -2.0 * k * k * f * (1.0 - f * f);  // f″
    CHECK(ginzburg_landau(Vector3(0.0, f, 0.0), core).y() == test::relative(second).epsilon(1e-13));
  }
}

TEST_CASE("director field: flux, source, limits") {
  const DirectorField field{.diffusivity = 2.0e-7, .core_size = 0.4e-6};
  field.validate();
  CHECK(field.penalty_time_step() == test::relative(0.8e-6).epsilon(1e-15));
  const Vector3 h(0.5, 0.0, 0.0);
  CHECK(field.source(h).x() == test::relative(2.0e-7 * 0.75 * 0.5 / (0.4e-6 * 0.4e-6)).epsilon(1e-14));

  // At the step's limit the penalty's growth factor 1 − Δt · 2 D/ε² is −1.
  const auto radial = [&](double r) { return field.source(Vector3(r, 0, 0)).x(); };
  const double slope = (radial(1.0 + 1e-7) - radial(1.0 - 1e-7)) / 2e-7;
  CHECK(1.0 + field.penalty_time_step() * slope == test::relative(-1.0).epsilon(1e-6));

  Tensor3 F, G;
  F << 1.2, 0.3, 0.0, -0.1, 0.9, 0.2, 0.05, 0.0, 1.1;
  G << 1, 2, 3, -1, 0.5, 2, 0, 1, -2;  // ∇₀h
  const Tensor3 C = F.transpose() * F;
  const Tensor3 expected = 2.0e-7 * G * C.inverse();
  CHECK((field.flux(inverse(F), G) - expected).norm() < 1e-20);

  static_assert(std::is_same_v<decltype(field)::rate, Corotational>);
  Tensor3 L;
  L << 1, 2, 3, 4, 5, 6, 7, 8, 10;
  CHECK(DirectorField<Convected>::rate_operator(L) == Tensor3(-L.transpose()));
  CHECK(DirectorField<>::rate_operator(L) == spin(L));

  CHECK_THROWS_WITH_AS((DirectorField{.core_size = -1.0}.validate()),
                       "DirectorField.core_size = -1 m is not allowed: it must be positive and finite.",
                       ParameterError);
  CHECK_THROWS_AS((DirectorField{.diffusivity = -1e-9}.validate()), ParameterError);
}

TEST_CASE("initial directors") {
  CHECK((UniformDirector(Vector3(3.0, 0.0, 4.0))(Vector3(1, 2, 3)) - Vector3(0.6, 0.0, 0.8)).norm() < 1e-15);
  CHECK_THROWS_AS(UniformDirector(Vector3(0.0, 0.0, 0.0)), ParameterError);
  const RadialDirector radial(Vector3(1.0, 0.0, 0.0));
  CHECK((radial(Vector3(1.0, -2.0, 0.0)) - Vector3(0.0, -1.0, 0.0)).norm() < 1e-15);
  CHECK(radial(Vector3(1.0, 0.0, 0.0)) == Vector3(0.0, 0.0, 0.0));
  CHECK_THROWS_AS(RandomDirector({.correlation_length = 0.0}), ParameterError);
  CHECK_THROWS_AS(RandomDirector({.modes = 0}), ParameterError);
}

TEST_CASE("the random director is smooth over its correlation length, isotropic, and the same for the same seed") {
  const double length = 2.0e-6;
  const RandomDirector field, same, other({.seed = 2});
  Random random(7);
  double near = 0.0, at_length = 0.0, far = 0.0;
  Vector3 mean = Vector3::Zero();
  Tensor3 second = Tensor3::Zero();
  const int samples = 4000;
  bool unit = true, equal = true;
  double different = 0.0;
  for (int k = 0; k < samples; ++k) {
    Vector3 X, direction;
    for (int i = 0; i < 3; ++i) X(i) = random.uniform(-50e-6, 50e-6), direction(i) = random.normal();
    direction.normalize();
    const Vector3 h = field(X);
    unit = unit && std::abs(h.norm() - 1.0) < 1e-14;
    equal = equal && h == same(X);
    different += h.dot(other(X)) / samples;
    near += h.dot(field(X + 0.1 * length * direction)) / samples;
    at_length += h.dot(field(X + length * direction)) / samples;
    far += h.dot(field(X + 4.0 * length * direction)) / samples;
    mean += h / samples;
    second += h * h.transpose() / samples;
  }
  CHECK(unit);
  CHECK(equal);
  CHECK(std::abs(different) < 0.05);
  CHECK(near > 0.98);
  CHECK(near < 0.998);
  // ρ = e^{−1/2} before normalisation; for unit vectors of a Gaussian field (8/3π) ρ ₂F₁(½, ½; 5/2; ρ²) = 0.536
  CHECK(std::abs(at_length - 0.536) < 0.03);
  CHECK(std::abs(far) < 0.05);
  CHECK(mean.norm() < 0.06);
  CHECK((second - Tensor3::Identity() / 3.0).norm() < 0.06);
}

TEST_CASE("the random numbers are those of SplitMix64") {
  Random random(0);
  CHECK(random.bits() == 0xE220A8397B1DCDAFULL);
  CHECK(random.bits() == 0x6E789E6AA1B965F4ULL);
  double sum = 0.0, squares = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double x = random.normal();
    sum += x / 20000, squares += x * x / 20000;
  }
  CHECK(std::abs(sum) < 0.03);
  CHECK(squares == test::relative(1.0).epsilon(0.03));
}

TEST_CASE("the director at the particles of a cloud of any dimension") {
  PointCloud<2> cloud;
  cloud.positions = {Point<2>(1.0e-6, 2.0e-6), Point<2>(-3.0e-6, 0.0)};
  const RandomDirector field;
  const Field h = initial_director(cloud, field);
  REQUIRE(h.size() == 2);
  CHECK(h[1].head<3>() == field(Vector3(-3.0e-6, 0.0, 0.0)));
  CHECK(h[0].w() == 0.0);
  PointCloud<1> bar;
  bar.positions = {Point<1>(0.5)};
  CHECK(initial_director(bar, RadialDirector(Vector3::Zero()))[0] == Vector4(1.0, 0.0, 0.0, 0.0));
}

}  // namespace director_test
