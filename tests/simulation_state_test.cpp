// A simulation that is saved, composed anew and restored goes on with the same bits, whatever keeps a state: histories,
// directors and their anchors, closest points that are followed, prescribed motion, observers.
#include <algorithm>
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
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/all.hpp>

namespace simulation_state_test {

using namespace tactoid;

namespace {

constexpr double radius = 5e-6;

/// Everything on: memory, director, both adhesions, anchoring, a plate, surface tension, motion of the bottom.
auto cell_on_substrate(double stiffness = 1.0) {
  Body cell{"cell",
            ball({.radius = radius, .core_radius = 0.4 * radius, .core_cells = 4, .shells = 2, .center = {0.0, 0.0, radius + 50e-9}}),
            Rkpm<3>{}, NodalCentroids{.fluid_modulus = 5.0},
            Materials{Region{"nucleus", ModifiedMooneyRivlin{}}, Region{"cytoplasm", NematicGel<>{.activity = -1000.0}}},
            DirectorField<>{}, RandomDirector({.seed = 2})};
  Body substrate{"substrate", disc({.radius = 8e-6, .height = 2e-6, .core_cells = 4, .rings = 3, .layers = 3}), Rkpm<3>{}, NodalCentroids{},
                 Materials{Region{"body", YangVisco<>{.elastic = ModifiedMooneyRivlin{.c1 = 1.265e4, .c2 = 1.012e3, .lambda = 1.012e6}.scaled(stiffness)}}}};
  const auto bottom = select(substrate.cloud(), [](const Point<3>& X) { return X[2] < -1.99e-6; });
  return Simulation{
      Bodies{std::move(cell), std::move(substrate)},
      Contacts{between<0, 1>(LigandReceptor{}), between<0, 1>(VanDerWaals{.strength = 1e6, .reaction = true}), between<0, 1>(ContactAnchoring{})},
      Boundaries{on<0>(SurfaceTension{}), on<0>(RigidPlate<>{.point = {0.0, 0.0, 2.01 * radius}, .normal = -Vector3::UnitZ(), .velocity = {0.0, 0.0, -0.5}}),
                 on<1>(PrescribedMotion{bottom, [](const Vector3&, double t) { return Vector3(0.05 * t, 0.0, 0.0); }, {true, true, true}})},
      CentralDifference{}};
}

/// Coefficients as unknowns: conditions by multipliers, which keep their last values.
auto sampled_block() {
  Body block{"block", box({.size = {2e-6, 1e-6, 1e-6}, .cells = {4, 2, 2}}), Rkpm<3>{}, GaussCells<2>{},
             Materials{Region{"body", YangVisco<>{}}}};
  const auto left = select(block.cloud(), [](const Point<3>& X) { return X[0] < 1e-9; });
  const auto right = select(block.cloud(), [](const Point<3>& X) { return X[0] > 1.999e-6; });
  return Simulation{Bodies{std::move(block)}, Contacts{},
                    Boundaries{on<0>(fixed(left)), on<0>(PrescribedMotion{right, [](const Vector3&, double t) { return Vector3(0.1 * t, 0.0, 0.0); }, {true, false, false}})},
                    CentralDifference{}};
}

/// A run that is not interrupted, and one that is at `stop`, restored in a new simulation on another number of threads.
template <class Compose>
void check_resumed(const Compose& compose, double stop, double end) {
  auto whole = compose();
  SavedState saved;
  std::vector<double> called, called_again;
  std::vector<std::size_t> steps, steps_again;
  whole.run(end, every(end / 7.0, [&](auto& s) { called.push_back(s.time()); }), every_steps(3, [&](auto& s) { steps.push_back(s.steps()); }),
            every_steps(1, [&](auto& s) { if (saved.empty() && s.time() >= stop) saved = save_state(s); }));
  const SavedState final_state = save_state(whole);
  REQUIRE(!saved.empty());
  REQUIRE(saved.at("time").values[0] < end);

  const int threads = thread_count();
  set_thread_count(threads == 1 ? 2 : 1);
  auto resumed = compose();
  restore_state(resumed, saved);
  CHECK(save_state(resumed) == saved);
  resumed.run(end, every(end / 7.0, [&](auto& s) { called_again.push_back(s.time()); }),
              every_steps(3, [&](auto& s) { steps_again.push_back(s.steps()); }));
  set_thread_count(threads);
  const SavedState resumed_state = save_state(resumed);
  REQUIRE(resumed_state.size() == final_state.size());
  for (const auto& [name, array] : final_state) {
    INFO(name);
    CHECK(resumed_state.at(name) == array);
  }
  REQUIRE(called_again.size() < called.size());
  REQUIRE(!called_again.empty());
  CHECK(std::equal(called_again.rbegin(), called_again.rend(), called.rbegin()));
  CHECK(std::equal(steps_again.rbegin(), steps_again.rend(), steps.rbegin()));
}

}  // namespace

TEST_CASE("A restored simulation goes on with the same bits: a cell on its substrate") {
  check_resumed([] { return cell_on_substrate(); }, 0.21e-6, 0.4e-6);
}

TEST_CASE("A restored simulation goes on with the same bits: coefficients") {
  check_resumed([] { return sampled_block(); }, 0.3e-7, 1e-7);
}

TEST_CASE("A restored simulation goes on with the same bits: a meridian section") {
  const auto compose = [] {
    Body cell{"cell", meridian(Ball{.radius = radius, .core_radius = 0.4 * radius, .core_cells = 6, .shells = 3, .center = {0.0, 0.0, radius + 50e-9}}),
              Rkpm<2>{}, NodalCentroids{}, Materials{Region{"nucleus", ModifiedMooneyRivlin{}}, Region{"cytoplasm", ModifiedMooneyRivlin{}}}};
    Body base{"base", meridian(Disc{.radius = 8e-6, .height = 2e-6, .core_cells = 6, .rings = 6, .layers = 4}), Rkpm<2>{}, NodalCentroids{},
              Materials{Region{"body", YangVisco<>{}}}};
    return Simulation{Bodies{std::move(cell), std::move(base)}, Contacts{between<0, 1>(Combined{LigandReceptor{.sampled = ContactSide::both}, VanDerWaals{}})},
                      Boundaries{on<0>(CurvatureSurfaceTension{})}, CentralDifference{}};
  };
  check_resumed(compose, 0.1e-6, 0.3e-6);
}

TEST_CASE("A finished run goes on further, past events that are the present but for round-off") {
  auto first = sampled_block();
  first.run(5e-9, every(5e-9 / 20, [](auto&) {}));
  auto second = sampled_block();
  restore_state(second, save_state(first));
  std::vector<double> called;
  second.run(5e-9, every(5e-9 / 20, [&](auto& s) { called.push_back(s.time()); }));
  CHECK(called.empty());
  auto third = sampled_block();
  restore_state(third, save_state(first));
  double least = 1.0;
  third.run(1e-8, every(1e-8 / 20, [&](auto& s) { called.push_back(s.time()); }), every_steps(1, [&](auto& s) { least = std::min(least, s.last_time_step()); }));
  CHECK(called.size() == 10);
  CHECK(least > 1e-12);
}

TEST_CASE("The state of another simulation is refused, by the name of what does not fit") {
  auto simulation = cell_on_substrate();
  const SavedState saved = save_state(simulation);
  auto block = sampled_block();
  CHECK_THROWS_WITH_AS(restore_state(block, saved), "The saved state is of another simulation: \"body_0/reference\" is not of the expected size.", ParameterError);
  SavedState broken = saved;
  broken.erase("body_0/director");
  CHECK_THROWS_WITH_AS(restore_state(simulation, broken), doctest::Contains("\"body_0/director\" is not in it"), ParameterError);
  broken = saved;
  broken.at("body_0/displacement").shape[0] -= 1;
  CHECK_THROWS_WITH_AS(restore_state(simulation, broken), doctest::Contains("\"body_0/displacement\" is not of the expected size"), ParameterError);
  broken = saved;
  broken.at("body_0/reference").values[5] *= 1.1;
  CHECK_THROWS_WITH_AS(restore_state(simulation, broken), doctest::Contains("\"body_0/reference\" differs"), ParameterError);
  broken = saved;
  broken.at("steps").whole = false;
  CHECK_THROWS_WITH_AS(restore_state(simulation, broken), doctest::Contains("\"steps\" is of another type"), ParameterError);
  broken = saved;
  broken.at("time").values.push_back(1.0);
  CHECK_THROWS_WITH_AS(restore_state(simulation, broken), doctest::Contains("\"time\" is not of the expected size"), ParameterError);
}

}  // namespace simulation_state_test
