#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include <tactoid/core/errors.hpp>
#include <tactoid/verify/convergence.hpp>
#include <tactoid/verify/energy_watch.hpp>

#include "relative.hpp"

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
