// Simulations against exact solutions: conservation, waves, free fall, the director; steps, events, stops.
#include <cstring>
#include <numbers>

#include <doctest/doctest.h>

#include <tactoid/boundary/body_force.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/observe/motion.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/all.hpp>

#include "relative.hpp"

namespace simulation_test {

using namespace tactoid;

namespace {

constexpr double pi = std::numbers::pi;
const ModifiedMooneyRivlin law{};

/// The user's own integrator: a step that nobody checks.
struct Unchecked {
  double time_step = 0.0;
  template <class System>
  void initialize(System&) const {}
  template <class System>
  void step(System& s, double) const {
    s.kick(0.5 * (s.last_time_step() + time_step));
    s.drift(time_step);
    s.evaluate();
  }
};

NodalCentroids undamped() {
  return {.solid_damping_time = 0.0, .fluid_viscosity = 0.0};
}

auto block() {
  return Body{"block",
              jitter(box({.size = {1e-6, 1e-6, 1e-6}, .cells = {3, 3, 3}, .origin = {-0.5e-6, -0.5e-6, -0.5e-6}}), 0.1),
              Rkpm<3>{}, undamped(), Materials{Region{"body", law}}};
}
auto line(Bar bar_parameters, NodalCentroids rule = undamped()) {
  return Body{"line", bar(bar_parameters), Rkpm<1>{}, rule, Materials{Region{"body", law}}};
}
using Line = decltype(line({}));

template <class Body>
double largest_step(Body body) {
  StableStep stable;
  stable.calibrate(body);
  return stable.largest_step(body, 0.0);
}

double total_energy(const EnergyLedger& ledger) {
  return ledger.total();
}

// --- concepts ---------------------------------------------------------------------------------------------------
using LineSimulation = Simulation<Bodies<Line>, Contacts<>, Boundaries<>, CentralDifference>;
struct NoStep {
  template <class S>
  void initialize(S&) {}
};
struct StepWithoutEnd {
  template <class S>
  void initialize(S&) {}
  template <class S>
  void step(S&) {}
};
struct NotInitialized {
  template <class S>
  void step(S&, double) {}
};
static_assert(Integrator<CentralDifference, LineSimulation> && Integrator<Unchecked, LineSimulation>);
static_assert(!Integrator<NoStep, LineSimulation> && !Integrator<StepWithoutEnd, LineSimulation> &&
              !Integrator<NotInitialized, LineSimulation>);

struct Silent {
  template <class S>
  void begin(S&) {}
  template <class S>
  void after_step(S&) {}
  template <class S>
  void end(S&) {}
  template <class S>
  void last_good_state(S&) {}
  template <class S>
  double next_time(S&) {
    return 1.0;
  }
};
struct WithoutTime {
  template <class S>
  void begin(S&) {}
  template <class S>
  void after_step(S&) {}
  template <class S>
  void end(S&) {}
  template <class S>
  void last_good_state(S&) {}
};
struct TimeIsNoNumber : WithoutTime {
  template <class S>
  void next_time(S&) {}
};
struct WithoutLastState {
  template <class S>
  void begin(S&) {}
  template <class S>
  void after_step(S&) {}
  template <class S>
  void end(S&) {}
  template <class S>
  double next_time(S&) {
    return 1.0;
  }
};
inline auto print = [](auto&) {};
static_assert(Observer<Silent, LineSimulation> && Observer<Every<decltype(print)>, LineSimulation>);
static_assert(Observer<EverySteps<decltype(print)>, LineSimulation>);
static_assert(!Observer<WithoutTime, LineSimulation> && !Observer<TimeIsNoNumber, LineSimulation> &&
              !Observer<WithoutLastState, LineSimulation>);
static_assert(!Observer<decltype(print), LineSimulation>);

struct TermWithoutRate {
  void initialize(const PointCloud<1>&, const ParticleFields&) {}
  TermEnergy apply(const ParticleFields&, double) { return {}; }
};
struct TermWithoutEnergy : TermWithoutRate {
  void apply(const ParticleFields&, double) {}
  double stiffness_rate(const ParticleFields&) const { return 0.0; }
};
struct PlaneTerm {
  void initialize(const PointCloud<2>&, const ParticleFields&) {}
  TermEnergy apply(const ParticleFields&, double) { return {}; }
  double stiffness_rate(const ParticleFields&) const { return 0.0; }
};
static_assert(BoundaryTerm<BodyForce<>, 1> && BoundaryTerm<BodyForce<>, 3>);
static_assert(!BoundaryTerm<TermWithoutRate, 1> && !BoundaryTerm<TermWithoutEnergy, 1>);
static_assert(BoundaryTerm<PlaneTerm, 2> && !BoundaryTerm<PlaneTerm, 1>);
static_assert(!BoundaryTerm<PrescribedMotion, 3>);

struct ContactWithoutRate {
  void initialize(const PointCloud<3>&, const ParticleFields&, const PointCloud<3>&, const ParticleFields&) {}
  TermEnergy apply(const ParticleFields&, const ParticleFields&, double) { return {}; }
};
struct FullContact : ContactWithoutRate {
  double stiffness_rate(const ParticleFields&, const ParticleFields&) const { return 0.0; }
};
struct OneSidedContact : ContactWithoutRate {
  double stiffness_rate(const ParticleFields&) const { return 0.0; }
};
static_assert(Contact<FullContact, 3> && Contact<ContactAnchoring, 2>);
static_assert(!Contact<ContactWithoutRate, 3> && !Contact<OneSidedContact, 3> && !Contact<FullContact, 2> &&
              !Contact<BodyForce<>, 3>);

}  // namespace

TEST_CASE("A free elastic oscillation conserves energy, momentum and angular momentum over 10 000 steps") {
  auto body = block();
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector3 X = body.table().particle_position[i].head<3>() / 1e-6;
    // Stretch, shear, drift and spin.
    body.velocity[i] = pad(Vector3(1.0 * X[0] + 0.5 * X[1] * X[2] + 0.3, -0.6 * X[1] + 0.8 * X[0] * X[0],
                                   0.4 * X[0] - 0.7 * X[2] + 0.2 * X[1]));
  }
  const double step = 0.7 * largest_step(body);
  Simulation simulation{Bodies{body}, Contacts{}, Boundaries{}, CentralDifference{.time_step = step}};
  const double initial = total_energy(simulation.ledger());
  const auto moments = [&] {
    // The velocities of the middle of the step with the mean position: what the scheme conserves.
    Vector3 p = Vector3::Zero(), l = Vector3::Zero();
    double m = 0.0;
    const auto& b = simulation.body<0>();
    const Field v = simulation.velocity<0>();
    for (std::size_t i = 0; i < b.size(); ++i) {
      const Vector3 x = (b.table().particle_position[i] + b.displacement[i]).head<3>(),
                    q = b.masses()[i] * v[i].head<3>();
      p += q;
      l += Vector3(x[1] * q[2] - x[2] * q[1], x[2] * q[0] - x[0] * q[2], x[0] * q[1] - x[1] * q[0]);
      m += q.norm();
    }
    return std::tuple{p, l, m};
  };
  const auto [p0, l0, size] = moments();
  // The energy of the scheme swings about a mean, by (ω Δt)² of the shortest waves; drift is a change of that mean.
  double first = 0.0, last = 0.0, swing = 0.0, largest_strain = 0.0;
  simulation.run(1e4 * step, every_steps(1, [&](auto& s) {
                   const double energy = total_energy(s.ledger());
                   if (s.steps() > 0 && s.steps() <= 1000) first += energy / 1000.0;
                   if (s.steps() > 9000 && s.steps() <= 10000 && s.time() < 1e4 * step) last += energy;
                   swing = std::max(swing, std::abs(energy - initial));
                   largest_strain = std::max(largest_strain, s.ledger().strain);
                 }));
  last /= static_cast<double>(simulation.steps() - 1 - 9000);
  CHECK(simulation.steps() >= 9999);
  CHECK(largest_strain > 0.05 * initial);
  const auto [p1, l1, unused] = moments();
  MESSAGE("energy drift " << (last - first) / initial << ", swing " << swing / initial << ", momentum "
                          << (p1 - p0).norm() / size << ", angular momentum " << (l1 - l0).norm() / l0.norm()
                          << ", strain energy up to " << largest_strain / initial);
  CHECK(std::abs(last - first) < 1e-3 * initial);
  CHECK(swing < 1e-2 * initial);
  CHECK((p1 - p0).norm() < 1e-11 * size);
  CHECK((l1 - l0).norm() < 1e-9 * l0.norm());
}

