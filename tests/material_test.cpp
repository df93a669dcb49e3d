#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include <tactoid/core/random.hpp>
#include <tactoid/material/all.hpp>

#include "relative.hpp"

namespace material_test {

using namespace tactoid;

namespace {

// ---- concepts: positive, negative, near misses --------------------------------------------------------------------

struct EnergyOnly {
  double density = 1000.0;
  double wave_speed() const { return 10.0; }
  template <class T>
  T energy(const Tensor<T>& F) const {
    return NeoHookean{}.energy(F);
  }
};
struct NoDensity {
  double wave_speed() const { return 10.0; }
  template <class T>
  T energy(const Tensor<T>& F) const {
    return F(0, 0);
  }
};
struct NoWaveSpeed {
  double density = 1.0;
  template <class T>
  T energy(const Tensor<T>& F) const {
    return F(0, 0);
  }
};
struct NotGeneric {  // energy for double only: no stress can be found from it
  double density = 1.0;
  double wave_speed() const { return 1.0; }
  double energy(const Tensor<double>& F) const { return F(0, 0); }
};
struct StressOnly {  // a stress without its energy
  double density = 1.0;
  double wave_speed() const { return 1.0; }
  template <class T>
  Tensor<T> first_piola(const Tensor<T>& F) const {
    return F;
  }
};
struct NotConst {
  double density = 1.0;
  double wave_speed() { return 1.0; }
  template <class T>
  T energy(const Tensor<T>& F) const {
    return F(0, 0);
  }
};
struct WrongHistory {  // response takes another history than its own
  double density = 1.0;
  double wave_speed() const { return 1.0; }
  template <class T>
  struct History {
    T a = T(0.0);
  };
  template <class T>
  Response<T> response(const PointState<T>&, NoHistory<T>&) const {
    return {};
  }
};
static_assert(Material<EnergyOnly> && Material<ModifiedMooneyRivlin> && Material<NeoHookean>);
static_assert(Material<YangVisco<>> && Material<YangVisco<NeoHookean, SecondInvariant>>);
static_assert(Material<YangVisco<EnergyOnly>>);
static_assert(!Material<NoDensity> && !Material<NoWaveSpeed> && !Material<NotGeneric> && !Material<StressOnly>);
static_assert(!Material<NotConst> && !Material<WrongHistory> && !Material<int>);
static_assert(DirectorMaterial<NematicGel<>> && !DirectorMaterial<NeoHookean> && !DirectorMaterial<YangVisco<>>);
static_assert(uses_rate<NematicGel<>> && uses_rate<YangVisco<>> && !uses_rate<ModifiedMooneyRivlin>);

struct HalfState {  // no energy
  template <class T>
  static T pressure(const T& J, double, double) {
    return J;
  }
};
struct ReversedInvariant {  // no value at rest
  template <class T>
  static T of(const Tensor<T>& C) {
    return C(0, 0);
  }
};
static_assert(EquationOfState<ReciprocalPressure> && !EquationOfState<HalfState> && !EquationOfState<int>);
static_assert(BracketInvariant<SecondInvariant> && !BracketInvariant<ReversedInvariant>);

constexpr auto graded_by_x = [](const Vector3& X) { return NeoHookean{.mu = 1.0e3 * (1.0 + X.x())}; };
constexpr auto not_a_law = [](const Vector3& X) { return X.x(); };
constexpr auto of_two = [](const Vector3&, double) { return NeoHookean{}; };
static_assert(MaterialAtPosition<decltype(graded_by_x)>);
static_assert(!MaterialAtPosition<decltype(not_a_law)> && !MaterialAtPosition<decltype(of_two)>);
static_assert(MaterialSource<NeoHookean> && MaterialSource<Graded<decltype(graded_by_x)>> && !MaterialSource<double>);

// ---- helpers ------------------------------------------------------------------------------------------------------

Tensor3 random_tensor(Random& random, double size) {
  Tensor3 A;
  for (int k = 0; k < 9; ++k) A(k / 3, k % 3) = random.uniform(-size, size);
  return A;
}

PointState<double> random_state(Random& random) {
  PointState<double> p;
  p.deformation_gradient = Tensor3::Identity() + random_tensor(random, 0.25);
  p.deformation_rate = random_tensor(random, 1.0e5);
  p.director = random_tensor(random, 1.0).col(0);
  p.director_gradient = random_tensor(random, 1.0e6);
  p.time_step = 3.0e-7;
  return p;
}

template <class M>
Response<double> once(const M& m, const PointState<double>& p) {
  HistoryOf<M, double> history;
  return respond(m, p, history);
}

template <class M>
Tensor3 cauchy(const M& m, const PointState<double>& p) {
  return cauchy_from_piola(once(m, p).stress, p.deformation_gradient);
}

/// Largest relative difference of W lanes to single points, over two steps.
template <class M>
double lanes_difference(const M& m) {
  constexpr int W = 4;
  Random random(11);
  HistoryOf<M, Lanes<W>> packed_history;
  std::array<HistoryOf<M, double>, W> histories;
  double worst = 0.0;
  for (int step = 0; step < 2; ++step) {
    PointState<Lanes<W>> packed;
    std::array<Response<double>, W> single;
    for (int l = 0; l < W; ++l) {
      const PointState<double> p = random_state(random);
      for (int i = 0; i < 3; ++i) {
        set_lane(packed.director(i), l, p.director(i));
        for (int K = 0; K < 3; ++K) {
          set_lane(packed.deformation_gradient(i, K), l, p.deformation_gradient(i, K));
          set_lane(packed.deformation_rate(i, K), l, p.deformation_rate(i, K));
          set_lane(packed.director_gradient(i, K), l, p.director_gradient(i, K));
        }
      }
      packed.time_step = p.time_step;
      single[static_cast<std::size_t>(l)] = respond(m, p, histories[static_cast<std::size_t>(l)]);
    }
    const Response<Lanes<W>> r = respond(m, packed, packed_history);
    for (int l = 0; l < W; ++l) {
      const Response<double>& s = single[static_cast<std::size_t>(l)];
      Tensor3 P;
      for (int i = 0; i < 3; ++i)
        for (int K = 0; K < 3; ++K) P(i, K) = lane(r.stress(i, K), l);
      worst = std::max(worst, (P - s.stress).norm() / s.stress.norm());
      worst = std::max(worst, std::abs(lane(r.energy, l) - s.energy) / std::abs(s.energy));
      const double power = s.stress.norm() * 3.0e5;
      worst = std::max(worst, std::abs(lane(r.dissipated_power, l) - s.dissipated_power) / power);
      worst = std::max(worst, std::abs(lane(r.active_power, l) - s.active_power) / power);
    }
  }
  return worst;
}

template <class M>
void check_stress_of_energy(const M& m) {
  Random random(12);
  for (int sample = 0; sample < 20; ++sample) {
    const Tensor3 F = Tensor3::Identity() + random_tensor(random, 0.3);
    if (F.determinant() < 0.2) continue;
    const Tensor3 by_hand = m.first_piola(F), derived = stress_of_energy(m, F);
    CHECK((by_hand - derived).norm() < 1e-13 * derived.norm() + 1e-12 * m.shear_modulus());
  }
}

/// Small-strain moduli from the tangent at rest.
struct Moduli {
  double shear, bulk, longitudinal;
};
template <class M>
Moduli moduli(const M& m) {
  const Tangent A = tangent(m, Tensor3(Tensor3::Identity()));
  return {A(1, 1), (A(0, 0) + A(0, 4) + A(0, 8)) / 3.0, A(0, 0)};
}

const ModifiedMooneyRivlin soft{.density = 1100.0, .c1 = 2000.0, .c2 = 300.0, .lambda = 5.0e3, .initial_pressure = 0.0};

}  // namespace

// ---- hyperelastic -------------------------------------------------------------------------------------------------

TEST_CASE("modified Mooney-Rivlin: the energy of eqn (5) at known stretches") {
  Tensor3 F = Vector3(1.3, 0.9, 1.1).asDiagonal();
  const double a = 1.3 * 1.3, b = 0.81, c = 1.21, I3 = a * b * c;
  const double W = 2000.0 * (a + b + c - 3.0 * std::cbrt(I3)) +
                   300.0 * (a * b + b * c + c * a - 3.0 * std::pow(I3, 2.0 / 3.0)) +
                   0.5 * 5.0e3 * std::log(I3) * std::log(I3);
  CHECK(soft.energy(F) == test::relative(W).epsilon(1e-13));
  ModifiedMooneyRivlin pressed = soft;
  pressed.initial_pressure = 70.0;
  CHECK(pressed.energy(F) - soft.energy(F) == test::relative(-70.0 * (F.determinant() - 1.0)).epsilon(1e-12));
}

TEST_CASE("modified Mooney-Rivlin: P = F S with S of eqn (7), and F S Fᵀ / J is the Cauchy stress") {
  Random random(21);
  for (int sample = 0; sample < 20; ++sample) {
    const Tensor3 F = Tensor3::Identity() + random_tensor(random, 0.25);
    const Tensor3 C = F.transpose() * F, one = Tensor3::Identity();
    const double I1 = C.trace(), I3 = C.determinant(), J = F.determinant();
    const double c1 = soft.c1, c2 = soft.c2;
    const Tensor3 S = 2.0 * ((c1 + c2 * I1) * one - c2 * C -
                             (c1 * std::cbrt(I3) + 2.0 * c2 * std::pow(I3, 2.0 / 3.0) - soft.lambda * std::log(I3)) *
                                 C.inverse());
    const Tensor3 P = soft.first_piola(F);
    CHECK((P - F * S).norm() < 1e-12 * P.norm());
    const Tensor3 sigma = F * S * F.transpose() / J;
    CHECK((cauchy_from_piola(P, F) - sigma).norm() < 1e-12 * sigma.norm());
    CHECK((sigma - sigma.transpose()).norm() < 1e-12 * sigma.norm());
  }
}

TEST_CASE("stress = d energy / dF for the laws that write both by hand") {
  check_stress_of_energy(soft);
  check_stress_of_energy(ModifiedMooneyRivlin{.initial_pressure = 1.0e4});
  check_stress_of_energy(NeoHookean{.mu = 1.0e3, .lambda = 3.0e3});
}

TEST_CASE("small-strain moduli: 2 (C1 + C2), 4 lambda, and the wave speed from both") {
  for (const double pressure : {0.0, 50.0}) {
    ModifiedMooneyRivlin m = soft;
    m.initial_pressure = pressure;
    const Moduli got = moduli(m);
    CHECK(got.shear == test::relative(4600.0).epsilon(1e-13));
    CHECK(m.shear_modulus() == 4600.0);
    CHECK(m.bulk_modulus() == 2.0e4);
    CHECK(got.longitudinal == test::relative(2.0e4 + 4.0 / 3.0 * 4600.0).epsilon(1e-13));
    CHECK(m.wave_speed() == test::relative(std::sqrt(got.longitudinal / 1100.0)).epsilon(1e-13));
    if (pressure == 0.0) CHECK(got.bulk == test::relative(2.0e4).epsilon(1e-13));
  }
  const NeoHookean n = NeoHookean::from_young(2.0e4, 0.3, 1200.0);
  const Moduli got = moduli(n);
  CHECK(got.shear == test::relative(2.0e4 / 2.6).epsilon(1e-13));
  CHECK(got.bulk == test::relative(2.0e4 / (3.0 * 0.4)).epsilon(1e-13));
  CHECK(n.bulk_modulus() == test::relative(got.bulk).epsilon(1e-13));
  CHECK(n.shear_modulus() == test::relative(got.shear).epsilon(1e-13));
  CHECK(n.wave_speed() == test::relative(std::sqrt(got.longitudinal / 1200.0)).epsilon(1e-13));
  CHECK(ModifiedMooneyRivlin{}.wave_speed() == test::relative(26.2).epsilon(0.01));
}

TEST_CASE("initial pressure: sigma = -p at rest, and -p 1 more at any deformation; scaled leaves it and the density") {
  ModifiedMooneyRivlin pressed = soft;
  pressed.initial_pressure = 28.8;
  CHECK((pressed.first_piola(Tensor3(Tensor3::Identity())) + 28.8 * Tensor3::Identity()).norm() < 1e-11);
  Random random(22);
  const Tensor3 F = Tensor3::Identity() + random_tensor(random, 0.25);
  const Tensor3 more = cauchy_from_piola(Tensor3(pressed.first_piola(F) - soft.first_piola(F)), F);
  CHECK((more + 28.8 * Tensor3::Identity()).norm() < 1e-10);

  const ModifiedMooneyRivlin five = pressed.scaled(5.0);
  CHECK(five.c1 == 1.0e4);
  CHECK(five.c2 == 1500.0);
  CHECK(five.lambda == 2.5e4);
  CHECK(five.initial_pressure == 28.8);
  CHECK(five.density == 1100.0);
}

TEST_CASE("an inverted point gives NaN, in doubles and in lanes") {
  Tensor3 F = Tensor3::Identity();
  F(0, 0) = -0.5;
  CHECK(std::isnan(soft.first_piola(F)(1, 1)));
  CHECK(std::isnan(soft.energy(F)));
  CHECK(std::isnan(NeoHookean{}.first_piola(F)(1, 1)));
  Tensor<Lanes<4>> G = Tensor<Lanes<4>>::Identity();
  set_lane(G(0, 0), 2, -0.5);
  const Tensor<Lanes<4>> P = soft.first_piola(G);
  CHECK(std::isnan(lane(P(1, 1), 2)));
  CHECK(std::abs(lane(P(1, 1), 1)) < 1e-11);
}

// ---- Yang ---------------------------------------------------------------------------------------------------------

TEST_CASE_TEMPLATE("Yang: a step of strain relaxes exactly as exp(-t/A3)", Invariant, ThirdInvariant, SecondInvariant) {
  const YangVisco<ModifiedMooneyRivlin, Invariant> m{.elastic = soft, .a1 = 5.0e4, .a2 = 7.0e3, .a3 = 5.0e-6};
  Random random(31);
  PointState<double> p;
  p.deformation_gradient = Tensor3::Identity() + random_tensor(random, 0.2);
  const Tensor3 F = p.deformation_gradient, E = green_lagrange(F);
  const Tensor3 C_mid = Tensor3::Identity() + E;
  const double I = std::is_same_v<Invariant, ThirdInvariant>
                       ? C_mid.determinant()
                       : 0.5 * (C_mid.trace() * C_mid.trace() - (C_mid * C_mid).trace());
  const Tensor3 Q0 = (5.0e4 + 7.0e3 * (I - 3.0)) * E;
  const Tensor3 elastic = soft.first_piola(F);

  HistoryOf<decltype(m), double> history;
  const auto sudden = respond(m, p, history);
  CHECK((sudden.stress - elastic - F.determinant() * F * Q0).norm() < 1e-12 * Q0.norm());
  CHECK((respond(m, p, history).stress - sudden.stress).norm() < 1e-12 * Q0.norm());  // no time passes: no decay

  double t = 0.0;
  for (const double step : {1.0e-10, 3.0e-7, 2.0e-6, 9.0e-6}) {
    p.time_step = step;
    t += step;
    const Tensor3 branch = respond(m, p, history).stress - elastic;
    const Tensor3 exact = std::exp(-t / 5.0e-6) * F.determinant() * F * Q0;
    CHECK((branch - exact).norm() < 1e-12 * Q0.norm());
  }
}

TEST_CASE("Yang: a constant strain rate is exact for a constant bracket, in steps of any size") {
  const YangVisco m{.elastic = soft, .a1 = 4.0e4, .a2 = 0.0, .a3 = 2.0e-6};
  const Vector3 E_rate(3.0e4, -2.0e4, 1.0e4);
  HistoryOf<YangVisco<>, double> history;
  double t = 0.0;
  for (const double step : {1.0e-9, 4.0e-7, 1.0e-12, 3.0e-6, 2.0e-7, 6.0e-6}) {
    t += step;
    PointState<double> p;
    for (int i = 0; i < 3; ++i) p.deformation_gradient(i, i) = std::sqrt(1.0 + 2.0 * E_rate(i) * t);
    p.time_step = step;
    const Tensor3 branch = respond(m, p, history).stress - soft.first_piola(p.deformation_gradient);
    const Vector3 Q = 4.0e4 * 2.0e-6 * -std::expm1(-t / 2.0e-6) * E_rate;
    const Tensor3 exact = p.deformation_gradient.determinant() * p.deformation_gradient * Tensor3(Q.asDiagonal());
    CHECK((branch - exact).norm() < 1e-11 * exact.norm());
  }
}

TEST_CASE_TEMPLATE("Yang: with a changing bracket the integral is approached to second order", Invariant,
                   ThirdInvariant, SecondInvariant) {
  const YangVisco<ModifiedMooneyRivlin, Invariant> m{.elastic = soft, .a1 = 4.0e4, .a2 = 3.0e4, .a3 = 2.0e-6};
  const Tensor3 E_rate = (Tensor3() << 1.0, 0.3, 0.1, 0.3, -0.4, 0.2, 0.1, 0.2, 0.6).finished() * 1.0e5;
  const double end = 3.0e-6;
  // Simpson's rule for the scalar integral ∫ [A₁ + A₂ (I − 3)] e^{−(t−τ)/A₃} dτ
  double integral = 0.0;
  const int n = 2000;
  for (int k = 0; k <= n; ++k) {
    const double tau = end * k / n;
    const Tensor3 C = Tensor3::Identity() + 2.0 * tau * E_rate;
    const double I2 = 0.5 * (C.trace() * C.trace() - (C * C).trace());
    const double I = std::is_same_v<Invariant, ThirdInvariant> ? C.determinant() : I2;
    const double weight = k == 0 || k == n ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
    integral += weight * end / (3.0 * n) * (4.0e4 + 3.0e4 * (I - 3.0)) * std::exp((tau - end) / 2.0e-6);
  }
  const auto error = [&](int steps) {
    HistoryOf<decltype(m), double> history;
    for (int k = 1; k <= steps; ++k) m.advance(Tensor3(E_rate * (end * k / steps)), end / steps, history);
    return std::abs(history.branch(0) / E_rate(0, 0) - integral) / integral +
           std::abs(history.branch(3) / E_rate(1, 2) - integral) / integral;
  };
  CHECK(error(80) < 1e-3);
  CHECK(std::log2(error(40) / error(80)) == test::relative(2.0).epsilon(0.02));
}

TEST_CASE("Yang: stress power of the branch is J Q : dE/dt; energy is the elastic one") {
  const YangVisco m{.elastic = soft, .a1 = 4.0e4, .a2 = 3.0e3, .a3 = 2.0e-6};
  Random random(32);
  PointState<double> p = random_state(random);
  const auto r = once(m, p);
  const Tensor3& F = p.deformation_gradient;
  const Tensor3 Q = F.inverse() * (r.stress - soft.first_piola(F)) / F.determinant();
  const Tensor3 E_rate = symmetric_part(Tensor3(F.transpose() * p.deformation_rate));
  CHECK(r.dissipated_power == test::relative(F.determinant() * contract(Q, E_rate)).epsilon(1e-11));
  CHECK(r.energy == test::relative(soft.energy(F)).epsilon(1e-14));
  CHECK(r.active_power == 0.0);
}

TEST_CASE("Yang: moduli at rest with both invariants, and the elastic limit") {
  const YangVisco third{.elastic = soft, .a1 = 3.5e5, .a2 = 8.3e4};
  const YangVisco<ModifiedMooneyRivlin, SecondInvariant> second{.elastic = soft, .a1 = 3.5e5, .a2 = 8.3e4};
  CHECK(third.bracket_at_rest() == test::relative(1.84e5).epsilon(1e-14));
  CHECK(second.bracket_at_rest() == test::relative(3.5e5).epsilon(1e-14));
  CHECK(moduli(third).shear == test::relative(third.shear_modulus()).epsilon(1e-12));
  CHECK(std::sqrt(moduli(third).longitudinal / 1100.0) == test::relative(third.wave_speed()).epsilon(1e-12));
  CHECK(moduli(second).shear == test::relative(second.shear_modulus()).epsilon(1e-12));
  CHECK(std::sqrt(moduli(second).longitudinal / 1100.0) == test::relative(second.wave_speed()).epsilon(1e-12));

  const YangVisco elastic{.elastic = soft, .a1 = 0.0, .a2 = 0.0};
  elastic.validate();
  Random random(33);
  const PointState<double> p = random_state(random);
  CHECK((once(elastic, p).stress - soft.first_piola(p.deformation_gradient)).norm() == 0.0);
  CHECK(elastic.wave_speed() == test::relative(soft.wave_speed()).epsilon(1e-15));

  const YangVisco<EnergyOnly> derived{.a1 = 1.0e4, .a2 = 0.0};
  const YangVisco<NeoHookean> written{.a1 = 1.0e4, .a2 = 0.0};
  CHECK((once(derived, p).stress - once(written, p).stress).norm() < 1e-11 * once(written, p).stress.norm());
}

// ---- gel ----------------------------------------------------------------------------------------------------------

TEST_CASE_TEMPLATE("equations of state: dW/dJ = -p, bulk modulus, values", State, ReciprocalPressure,
                   LogarithmicPressure) {
  using D = Dual<double, 1>;
  for (const double J : {0.7, 1.0, 1.4}) {
    const D at = D::variable(J, 0);
    const double p = State::pressure(J, 30.0, 500.0);
    CHECK(State::energy(at, 30.0, 500.0).derivative[0] == test::relative(-p).epsilon(1e-14));
  }
  CHECK(State::energy(1.0, 30.0, 500.0) == 0.0);
  CHECK(State::pressure(1.0, 30.0, 500.0) == 30.0);
  CHECK(State::pressure(D::variable(1.0, 0), 30.0, 500.0).derivative[0] == test::relative(-500.0).epsilon(1e-14));
  const double p = std::is_same_v<State, ReciprocalPressure> ? 30.0 + 500.0 * (1.0 / 0.8 - 1.0)
                                                             : 30.0 - 500.0 * std::log(0.8) / 0.8;
  CHECK(State::pressure(0.8, 30.0, 500.0) == test::relative(p).epsilon(1e-14));
}

TEST_CASE("gel: simple shear and uniaxial flow") {
  const NematicGel gel{.viscosity = 0.02, .bulk_modulus = 5.0e3, .reference_pressure = 11.0};
  PointState<double> p;
  p.deformation_gradient(0, 1) = 0.7;
  p.deformation_rate(0, 1) = 3.0e3;
  Tensor3 expected = -11.0 * Tensor3::Identity();
  expected(0, 1) = expected(1, 0) = 0.02 * 3.0e3;  // μ γ̇
  CHECK((cauchy(gel, p) - expected).norm() < 1e-12);
  CHECK(once(gel, p).dissipated_power == test::relative(0.02 * 9.0e6).epsilon(1e-13));
  CHECK(once(gel, p).energy == 0.0);

  p = {};
  p.deformation_gradient(0, 0) = 1.25;
  p.deformation_rate(0, 0) = -2.0e3;
  const double pressure = 11.0 + 5.0e3 * (1.0 / 1.25 - 1.0), rate = -2.0e3 / 1.25;
  const Tensor3 sigma = cauchy(gel, p);
  CHECK(sigma(0, 0) == test::relative(-pressure + 2.0 * 0.02 * rate).epsilon(1e-13));
  CHECK(sigma(1, 1) == test::relative(-pressure).epsilon(1e-13));
  CHECK(once(gel, p).dissipated_power == test::relative(1.25 * 2.0 * 0.02 * rate * rate).epsilon(1e-13));
  CHECK(gel.viscosity_modulus() == test::relative((sigma(0, 0) + pressure) / rate).epsilon(1e-12));
  CHECK(once(gel, p).energy == test::relative(-11.0 * 0.25 + 5.0e3 * (0.25 - std::log(1.25))).epsilon(1e-13));

  CHECK(moduli(gel).longitudinal == test::relative(5.0e3).epsilon(1e-12));  // K
  CHECK(gel.wave_speed() == test::relative(std::sqrt(5.0)).epsilon(1e-14));

  const NematicGel<LogarithmicPressure> logarithmic{
      .viscosity = 0.0, .bulk_modulus = 5.0e3, .reference_pressure = 11.0};
  CHECK(cauchy(logarithmic, p)(2, 2) == test::relative(-11.0 + 5.0e3 * std::log(1.25) / 1.25).epsilon(1e-13));
}

TEST_CASE("gel: a uniform director gives the active stress -zeta h h, tension along h for zeta < 0") {
  const NematicGel gel{.viscosity = 0.0, .bulk_modulus = 1.0e3, .reference_pressure = 5.0, .activity = -40.0};
  Random random(41);
  PointState<double> p;
  p.deformation_gradient = Tensor3::Identity() + random_tensor(random, 0.2);
  p.director = Vector3(0.6, -0.5, 0.3);
  const double J = p.deformation_gradient.determinant();
  const Tensor3 expected =
      -(5.0 + 1.0e3 * (1.0 - J) / J) * Tensor3::Identity() + 40.0 * p.director * p.director.transpose();
  CHECK((cauchy(gel, p) - expected).norm() < 1e-11);
  CHECK(once(gel, p).active_power == 0.0);

  // a contractile gel that shortens along h does work on the motion
  p.deformation_gradient = Tensor3::Identity();
  p.director = Vector3::UnitX();
  p.deformation_rate(0, 0) = -10.0;
  CHECK(once(gel, p).active_power == test::relative(400.0).epsilon(1e-14));
  p.deformation_gradient(0, 0) = 0.5;  // per reference volume: J σ : d with J = ½, d = −20
  CHECK(once(gel, p).active_power == test::relative(400.0).epsilon(1e-14));
}

TEST_CASE("gel: a prescribed director gradient gives -eta h_k,i h_k,j with h_k,i = h_k,K F⁻¹_Ki") {
  const NematicGel gel{.viscosity = 0.0, .reference_pressure = 0.0, .director_elasticity = 2.0e-12, .activity = 0.0};
  PointState<double> p;
  // twist about z: h = (cos qZ, sin qZ, 0): only h_{2,3} = q at Z = 0; stretched by 2 along z and kept isochoric
  p.deformation_gradient = Vector3(1.0 / std::sqrt(2.0), 1.0 / std::sqrt(2.0), 2.0).asDiagonal();
  p.director = Vector3::UnitX();
  p.director_gradient(1, 2) = 3.0e6;
  Tensor3 expected = Tensor3::Zero();
  expected(2, 2) = -2.0e-12 * 1.5e6 * 1.5e6;
  CHECK((cauchy(gel, p) - expected).norm() < 1e-9);  // round-off of K (1 − J)/J

  // along z the gel pushes (it wants to untwist by growing): shortening takes work from the motion
  p.deformation_rate(2, 2) = -4.0;
  CHECK(once(gel, p).active_power == test::relative(expected(2, 2) * 2.0).epsilon(1e-12));

  p.deformation_rate.setZero();
  p.deformation_gradient << 1, 0.5, 0, 0, 1, 0, 0, 0, 1;
  p.director_gradient << 1.0e6, 2.0e6, 0, 0, -1.0e6, 3.0e6, 4.0e6, 0, 0;
  const Tensor3 G = p.director_gradient * p.deformation_gradient.inverse();
  CHECK((cauchy(gel, p) + 2.0e-12 * G.transpose() * G).norm() < 1e-9);
}

// ---- generic over the scalar --------------------------------------------------------------------------------------

TEST_CASE("lanes give what doubles give, to 1e-14") {
  CHECK(lanes_difference(soft) < 1e-14);
  CHECK(lanes_difference(NeoHookean{}) < 1e-14);
  CHECK(lanes_difference(YangVisco{}) < 1e-14);
  CHECK(lanes_difference(YangVisco<ModifiedMooneyRivlin, SecondInvariant>{}) < 1e-14);
  CHECK(lanes_difference(NematicGel{.viscosity = 1.0, .bulk_modulus = 1.0e3, .activity = -100.0}) < 1e-14);
  CHECK(lanes_difference(NematicGel<LogarithmicPressure>{.viscosity = 1.0, .bulk_modulus = 1.0e3}) < 1e-14);
}

TEST_CASE("tangent: energy-only laws by second derivatives; frozen history; major symmetry; instantaneous branch") {
  Random random(51);
  const Tensor3 F = Tensor3::Identity() + random_tensor(random, 0.2);
  const Tangent derived = tangent(EnergyOnly{}, F), written = tangent(NeoHookean{}, F);
  CHECK((derived - written).norm() < 1e-12 * written.norm());
  CHECK((written - written.transpose()).norm() < 1e-13 * written.norm());

  // against the closed form: A = μ 1⊗1 + λ F⁻ᵀ⊗F⁻ᵀ + (μ − λ ln J) F⁻ᵀ_iL F⁻ᵀ_jK
  const NeoHookean n;
  const Tensor3 G = F.inverse().transpose();
  double worst = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int K = 0; K < 3; ++K)
      for (int j = 0; j < 3; ++j)
        for (int L = 0; L < 3; ++L) {
          const double exact = (i == j && K == L ? n.mu : 0.0) + n.lambda * G(i, K) * G(j, L) +
                               (n.mu - n.lambda * std::log(F.determinant())) * G(i, L) * G(j, K);
          worst = std::max(worst, std::abs(written(3 * i + K, 3 * j + L) - exact));
        }
  CHECK(worst < 1e-13 * written.norm());

