#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include <tactoid/boundary/all.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/all.hpp>
#include <tactoid/verify/convergence.hpp>
#include <tactoid/verify/energy_watch.hpp>

#include "relative.hpp"

namespace verify_convergence_test {

using namespace tactoid;

TEST_CASE("Rates of convergence: a power law exactly, a bent line by its slopes") {
  const std::array sizes{0.4, 0.1, 0.05};
  std::array<double, 3> errors{};
  for (std::size_t i = 0; i < 3; ++i) errors[i] = 7.0 * std::pow(sizes[i], 1.5);
  const ConvergenceRates rates = convergence_rates(sizes, errors);
  CHECK(rates.fitted == test::relative(1.5).epsilon(1e-12));
  CHECK(rates.lowest() == test::relative(1.5).epsilon(1e-12));
  errors[2] = errors[1] / 4.0;
  const ConvergenceRates bent = convergence_rates(sizes, errors);
  CHECK(bent.successive.size() == 2);
  CHECK(bent.last() == test::relative(2.0).epsilon(1e-12));
  CHECK(bent.lowest() == test::relative(1.5).epsilon(1e-12));
  CHECK(bent.fitted > 1.5);
  CHECK(bent.fitted < 2.0);
}

TEST_CASE("Rates of convergence reject what gives none, by name") {
  using A = std::array<double, 2>;
  CHECK_THROWS_AS((void)convergence_rates(std::array{0.1}, std::array{0.1}), ParameterError);
  CHECK_THROWS_WITH_AS((void)convergence_rates(A{0.2, 0.1}, std::array{0.1, 0.1, 0.1}),
                       doctest::Contains("3 errors for 2 sizes"), ParameterError);
  CHECK_THROWS_WITH_AS((void)convergence_rates(A{0.2, 0.1}, A{0.1, 0.0}), doctest::Contains("errors[1]"),
                       ParameterError);
  CHECK_THROWS_WITH_AS((void)convergence_rates(A{0.2, std::nan("")}, A{0.1, 0.1}), doctest::Contains("sizes[1]"),
                       ParameterError);
  CHECK_THROWS_AS((void)convergence_rates(A{0.1, 0.1}, A{0.1, 0.1}), ParameterError);
}

TEST_CASE("The energy watch keeps the largest error and its time; NaN is infinite") {
  struct Run {
    EnergyLedger books;
    double t = 0.0;
    [[nodiscard]] const EnergyLedger& ledger() const { return books; }
    [[nodiscard]] double time() const { return t; }
  } run;
  EnergyWatch watch;
  run.books = {.kinetic = 2.0, .initial = 2.0, .largest_work = 2.0};
  watch.begin(run);
  CHECK(watch.largest_error == 0.0);
  run.books.kinetic = 1.5;
  run.t = 1.0;
  watch.after_step(run);
  run.books.kinetic = 1.9;
  run.t = 2.0;
  watch.after_step(run);
  CHECK(watch.largest_defect == test::relative(0.5));
  CHECK(watch.largest_error == test::relative(0.25));
  CHECK(watch.error() == test::relative(0.25));
  CHECK(watch.time == 1.0);
  CHECK(std::isinf(watch.next_time(run)));
  run.books.kinetic = std::nan("");
  watch.after_step(run);
  CHECK(std::isinf(watch.largest_error));
  CHECK(std::isinf(watch.largest_defect));
}

TEST_CASE("An energy watch that is saved with its run and restored knows what the whole run's knows") {
  // The end is pulled, then held: the largest error lies before the checkpoint, and a new watch would not know of it.
  const auto compose = [] {
    Body block{"block", box({.size = {2e-6, 1e-6, 1e-6}, .cells = {4, 2, 2}}), Rkpm<3>{}, NodalCentroids{},
               Materials{Region{"body", NeoHookean::from_young(10e3, 0.3)}}};
    const auto left = select(block.cloud(), [](const Point<3>& X) { return X[0] < 1e-9; });
    const auto right = select(block.cloud(), [](const Point<3>& X) { return X[0] > 1.999e-6; });
    const auto pull = [](const Vector3&, double t) { return Vector3(0.3e-6 * std::min(t / 0.1e-6, 1.0), 0.0, 0.0); };
    return Simulation{Bodies{std::move(block)}, Contacts{}, Boundaries{on<0>(fixed(left)), on<0>(PrescribedMotion{right, pull, {true, false, false}})},
                      CentralDifference{}};
  };
  constexpr double end = 1e-6;
  auto whole = compose();
  EnergyWatch watch;
  SavedState saved, saved_watch;
  whole.run(end, watch, every_steps(1, [&](auto& s) {
              if (!saved.empty() || s.time() < 0.5 * end) return;
              saved = save_state(s);
              saved_watch = save_state(watch);
            }));
  REQUIRE(!saved.empty());
  REQUIRE(watch.largest_error > 0.0);
  REQUIRE(watch.time < 0.5 * end);

  auto resumed = compose();
  EnergyWatch continued, anew;
  restore_state(resumed, saved);
  restore_state(continued, saved_watch);
  resumed.run(end, continued, anew);
  CHECK(save_state(continued) == save_state(watch));
  CHECK(continued.error() == watch.error());
  CHECK(anew.largest_defect < watch.largest_defect);
  CHECK(anew.time >= 0.5 * end);
}

}  // namespace verify_convergence_test
