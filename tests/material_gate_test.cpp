#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include <tactoid/material/all.hpp>
#include <tactoid/verify/material_gate.hpp>

#include "relative.hpp"

namespace material_gate_test {

using namespace tactoid;

namespace {

/// Names of the figures that failed, one after the other.
std::string failures(const GateReport& report) {
  std::string names;
  for (const GateFigure& f : report.figures)
    if (!f.passed()) names += f.name + "; ";
  return names;
}

std::string join(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) joined += name + "; ";
  return joined;
}

const std::string stress = "stress - d energy/dF", objectivity = "objectivity: P(Q F) - Q P(F)",
                  symmetry = "angular momentum: P F^T - F P^T", order = "order of differences to the tangent",
                  lanes = "Lanes - double", balance = "work - energy - dissipated + active",
                  cycles = "dissipation in cycles";

struct Common {
  double density = 1000.0;
  double wave_speed() const { return 3.0; }
};

struct OnlyEnergy : Common {
  template <class T>
  T energy(const Tensor<T>& F) const {
    return NeoHookean{}.energy(F);
  }
};

struct WrongFactor : Common {
  double factor;
  explicit WrongFactor(double f) : factor(f) {}
  template <class T>
  T energy(const Tensor<T>& F) const {
    return NeoHookean{}.energy(F);
  }
  template <class T>
  Tensor<T> first_piola(const Tensor<T>& F) const {
    return NeoHookean{}.first_piola(F) * T(factor);
  }
};

struct NotObjective : Common {  // uses the stretch of F itself
  template <class T>
  T energy(const Tensor<T>& F) const {
    const T stretch = F(0, 0) - T(1.0);
    return NeoHookean{}.energy(F) + T(0.1) * stretch * stretch;
  }
};

/// A gel whose mistakes are chosen one at a time.
enum class Mistake {
  none,
  whole_gradient,
  fixed_director,
  dissipation,
  activity_sign,
  anti_viscous,
  in_lanes,
  derivative,
  silent
};
template <Mistake mistake>
struct Gel : Common {
  static constexpr bool uses_rate = true, uses_director = true, dissipative = true;
  template <class T>
  Response<T> response(const PointState<T>& point, NoHistory<T>& history) const {
    PointState<T> p = point;
    if constexpr (mistake == Mistake::fixed_director)
      p.director = inverse(p.deformation_gradient) * p.director;  // as if it were a vector of the material
    NematicGel gel{.viscosity = 1.0e-3, .bulk_modulus = 9.0e3, .activity = -10.0};
    if constexpr (mistake == Mistake::anti_viscous) gel.viscosity *= -1.0;
    Response<T> r = gel.response(p, history);
    const auto F = invert(p.deformation_gradient);
    if constexpr (mistake == Mistake::whole_gradient)
      r.stress += (spin(velocity_gradient(p.deformation_rate, F.inverse)) * T(1.0e-3)) * F.cofactors;
    if constexpr (mistake == Mistake::dissipation) r.dissipated_power *= T(0.5);
    if constexpr (mistake == Mistake::activity_sign) r.active_power = -r.active_power;
    if constexpr (mistake == Mistake::in_lanes && lane_count<T> > 1) r.stress(0, 0) += T(1.0e-3);
    if constexpr (mistake == Mistake::derivative && std::is_same_v<T, Dual<double, 9>>)
      r.stress(1, 2) = Dual<double, 9>(r.stress(1, 2).value);
    if constexpr (mistake == Mistake::silent) r.energy = r.dissipated_power = r.active_power = T(0.0);
    return r;
  }
};

/// Hooke's law between the first Piola stress and F − 1: no symmetric Cauchy stress.
struct Hooke : Common {
  template <class T>
  Response<T> response(const PointState<T>& p, NoHistory<T>&) const {
    Response<T> r;
    const Tensor<T> H = p.deformation_gradient - Tensor<T>::Identity();
    r.stress = H * T(1.0e3);
    r.energy = T(500.0) * contract(H, H);
    return r;
  }
};

}  // namespace

TEST_CASE("the shipped laws pass the gate") {
  for (const GateReport& report :
       {material_gate(ModifiedMooneyRivlin{}), material_gate(ModifiedMooneyRivlin{.initial_pressure = 1.0e3}),
        material_gate(NeoHookean{}), material_gate(NeoHookean::from_young(1.0e5, 0.45)), material_gate(YangVisco{}),
        material_gate(YangVisco<ModifiedMooneyRivlin, SecondInvariant>{}), material_gate(YangVisco<NeoHookean>{}),
        material_gate(NematicGel{}), material_gate(NematicGel{.viscosity = 0.1, .activity = -1.0e3}),
        material_gate(NematicGel<LogarithmicPressure>{})}) {
    INFO(report.text());
    CHECK(report.passed());
  }
}