  // Yang at rest, with Q from before: ∂P/∂F = elastic + J F Q derivative at fixed Q + bracket part
  const YangVisco m{.elastic = soft, .a1 = 3.0e4, .a2 = 0.0};
  HistoryOf<YangVisco<>, double> history;
  history.branch(0) = 700.0;  // Q₀₀
  PointState<double> rest;
  rest.time_step = 1.0;  // ignored
  const Tangent A = tangent(m, rest, history), E = tangent(soft, Tensor3(Tensor3::Identity()));
  CHECK(A(0, 0) - E(0, 0) == test::relative(3.0e4 + 2.0 * 700.0).epsilon(1e-12));  // ∂(J F₀₀ Q₀₀)/∂F₀₀ = 2 Q₀₀
  CHECK(A(0, 4) - E(0, 4) == test::relative(700.0).epsilon(1e-12));
  CHECK(A(3, 3) - E(3, 3) == test::relative(1.5e4 + 700.0).epsilon(1e-12));
  CHECK(history.branch(0) == 700.0);
}

TEST_CASE("histories are rows of scalars, and convert") {
  static_assert(history_size<ModifiedMooneyRivlin> == 0 && history_size<NematicGel<>> == 0);
  static_assert(history_size<YangVisco<>> == 12);
  YangVisco<>::History<double> history;
  history.branch << 1, 2, 3, 4, 5, 6;
  history.strain << 7, 8, 9, 10, 11, 12;
  const auto dual = convert_history<YangVisco<>, Dual<double, 9>, double>(history);
  CHECK(dual.strain(4).value == 11.0);
  CHECK(dual.strain(4).derivative[3] == 0.0);
  auto lanes = convert_history<YangVisco<>, Lanes<4>, double>(history);
  CHECK(lane(lanes.branch(5), 3) == 6.0);
  CHECK(lane(history_scalars<YangVisco<>, Lanes<4>>(lanes)[11], 0) == 12.0);
}