TEST_CASE("The stable step is stable, and not far from the limit") {
  const auto energy_after = [](double factor) {
    auto body = block();
    for (std::size_t i = 0; i < body.size(); ++i)
      for (int k = 0; k < 3; ++k) body.velocity[i][k] = 1e-3 * std::sin(37.0 * static_cast<double>(3 * i) + 11.0 * k);
    const double step = factor * largest_step(body);
    Simulation simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{}, Unchecked{step}};
    const double initial = simulation.ledger().total();
    try {
      simulation.run(2000.0 * step);
    } catch (const ComputationError&) {
      return std::numeric_limits<double>::infinity();
    }
    return simulation.ledger().total() / initial;
  };
  CHECK(energy_after(0.99) < 10.0);
  CHECK(energy_after(1.2) > 1e6);
}

TEST_CASE("A fixed step above the stable one is rejected when the simulation is composed") {
  const double stable = largest_step(line({.length = 1e-6, .cells = 10}));
  const auto make = [&](CentralDifference integrator) {
    Simulation s{Bodies{line({.length = 1e-6, .cells = 10})}, Contacts{}, Boundaries{}, integrator};
  };
  CHECK_NOTHROW(make({.time_step = 0.99 * stable}));
  CHECK_THROWS_WITH_AS(make({.time_step = 1.01 * stable}), doctest::Contains("must not exceed the stable step"),
                       ParameterError);
  CHECK_THROWS_WITH_AS(make({.safety = 1.5}), doctest::Contains("CentralDifference.safety = 1.5"), ParameterError);
  CHECK_THROWS_WITH_AS(make({.max_time_step = 0.0}), doctest::Contains("CentralDifference.max_time_step"),
                       ParameterError);
}

