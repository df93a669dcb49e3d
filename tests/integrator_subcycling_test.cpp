// Bodies that take steps of their own: balances, order, bits, and what each of them costs.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactoid/boundary/all.hpp>
#include <tactoid/contact/all.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/director/all.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/observe/motion.hpp>
#include <tactoid/observe/reaction.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/all.hpp>

#include "fields.hpp"
#include "relative.hpp"

namespace integrator_subcycling_test {

using namespace tactoid;

namespace {

constexpr double um = 1e-6;

/// Elastic, and counts how often it is asked: `Body` tells laws apart.
template <int Body>
struct Counted : NeoHookean {
  static inline std::atomic<long> calls = 0;
  template <class T>
  [[nodiscard]] Tensor<T> first_piola(const Tensor<T>& F) const {
    ++calls;
    return NeoHookean::first_piola(F);
  }
};
template <int Body>
Counted<Body> counted(double young) {
  Counted<Body> law;
  static_cast<NeoHookean&>(law) = NeoHookean::from_young(young, 0.3);
  return law;
}

/// Elastic, and reports as its powers by how much F and what it was before differ by more than the rate times the step, and the whole change.
struct Watching : NeoHookean {
  static constexpr bool uses_rate = true;
  template <class T>
  struct History {
    Tensor<T> before = Tensor<T>::Identity();
  };
  template <class T>
  [[nodiscard]] Response<T> response(const PointState<T>& point, History<T>& history) const {
    const Tensor<T> change = point.deformation_gradient - history.before, rest = change - point.deformation_rate * T(point.time_step);
    history.before = point.deformation_gradient;
    return {.stress = first_piola(point.deformation_gradient), .energy = energy(point.deformation_gradient), .dissipated_power = contract(rest, rest), .active_power = contract(change, change)};
  }
};

template <class Law>
auto block(const char* name, const Law& law, double bottom, double speed, double damping_time = 0.0, double width = 4.0) {
  Body body{name, rectangle({.size = {width * um, 2.0 * um}, .cells = {static_cast<int>(2.0 * width), 4}, .origin = {-0.5 * width * um, bottom}}), Rkpm<2>{},
            NodalCentroids{.solid_damping_time = damping_time}, Materials{Region{"body", law}}};
  for (auto& v : body.velocity) v[1] = speed;
  return body;
}

/// A soft block that meets a stiff one, whose waves are sixteen times as fast; both are free and stick to each other.
template <class Integrator>
auto collision(const Integrator& integrator, double stiffness = 256.0) {
  return Simulation{Bodies{block("soft", counted<0>(1.5e3), 0.12 * um, -0.05), block("stiff", counted<1>(1.5e3 * stiffness), -2.0 * um, 0.02, 0.0, 6.0)},
                    Contacts{between<0, 1>(LigandReceptor{})}, Boundaries{}, integrator};
}

/// Everything on, as in the paper, coarse.
template <class Integrator>
auto cell_on_substrate(const Integrator& integrator) {
  constexpr double radius = 5.0 * um;
  Body cell{"cell", ball({.radius = radius, .core_radius = 0.4 * radius, .core_cells = 4, .shells = 2, .center = {0.0, 0.0, radius + 50e-9}}),
            Rkpm<3>{}, NodalCentroids{.fluid_modulus = 5.0},
            Materials{Region{"nucleus", ModifiedMooneyRivlin{}}, Region{"cytoplasm", NematicGel<>{.activity = -1000.0}}}, DirectorField<>{},
            RandomDirector({.seed = 2})};
  Body substrate{"substrate", disc({.radius = 8.0 * um, .height = 2.0 * um, .core_cells = 4, .rings = 3, .layers = 3}), Rkpm<3>{}, NodalCentroids{},
                 Materials{Region{"body", YangVisco<>{.elastic = ModifiedMooneyRivlin{.c1 = 1.265e4, .c2 = 1.012e3, .lambda = 1.012e6}.scaled(40.0)}}}};
  const auto bottom = select(substrate.cloud(), [](const Point<3>& X) { return X[2] < -1.99 * um; });
  return Simulation{
      Bodies{std::move(cell), std::move(substrate)},
      Contacts{between<0, 1>(LigandReceptor{}), between<0, 1>(VanDerWaals{.strength = 1e6, .reaction = true}), between<0, 1>(ContactAnchoring{})},
      Boundaries{on<0>(SurfaceTension{}), on<1>(PrescribedMotion{bottom, [](const Vector3&, double t) { return Vector3(0.05 * t, 0.0, 0.0); }, {true, true, true}})},
      integrator};
}

/// The same motion in small steps and in steps of the bodies' own.
SubcycledCentralDifference subcycled_steps(double safety, int max_ratio) {
  return {CentralDifference{.safety = safety}, max_ratio};
}

/// Notes when it is told of a breakdown.
struct LastState {
  bool& told;
  double& at;
  template <class S>
  void begin(S&) {}
  template <class S>
  void after_step(S&) {}
  template <class S>
  void end(S&) {}
  template <class S>
  void last_good_state(S& simulation) {
    told = true;
    at = simulation.time();
  }
  template <class S>
  double next_time(const S&) const {
    return std::numeric_limits<double>::infinity();
  }
};

void check_same(const SavedState& a, const SavedState& b) {
  REQUIRE(a.size() == b.size());
  for (const auto& [name, array] : a) {
    INFO(name);
    REQUIRE(b.contains(name));
    CHECK(b.at(name) == array);
  }
}

}  // namespace

TEST_CASE("A ratio that is no power of two is refused") {
  for (const int ratio : {0, -4, 3, 12})
    CHECK_THROWS_WITH_AS(collision(SubcycledCentralDifference{CentralDifference{}, ratio}),
                         doctest::Contains(("SubcycledCentralDifference.max_ratio = " + std::to_string(ratio) + " is not allowed: it must be 1, 2, 4, 8").c_str()),
                         ParameterError);
  CHECK_THROWS_WITH_AS(collision(subcycled_steps(1.5, 4)), doctest::Contains("CentralDifference.safety = 1.5"), ParameterError);
  CHECK_THROWS_WITH_AS(collision(SubcycledCentralDifference{CentralDifference{.time_step = 1.0}}), doctest::Contains("must not exceed the stable step"), ParameterError);
}

TEST_CASE("With ratios of 1 the bits are those of central differences") {
  const double end = 2.0 * um;  // s: 1 m/s
  {
    auto plain = collision(CentralDifference{.safety = 0.5});
    auto off = collision(subcycled_steps(0.5, 1));
    plain.run(end, every(end / 7.0, [](auto&) {}));
    off.run(end, every(end / 7.0, [](auto&) {}));
    check_same(save_state(plain), save_state(off));
  }
  // Bodies that are alike are asked for steps that are alike.
  auto plain = collision(CentralDifference{.safety = 0.5}, 1.0);
  auto alike = collision(subcycled_steps(0.5, 8), 1.0);
  plain.run(end, every(end / 7.0, [](auto&) {}));
  alike.run(end, every(end / 7.0, [](auto&) {}));
  CHECK(alike.integrator().report.body_steps == std::vector<std::size_t>(2, plain.steps()));
  SavedState more = save_state(alike);
  std::erase_if(more, [](const auto& item) { return item.first.find("/pace/") != std::string::npos || item.first.starts_with("integrator/"); });
  check_same(save_state(plain), more);
}

TEST_CASE("A soft and a stiff body in contact: momentum to round-off, energy as in small steps, and fewer evaluations of the soft one") {
  struct Result {
    double momentum = 0.0, exchanged = 0.0, energy = 0.0, drift = 0.0;
    std::array<long, 2> calls{};
    std::size_t steps = 0, cycles = 0, changes = 0;
    Field soft;
  };
  const auto run = [](const auto& integrator) {
    auto simulation = collision(integrator);
    const Motion a0 = motion<0>(simulation), b0 = motion<1>(simulation);
    Counted<0>::calls = Counted<1>::calls = 0;
    Result r;
    double early = 0.0, late = 0.0;
    int early_count = 0, late_count = 0;
    double step = 0.0;
    const double initial = simulation.ledger().total(), end = 30e-6;
    simulation.run(end, every_steps(1, [&](auto& s) {
                     const Motion a = motion<0>(s), b = motion<1>(s);
                     r.exchanged = std::max(r.exchanged, (a.momentum - a0.momentum).norm());
                     r.momentum = std::max(r.momentum, (a.momentum + b.momentum - a0.momentum - b0.momentum).norm());
                     r.energy = std::max(r.energy, s.ledger().error());
                     if (std::abs(s.last_time_step() - step) > 1e-6 * step) ++r.changes;
                     step = s.last_time_step();
                     const double energy = s.ledger().total() / initial;
                     if (s.time() > 0.2 * end && s.time() < 0.4 * end) early += energy, ++early_count;
                     if (s.time() > 0.8 * end) late += energy, ++late_count;
                   }));
    r.drift = std::abs(late / late_count - early / early_count);
    r.calls = {Counted<0>::calls, Counted<1>::calls};
    if constexpr (requires { integrator.report; }) {
      r.steps = simulation.integrator().report.steps;
      CHECK(r.steps == simulation.integrator().report.body_steps[1]);
    } else {
      r.steps = simulation.steps();
    }
    r.cycles = simulation.steps();
    r.soft = simulation.template body<0>().displacement;
    return r;
  };
  // With bonds the soft body's stable step is five times that of the stiff one, and so its own is four times as long. Alone it would have the
  // energy error of such steps, too: of second order.
  const Result small = run(CentralDifference{.safety = 0.5}), own = run(subcycled_steps(0.5, 8)), finer = run(subcycled_steps(0.25, 8));
  for (const Result& r : {small, own, finer})
    MESSAGE(r.steps, " steps, laws asked ", r.calls[0], " and ", r.calls[1], " times; momentum ", r.momentum / r.exchanged, " of what was exchanged; energy error ",
            r.energy, ", drift ", r.drift, "; ", r.changes, " changes of the step in ", r.cycles, " cycles");
  MESSAGE("displacements differ by ", test::largest_difference(small.soft, own.soft) / test::largest(small.soft), " and ", test::largest_difference(small.soft, finer.soft) / test::largest(small.soft));
  CHECK(small.exchanged > 1e-10 * um);
  for (const Result& r : {own, finer}) CHECK(r.momentum <= 1e-12 * r.exchanged);
  CHECK(own.changes * 5 < own.cycles);
  CHECK(small.energy < 2e-3);
  CHECK(own.energy < 2e-2);
  CHECK(finer.energy < own.energy / 3.0);
  CHECK(own.drift < 1e-3);
  CHECK(finer.drift < own.drift / 3.0);
  CHECK(static_cast<double>(own.calls[0]) < 0.28 * static_cast<double>(small.calls[0]));
  CHECK(static_cast<double>(own.calls[1]) < 1.1 * static_cast<double>(small.calls[1]));
  CHECK(test::largest_difference(small.soft, finer.soft) < 1e-2 * test::largest(small.soft));
}

TEST_CASE("Steps of the bodies' own are of second order") {
  // Both vibrate, and pull at each other by bonds all the time.
  double slip = 0.0;  // between the velocities that contacts see and those at the end
  const auto end_state = [&](const auto& integrator) {
    Body soft = block("soft", NeoHookean::from_young(1.5e3, 0.3), 0.1 * um, 0.0), stiff = block("stiff", NeoHookean::from_young(1.5e3 * 256.0, 0.3), -2.0 * um, 0.0);
    for (std::size_t i = 0; i < soft.size(); ++i) soft.velocity[i][0] = 0.05 * std::sin(1.5e6 * soft.reference()[i][1]);
    for (std::size_t i = 0; i < stiff.size(); ++i) stiff.velocity[i][1] = 0.1 * std::cos(0.8e6 * stiff.reference()[i][0]);
    Simulation simulation{Bodies{std::move(soft), std::move(stiff)}, Contacts{between<0, 1>(LigandReceptor{})}, Boundaries{}, integrator};
    simulation.run(1.6e-6);
    const auto seen = simulation.template particles<0>().velocity;
    slip = test::largest_difference(Field(seen.begin(), seen.end()), simulation.template velocity<0>()) / test::largest(simulation.template velocity<0>());
    return std::array<Field, 2>{simulation.template body<0>().displacement, simulation.template body<1>().displacement};
  };
  const double longest = 1.6e-6 / 128.0;
  const auto exact = end_state(CentralDifference{.time_step = longest / 32.0});
  std::array<std::array<double, 3>, 3> error{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto state = end_state(SubcycledCentralDifference{CentralDifference{.time_step = longest / std::pow(2.0, double(k))}, 4});
    for (std::size_t b = 0; b < 2; ++b) error[k][b] = test::largest_difference(state[b], exact[b]) / test::largest(exact[b]);
    error[k][2] = slip;
    MESSAGE("errors of the soft body ", error[k][0], ", of the stiff one ", error[k][1], ", of velocities that contacts see ", slip);
  }
  CHECK(error[0][2] < 0.013);
  CHECK(error[1][2] < 0.004);
  for (std::size_t b = 0; b < 2; ++b) {
    CHECK(error[0][b] < 2e-2);
    CHECK(error[0][b] / error[1][b] > 3.3);
    CHECK(error[1][b] / error[2][b] > 3.3);
  }
}

TEST_CASE("A gel with a director in steps of its own: the state, what it dissipates, and the balance are those of small steps") {
  const double end = 0.4e-6;
  auto small = cell_on_substrate(CentralDifference{.safety = 0.5});
  auto own = cell_on_substrate(subcycled_steps(0.5, 4));
  Field start = own.body<0>().director;
  small.run(end);
  own.run(end);
  const auto& report = own.integrator().report;
  const EnergyLedger &a = small.ledger(), &b = own.ledger();
  const double moved = test::largest_difference(own.body<0>().displacement, small.body<0>().displacement) / test::largest(small.body<0>().displacement);
  const double turned = test::largest_difference(own.body<0>().director, small.body<0>().director) / test::largest_difference(start, small.body<0>().director);
  MESSAGE("steps ", report.body_steps[0], " and ", report.body_steps[1], ", was ", small.steps(), "; displacements differ by ", moved, ", directors by ", turned,
          " of their change; dissipated ", a.dissipated, " and ", b.dissipated, ", external work ", a.external_work, " and ", b.external_work, "; error ", a.error(),
          " and ", b.error());
  CHECK(report.body_steps[0] * 3 < report.body_steps[1]);
  CHECK(moved < 1e-2);
  CHECK(turned < 1e-2);
  CHECK(b.dissipated == test::relative(a.dissipated).epsilon(0.02));
  CHECK(b.external_work == test::relative(a.external_work).epsilon(0.02));
  CHECK(b.error() < 2.0 * a.error() + 1e-3);
}

TEST_CASE("The rate that a law sees, times its step, is the change of the deformation gradient") {
  Watching law;
  static_cast<NeoHookean&>(law) = NeoHookean::from_young(1.5e3, 0.3);
  Simulation simulation{Bodies{block("soft", law, 0.1 * um, -0.05), block("stiff", NeoHookean::from_young(2e5, 0.3), -2.0 * um, 0.02)},
                        Contacts{between<0, 1>(LigandReceptor{})}, Boundaries{}, subcycled_steps(0.5, 8)};
  simulation.run(6e-6);
  CHECK(simulation.integrator().report.body_steps[0] * 2 < simulation.integrator().report.steps);
  MESSAGE("rest ", simulation.ledger().dissipated / simulation.ledger().external_work, " of the change");
  CHECK(simulation.ledger().external_work > 0.0);
  CHECK(simulation.ledger().dissipated < 1e-18 * simulation.ledger().external_work);
}

TEST_CASE("A viscous body in steps of its own creeps and dissipates as in small steps, and the balance closes") {
  const auto run = [](const auto& integrator) {
    Body soft = block("soft", YangVisco<>{.elastic = ModifiedMooneyRivlin{.c1 = 500.0, .c2 = 50.0, .lambda = 5e3}, .a1 = 3e3, .a2 = 8e2, .a3 = 5e-6}, 0.1 * um, 0.0, 1e-7);
    Body stiff = block("stiff", NeoHookean::from_young(2e5, 0.3), -2.0 * um, 0.0);
    for (std::size_t i = 0; i < soft.size(); ++i) soft.velocity[i][0] = 0.4 * std::sin(1.5e6 * soft.reference()[i][1]);
    Simulation simulation{Bodies{std::move(soft), std::move(stiff)}, Contacts{between<0, 1>(LigandReceptor{})}, Boundaries{on<0>(BodyForce<>{Vector3(0.0, -2e4, 0.0)})}, integrator};
    simulation.run(6e-6);
    return std::pair{simulation.ledger(), Field(simulation.template body<0>().displacement)};
  };
  // What central differences book of viscosity is of first order in the step that the velocity is behind: here the body's own.
  const auto [a, u] = run(CentralDifference{.safety = 0.1});
  const auto [b, w] = run(subcycled_steps(0.1, 8));
  const auto [c, x] = run(subcycled_steps(0.05, 8));
  MESSAGE("dissipated ", a.dissipated, ", ", b.dissipated, " and ", c.dissipated, " of ", a.largest_work, "; error ", a.error(), ", ", b.error(), " and ", c.error(),
          "; displacements differ by ", test::largest_difference(u, w) / test::largest(u));
  CHECK(a.dissipated > 0.1 * a.largest_work);
  CHECK(b.dissipated == test::relative(a.dissipated).epsilon(0.05));
  CHECK(b.error() < 0.015);
  CHECK(c.error() < 0.6 * b.error());
  CHECK(test::largest_difference(u, w) < 2e-4 * test::largest(u));
}

TEST_CASE("A clamped body in steps of its own: reactions do not jump, and what is held stands still") {
  const auto run = [](const auto& integrator) {
    Body soft = block("soft", NeoHookean::from_young(1.5e3, 0.3), 0.1 * um, 0.0), stiff = block("stiff", NeoHookean::from_young(2e5, 0.3), -2.0 * um, 0.0);
    const auto top = select(soft.cloud(), [](const Point<2>& X) { return X[1] > 2.09 * um; });
    Simulation simulation{Bodies{std::move(soft), std::move(stiff)}, Contacts{between<0, 1>(LigandReceptor{})},
                          Boundaries{on<0>(PrescribedMotion{top, [](const Vector3&, double t) { return Vector3(0.0, 1e4 * t * t, 0.0); }, {true, true, true}})}, integrator};
    std::vector<double> forces;
    simulation.run(6e-6, every(0.3e-6, [&](auto& s) { forces.push_back(reactions<0>(s).total[1]); }));
    double slip = 0.0;
    const Field v = simulation.template velocity<0>();
    for (const Index i : top) slip = std::max(slip, std::abs(v[i][1] - 2e4 * simulation.time()));
    return std::tuple{forces, slip, simulation.ledger()};
  };
  const auto [a, slip_a, small] = run(CentralDifference{.safety = 0.4});
  const auto [b, slip_b, own] = run(subcycled_steps(0.4, 8));
  REQUIRE(a.size() == b.size());
  double largest = 0.0, difference = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k])), difference = std::max(difference, std::abs(a[k] - b[k]));
  MESSAGE("reactions up to ", largest, ", differ by ", difference / largest, "; the held ones slip by ", slip_a, " and ", slip_b, " m/s; work ", small.external_work,
          " and ", own.external_work, ", error ", small.error(), " and ", own.error());
  CHECK(difference < 0.02 * largest);
  CHECK(slip_b < 1e-3 * 2e4 * 6e-6);
  CHECK(own.external_work == test::relative(small.external_work).epsilon(0.02));
  CHECK(own.error() < 1e-2);
}