// ---- regions, grading, bad input ----------------------------------------------------------------------------------

TEST_CASE("graded laws") {
  const Graded graded{graded_by_x};
  CHECK(graded.at(Vector3(2.0, 0.0, 0.0)).mu == 3.0e3);
  CHECK(material_at(graded, Vector3(1.0, 5.0, 0.0)).mu == 2.0e3);
  CHECK(material_at(soft, Vector3(1.0, 5.0, 0.0)).c1 == soft.c1);
  static_assert(std::is_same_v<LawOf<Graded<decltype(graded_by_x)>>, NeoHookean>);
  static_assert(std::is_same_v<LawOf<NeoHookean>, NeoHookean>);
}

TEST_CASE("materials per region") {
  const Materials materials{Region{"nucleus", ModifiedMooneyRivlin{}}, Region{"cytoplasm", NematicGel{}},
                            Region{"shell", Graded{graded_by_x}}};
  static_assert(materials.size == 3);
  materials.validate();
  CHECK(materials.index_of("cytoplasm") == 1);
  CHECK(std::get<0>(materials.regions).name == "nucleus");
  std::string order;
  materials.for_each([&](std::size_t i, const auto& region) { order += std::to_string(i) + region.name + " "; });
  CHECK(order == "0nucleus 1cytoplasm 2shell ");
  CHECK_THROWS_WITH_AS((void)materials.index_of("nucleolus"),
                       "Materials has no region named 'nucleolus'; its regions are: nucleus, cytoplasm, shell.",
                       ParameterError);
  CHECK_THROWS_AS((Materials{Region{"a", NeoHookean{}}, Region{"a", NeoHookean{}}}.validate()), ParameterError);
  CHECK_THROWS_AS((Materials{Region{"a", NeoHookean{.density = -1.0}}}.validate()), ParameterError);
}