TEST_CASE("Observers hit their times exactly, together where they coincide, and no step is tiny") {
  auto body = line({.length = 1e-6, .cells = 10});
  for (std::size_t i = 0; i < body.size(); ++i) body.velocity[i][0] = 1e5 * body.table().particle_position[i][0];
  LineSimulation simulation{Bodies{body}, Contacts{}, Boundaries{}, CentralDifference{}};
  std::vector<double> a, b;
  double smallest = 1.0;
  const double end = 1.2e-7;
  simulation.run(end, every(1e-8, [&](auto& s) { a.push_back(s.time()); }),
                 every(3e-8, [&](auto& s) { b.push_back(s.time()); }), every_steps(1, [&](auto& s) {
                   if (s.last_time_step() > 0.0) smallest = std::min(smallest, s.last_time_step());
                 }));
  REQUIRE(a.size() == 13);
  REQUIRE(b.size() == 5);
  for (std::size_t k = 1; k < a.size(); ++k)
    CHECK(a[k] == test::relative(1e-8 * static_cast<double>(k)).epsilon(1e-14));
  for (std::size_t k = 0; k < b.size(); ++k) CHECK(b[k] == a[3 * k]);
  CHECK(simulation.time() == end);
  CHECK(smallest > 0.3 * simulation.largest_stable_time_step());
  CHECK_THROWS_WITH_AS(simulation.run(0.5 * end), doctest::Contains("Simulation.run: end time"), ParameterError);
  CHECK_THROWS_AS((void)every(0.0, print), ParameterError);
}