TEST_CASE("A run that is continued has the same bits where a body with steps of its own is held, too") {
  const auto compose = [] {
    auto soft = block("soft", counted<0>(1.5e3), 0.12 * um, 0.0);
    const auto top = select(soft.cloud(), [](const Point<2>& X) { return X[1] > 2.11 * um; });
    const auto shaken = [](const Vector3&, double t) { return Vector3(0.05 * um * std::sin(2e6 * t), -0.02 * t, 0.0); };
    return Simulation{Bodies{std::move(soft), block("stiff", counted<1>(1.5e3 * 256.0), -2.0 * um, 0.0, 0.0, 6.0)}, Contacts{between<0, 1>(LigandReceptor{})},
                      Boundaries{on<0>(PrescribedMotion{top, shaken, {true, true, false}})}, subcycled_steps(0.5, 8)};
  };
  const double end = 2e-6;
  auto whole = compose();
  whole.run(0.5 * end);
  CHECK(whole.integrator().report.body_steps[0] * 2 < whole.integrator().report.steps);
  auto resumed = compose();
  restore_state(resumed, save_state(whole));
  resumed.run(0.5 * end);  // the run that was saved ends; both begin another one
  whole.run(end);
  resumed.run(end);
  check_same(save_state(whole), save_state(resumed));
}