TEST_CASE("parameters out of range are named") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS((ModifiedMooneyRivlin{.density = -1.0}.validate()),
                       "ModifiedMooneyRivlin.density = -1 kg/m^3 is not allowed: it must be positive and finite.",
                       ParameterError);
  CHECK_THROWS_AS((ModifiedMooneyRivlin{.c1 = -1.0, .c2 = 0.5}.validate()), ParameterError);
  CHECK_THROWS_AS((ModifiedMooneyRivlin{.lambda = 0.0}.validate()), ParameterError);
  CHECK_THROWS_AS((ModifiedMooneyRivlin{.initial_pressure = nan}.validate()), ParameterError);
  CHECK_THROWS_WITH_AS((NematicGel{.viscosity = -0.5}.validate()),
                       "NematicGel.viscosity = -0.5 Pa s is not allowed: it must be zero or positive, and finite.",
                       ParameterError);
  CHECK_THROWS_AS((NematicGel{.bulk_modulus = 0.0}.validate()), ParameterError);
  CHECK_THROWS_AS((NematicGel{.activity = nan}.validate()), ParameterError);
  CHECK_THROWS_AS((YangVisco{.a3 = 0.0}.validate()), ParameterError);
  CHECK_THROWS_AS((YangVisco{.a1 = 1.0, .a2 = 1.0}.validate()), ParameterError);  // bracket at rest −1
  CHECK_NOTHROW((YangVisco<ModifiedMooneyRivlin, SecondInvariant>{.a1 = 1.0, .a2 = 1.0}.validate()));
  CHECK_THROWS_AS((YangVisco{.elastic = {.lambda = -1.0}}.validate()), ParameterError);
  CHECK_THROWS_WITH_AS((YangVisco{.elastic = {.density = 1100.0}, .density = 1000.0}.validate()),
                       "YangVisco.density = 1000 kg/m^3 is not allowed: it must be that of YangVisco.elastic.",
                       ParameterError);
  const YangVisco heavy{.elastic = {.density = 1100.0}};
  heavy.validate();
  CHECK(heavy.density == 1100.0);
  CHECK_THROWS_AS((void)NeoHookean::from_young(1.0e3, 0.5), ParameterError);
  CHECK_THROWS_AS((void)NeoHookean::from_young(-1.0, 0.3), ParameterError);
  CHECK_THROWS_AS((NeoHookean{.mu = 3.0, .lambda = -2.0}.validate()), ParameterError);
  NeoHookean{}.validate();
  NematicGel{}.validate();
}

}  // namespace material_test