TEST_CASE("Free fall is exact") {
  Simulation simulation{Bodies{block()}, Contacts{},
                        Boundaries{on<0>(BodyForce<>{.acceleration = Vector3(0.0, 1e4, -2e4)})}, CentralDifference{}};
  const double end = 1e-7;
  simulation.run(end);
  const Field v = simulation.velocity<0>();
  for (std::size_t i = 0; i < v.size(); ++i) {
    CHECK((simulation.body<0>().displacement[i] - 0.5 * end * end * Vector4(0.0, 1e4, -2e4, 0.0)).norm() <
          1e-9 * 0.5 * end * end * 2.3e4);
    CHECK((v[i] - end * Vector4(0.0, 1e4, -2e4, 0.0)).norm() < 1e-9 * end * 2.3e4);
  }
  CHECK(simulation.ledger().error() < 1e-9);
}

TEST_CASE("Waves in a periodic line travel at the speed of the law") {
  constexpr int cells = 64;
  auto body = line({.length = 1e-6, .cells = cells, .periodic = true});
  const double k = 2.0 * pi / 1e-6, amplitude = 1e-12, quarter = 0.5 * pi / (k * law.wave_speed());
  for (std::size_t i = 0; i < body.size(); ++i)
    body.displacement[i][0] = amplitude * std::sin(k * body.table().particle_position[i][0]);
  LineSimulation simulation{Bodies{body}, Contacts{}, Boundaries{}, CentralDifference{.safety = 0.3}};
  simulation.run(0.5 * quarter);
  double projected = 0.0;
  for (std::size_t i = 0; i < body.size(); ++i)
    projected +=
        2.0 / cells * simulation.body<0>().displacement[i][0] * std::sin(k * body.table().particle_position[i][0]);
  const double speed = std::acos(projected / amplitude) / (0.5 * quarter) / k;
  MESSAGE("wave speed over the law's, 64 points per wave: " << speed / law.wave_speed());
  CHECK(speed == test::relative(law.wave_speed()).epsilon(5e-3));
}

TEST_CASE("The stabilisation's damping takes what the energy loses") {
  auto body = line({.length = 1e-6, .cells = 20}, NodalCentroids{.solid_ratio = 5.0, .solid_damping_time = 2e-9});
  for (std::size_t i = 0; i < body.size(); ++i) body.velocity[i][0] = (i % 3 == 0 ? 0.02 : -0.01);
  LineSimulation simulation{Bodies{body}, Contacts{}, Boundaries{}, CentralDifference{.safety = 0.05}};
  const double initial = simulation.ledger().total();
  simulation.run(2e-8);
  const EnergyLedger& ledger = simulation.ledger();
  MESSAGE("dissipated " << ledger.dissipated / initial << " of the energy, balance " << ledger.error());
  CHECK(ledger.dissipated > 0.05 * initial);
  CHECK(ledger.error() < 0.02);
}