TEST_CASE("A run that is continued from a checkpoint, on other threads, has the same bits") {
  const auto compose = [] { return cell_on_substrate(subcycled_steps(0.8, 8)); };
  const double end = 0.4e-6;
  auto whole = compose();
  SavedState saved;
  whole.run(end, every(end / 7.0, [](auto&) {}), every_steps(1, [&](auto& s) { if (saved.empty() && s.time() >= 0.5 * end) saved = save_state(s); }));
  CHECK(whole.integrator().report.body_steps[0] * 2 < whole.integrator().report.steps);
  const int threads = thread_count();
  set_thread_count(threads == 1 ? 2 : 1);
  auto resumed = compose();
  restore_state(resumed, saved);
  resumed.run(end, every(end / 7.0, [](auto&) {}));
  auto again = compose();
  again.run(end, every(end / 7.0, [](auto&) {}));
  set_thread_count(threads);
  check_same(save_state(whole), save_state(resumed));
  check_same(save_state(whole), save_state(again));

  CHECK(saved.contains("integrator/ratios"));  // needed where they are larger than they would be chosen anew
  auto without = cell_on_substrate(subcycled_steps(0.8, 1));
  CHECK_THROWS_WITH_AS(restore_state(without, saved), "SubcycledCentralDifference.max_ratio = 1 is not allowed: the saved state has steps of the bodies' own.", ParameterError);

  // The next cycle is shorter, and so are the steps of the soft body.
  const auto blocks = [] { return collision(SubcycledCentralDifference{CentralDifference{.time_step = 5e-9}, 8}); };
  auto first = blocks(), second = blocks();
  SavedState middle;
  first.run(95e-9, every(80e-9, [&](auto& s) { if (middle.empty() && s.time() == 80e-9) middle = save_state(s); }));
  restore_state(second, middle);
  second.run(95e-9, every(80e-9, [](auto&) {}));
  check_same(save_state(first), save_state(second));
}