TEST_CASE("the gate measures to round-off, and other seeds give other figures of the same verdict") {
  const GateReport a = material_gate(ModifiedMooneyRivlin{}), b = material_gate(ModifiedMooneyRivlin{}, {.seed = 9});
  CHECK(a.figure(stress).value < 1e-13);
  CHECK(a.figure(objectivity).value < 1e-11);
  CHECK(a.figure(order).value == test::relative(2.0).epsilon(0.01));
  CHECK(a.figure(balance).value < 1e-9);
  CHECK(std::abs(a.figure(cycles).value) < 1e-12);
  CHECK(a.figure(objectivity).value != b.figure(objectivity).value);
  CHECK(b.passed());
  CHECK(material_gate(ModifiedMooneyRivlin{}, {.seed = 9}).text() == b.text());
  CHECK(material_gate(NematicGel{}).figure(cycles).value > 1e-3);
  CHECK(material_gate(YangVisco{}, {.time_step = 1.0e-6}).figure(cycles).value > 1e-2);
  CHECK(material_gate(NematicGel{.reference_pressure = 30.0}).figure("stress at rest, Pa").value ==
        test::relative(30.0 * std::sqrt(3.0)));
}

TEST_CASE("a law of one's own that has only an energy passes; wrong laws fail, each at its mistake") {
  CHECK(material_gate(OnlyEnergy{}).passed());
  CHECK(failures(material_gate(WrongFactor(1.0 + 1.0e-7))) == join({stress}));
  CHECK(failures(material_gate(WrongFactor(1.1))) == join({stress, balance}));
  CHECK(failures(material_gate(NotObjective{})) == join({objectivity, symmetry}));
  CHECK(failures(material_gate(Hooke{})) == join({objectivity, symmetry}));
  CHECK(failures(material_gate(Gel<Mistake::none>{})) == join({}));
  CHECK(failures(material_gate(Gel<Mistake::whole_gradient>{})) == join({objectivity, symmetry, balance}));
  CHECK(failures(material_gate(Gel<Mistake::fixed_director>{})) == join({objectivity}));
  CHECK(failures(material_gate(Gel<Mistake::dissipation>{})) == join({balance}));
  CHECK(failures(material_gate(Gel<Mistake::activity_sign>{})) == join({balance}));
  CHECK(failures(material_gate(Gel<Mistake::anti_viscous>{})) == join({cycles}));
  CHECK(failures(material_gate(Gel<Mistake::in_lanes>{})) == join({lanes}));
  CHECK(failures(material_gate(Gel<Mistake::derivative>{})) == join({order}));
}

TEST_CASE("a law that reports no energy is told so, without failing") {
  const GateReport report = material_gate(Gel<Mistake::silent>{});
  CHECK_FALSE(report.figure(balance).required());
  CHECK(report.text().find("the law reports neither energy nor powers") != std::string::npos);
}

TEST_CASE("the printed report") {
  const std::string good = material_gate(NeoHookean{}).text(), bad = material_gate(NotObjective{}).text();
  CHECK(good.find("passed  " + stress) == 0);
  CHECK(good.find("FAILED") == std::string::npos);
  CHECK(good.substr(good.size() - 8) == "\npassed\n");
  CHECK(bad.find("FAILED  " + objectivity) != std::string::npos);
  CHECK(bad.substr(bad.size() - 8) == "\nFAILED\n");
  CHECK_THROWS_AS((void)material_gate(NeoHookean{}).figure("beauty"), ParameterError);
  CHECK_FALSE(GateReport{}.passed());
  GateReport nan;
  nan.at_most("x", std::nan(""), 1.0);
  CHECK_FALSE(nan.passed());
}

TEST_CASE("bad options and bad parameters are named before anything is computed") {
  CHECK_THROWS_WITH_AS((void)material_gate(NeoHookean{}, {.samples = 0}),
                       "MaterialGateOptions.samples = 0 is not allowed: it must be at least 1.", ParameterError);
  CHECK_THROWS_AS((void)material_gate(NeoHookean{}, {.amplitude = 0.7}), ParameterError);
  CHECK_THROWS_AS((void)material_gate(NeoHookean{}, {.time_step = 0.0}), ParameterError);
  CHECK_THROWS_AS((void)material_gate(NeoHookean{.mu = -1.0}), ParameterError);
}

}  // namespace material_gate_test