TEST_CASE("An inverted point and a NaN stop the run with the last good state") {
  bool told = false;
  double time_told = -1.0;
  const auto run = [&](auto& simulation) {
    std::string message;
    told = false;
    try {
      simulation.run(1e-6, Silent{}, every(1.0, [&](auto& s) {
                       told = s.steps() > 0;
                       time_told = s.time();
                     }));
    } catch (const ComputationError& error) {
      message = error.what();
    }
    return message;
  };
  const auto sound = [](const auto& body) {
    for (const Vector4& u : body.displacement)
      if (!u.allFinite()) return false;
    return true;
  };
  SUBCASE("inverted") {
    auto body = line({.length = 1e-6, .cells = 10});
    for (std::size_t i = 0; i < body.size(); ++i)
      body.velocity[i][0] = -3e3 * std::sin(2.0 * pi * body.table().particle_position[i][0] / 1e-6);
    Simulation simulation{Bodies{body}, Contacts{}, Boundaries{}, Unchecked{2e-11}};
    const std::string message = run(simulation);
    CAPTURE(message);
    CHECK(message.find("Body \"line\", particle ") == 0);
    CHECK(message.find("the point is inverted (J <= 0)") != std::string::npos);
    CHECK(sound(simulation.body<0>()));
    CHECK(told);
    CHECK(simulation.time() == test::relative(2e-11 * static_cast<double>(simulation.steps())).epsilon(1e-9));
    CHECK(time_told == simulation.time());
    auto restored = simulation.body<0>();
    restored.add_internal_forces(0.0, false);
    CHECK(restored.failed_point() == restored.table().points());
  }
  SUBCASE("not a number") {
    const auto force = [](const Vector3& X, double t) {
      return Vector3(t > 1e-9 && X[0] > 0.9e-6 ? std::numeric_limits<double>::quiet_NaN() : 0.0, 0.0, 0.0);
    };
    Simulation simulation{Bodies{line({.length = 1e-6, .cells = 10})}, Contacts{},
                          Boundaries{on<0>(BodyForce<decltype(force)>{force})}, CentralDifference{}};
    const std::string message = run(simulation);
    CAPTURE(message);
    CHECK(message.find("the displacement is not a number") != std::string::npos);
    CHECK(sound(simulation.body<0>()));
    CHECK(told);
  }
}

TEST_CASE("Values at the particles of a body on which nothing acts are those of the present instant") {
  Body body = block();
  const auto bottom = select(body.cloud(), [](const Point<3>& X) { return X[2] < -0.45e-6; });
  for (std::size_t i = 0; i < body.size(); ++i) body.velocity[i] = Vector4(0.3 * std::sin(1e6 * body.reference()[i][1]), 0.0, 0.1, 0.0);
  const double dt = 0.4 * largest_step(body);
  Simulation simulation{Bodies{std::move(body)}, Contacts{},
                        Boundaries{on<0>(PrescribedMotion{bottom, [](const Vector3&, double t) { return Vector3(0.2 * t, 0.0, 0.0); }, {true, false, false}})}, Unchecked{dt}};
  const auto displacement_after = [&](int steps) {
    for (int k = 0; k < steps; ++k) simulation.integrator().step(simulation, 1.0);
    return simulation.body<0>().displacement;
  };
  const Field before = displacement_after(4), present = displacement_after(1);
  const ParticleFields fields = simulation.particles<0>();
  const Field velocity(fields.velocity.begin(), fields.velocity.end()), position(fields.position.begin(), fields.position.end());
  CHECK(fields.force[3].norm() == 0.0);
  CHECK(fields.mass[5] == simulation.body<0>().masses()[5]);
  CHECK(fields.volume[5] == simulation.body<0>().nodal_volumes()[5]);
  const Field after = displacement_after(1);
  double off = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    CHECK(position[i] == Vector4(fields.reference[i] + present[i]));
    Vector4 difference = velocity[i] - (after[i] - before[i]) / (2.0 * dt);  // 0 in a leapfrog with equal steps, but for round-off
    if (std::find(bottom.begin(), bottom.end(), i) != bottom.end()) {  // what holds a particle is known a step later
      CHECK(velocity[i][0] == test::relative(0.2).epsilon(1e-2));
      difference[0] = 0.0;
    }
    off = std::max(off, difference.norm());
    largest = std::max(largest, velocity[i].norm());
  }
  CHECK(largest > 0.2);
  CHECK(off < 1e-9 * largest);
}

TEST_CASE("motion() counts mass, momentum and centre of mass") {
  auto body = line({.length = 1e-6, .cells = 10});
  for (Vector4& v : body.velocity) v[0] = 0.5;
  LineSimulation simulation{Bodies{body}, Contacts{}, Boundaries{}, CentralDifference{}};
  simulation.run(1e-8);
  const Motion m = motion<0>(simulation);
  CHECK(m.momentum[0] == test::relative(0.5 * m.mass).epsilon(1e-12));
  CHECK(m.center_of_mass[0] == test::relative(0.5e-6 + 0.5e-8).epsilon(1e-12));
}

}  // namespace simulation_test