TEST_CASE("A step that breaks down within a cycle leaves the last small step") {
  // The stiff body is torn apart while the soft one, whose steps are long, is in the middle of one.
  Body soft = block("soft", NeoHookean::from_young(1.5e3, 0.3), 1.0 * um, 0.0), stiff = block("stiff", NeoHookean::from_young(4e5, 0.3), -2.0 * um, 0.0);
  const auto top = select(stiff.cloud(), [](const Point<2>& X) { return X[1] > -0.01 * um; });
  const double moment = 0.2137e-6;
  Simulation simulation{Bodies{std::move(soft), std::move(stiff)}, Contacts{},
                        Boundaries{on<1>(PrescribedMotion{top, [&](const Vector3&, double t) { return Vector3(0.0, t < moment ? 0.0 : -5.0 * um, 0.0); }, {true, true, true}})},
                        subcycled_steps(0.5, 8)};
  bool told = false;
  double told_at = 0.0;
  CHECK_THROWS_WITH_AS(simulation.run(1e-6, LastState{told, told_at}), doctest::Contains("Body \"stiff\", particle"), ComputationError);
  CHECK(told);
  CHECK(told_at < moment);
  CHECK(told_at > moment - simulation.last_time_step() * 1.01);
  CHECK(test::largest(simulation.body<1>().displacement) < 1e-12 * um);
  CHECK(simulation.integrator().report.steps % 8 != 0);
  CHECK(std::all_of(simulation.body<0>().displacement.begin(), simulation.body<0>().displacement.end(), [](const Vector4& u) { return u.allFinite(); }));
  MESSAGE("broke down ", (moment - told_at) / simulation.last_time_step(), " small steps after ", told_at, " s, after ", simulation.steps(), " cycles, ",
          simulation.integrator().report.steps, " steps");
}

TEST_CASE("A wall that is met within a cycle divides its steps") {
  // The soft block's own step is sixteen times, that of the stiff one about four times too long for the wall.
  Body soft = block("soft", NeoHookean::from_young(1.5e3, 0.45), 0.25 * um, -0.05), stiff = block("stiff", NeoHookean::from_young(2.4e4, 0.45), 10.0 * um, 0.0);
  const auto run = [&](const auto& integrator) {
    auto a = soft;
    auto b = stiff;
    Simulation simulation{Bodies{std::move(a), std::move(b)}, Contacts{},
                          Boundaries{on<0>(RigidPlate{.normal = Vector3::UnitY(), .law = RepulsiveWall{.penalty = 1e13}})}, integrator};
    simulation.run(12e-6);
    return std::pair{simulation.ledger().error(), simulation.steps()};
  };
  const auto small = run(CentralDifference{.safety = 0.5});
  const auto own = run(subcycled_steps(0.5, 8));
  MESSAGE("energy error ", small.first, " in ", small.second, " steps, ", own.first, " in ", own.second, " cycles");
  CHECK(own.first < 0.1);
}

TEST_CASE("Fixed steps, events and updates of the reference go together with steps of the bodies' own") {
  auto simulation = collision(UpdatedReference{SubcycledCentralDifference{CentralDifference{.safety = 0.5}, 4}, 1.05, 2});
  std::vector<double> called;
  simulation.run(20e-6, every(1.7e-6, [&](auto& s) { called.push_back(s.time()); }));
  MESSAGE("updates ", simulation.integrator().reference.updates, ", lost ", simulation.integrator().reference.lost_energy, " of ", simulation.ledger().largest_work,
          ", energy error ", simulation.ledger().error());
  CHECK(simulation.integrator().reference.updates > 0);
  CHECK(simulation.ledger().error() < 0.05);
  for (std::size_t k = 1; k + 1 < called.size(); ++k) CHECK(called[k] == test::relative(1.7e-6 * static_cast<double>(k)).epsilon(1e-12));
  const double fixed_step = 0.4 * simulation.largest_stable_time_step();
  auto fixed_steps = collision(SubcycledCentralDifference{CentralDifference{.time_step = fixed_step}, 8});
  fixed_steps.run(21.5 * fixed_step);
  CHECK(fixed_steps.time() == 21.5 * fixed_step);
  CHECK(fixed_steps.integrator().report.steps == 22);
  CHECK(fixed_steps.integrator().report.body_steps[0] == 5);  // 8, 8, 4, 1, and the rest
  CHECK(fixed_steps.steps() == 5);
}

}  // namespace integrator_subcycling_test
