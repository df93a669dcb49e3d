// Bonds between material points of two surfaces, against closed forms.
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <doctest/doctest.h>

#include <tactoid/contact/all.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/body.hpp>
#include <tactoid/simulation/simulation.hpp>

#include "surface_bodies.hpp"

namespace contact_bonds_test {

using namespace tactoid;
using tactoid::test::Close;
using tactoid::test::TestBody;

namespace {

constexpr double um = 1e-6, nm = 1e-9, pN = 1e-12;
constexpr double infinite = std::numeric_limits<double>::infinity();

/// A cube of 1 µm whose lower side is the plane z = 0, above a slab of 4 µm that reaches up to it.
struct Pair {
  TestBody<3> cube{box({.size = Point<3>(um, um, um), .cells = {1, 1, 1}, .origin = Point<3>(-0.6 * um, -0.4 * um, 0.0)})};
  TestBody<3> slab{box({.size = Point<3>(4.0 * um, 4.0 * um, um), .cells = {8, 8, 2}, .origin = Point<3>(-2.0 * um, -2.0 * um, -um)})};
  TetheredBonds bonds;
  TermEnergy energy;

  explicit Pair(TetheredBonds law) : bonds(std::move(law)) {
    cube.place(Vector3(0.0, 0.0, 1.0 * nm));
    bonds.initialize(cube.cloud, cube.fields(), slab.cloud, slab.fields());
  }
  /// Forces with the cube shifted, at a time.
  Vector3 pull(const Vector3& shift, double time) {
    cube.place(shift);
    return apply(time);
  }
  /// Forces as it is; gives the force on the cube.
  Vector3 apply(double time) {
    energy = bonds.apply(cube.fields(), slab.fields(), time);
    Vector4 sum = Vector4::Zero();
    for (const Vector4& f : cube.force) sum += f;
    return sum.head<3>();
  }
  /// Every receptor within reach is bound, at t = 0, and none binds any more.
  void bind(const Vector3& shift) {
    const BondKinetics kinetics = bonds.kinetics;
    bonds.kinetics = {.on_rate = 1e12, .off_rate = 0.0};
    pull(shift, -1e-9);
    pull(shift, 0.0);
    bonds.kinetics = kinetics;
    bonds.kinetics.on_rate = 0.0;
  }
};

constexpr double receptors = 1e14 * um * um;  // of the lower side: 100

}  // namespace

TEST_CASE("Bonds under a constant force break at Bell's rate, or at that of catch and slip") {
  for (const double catch_rate : {0.0, 3e5}) {
    Pair pair({.rest_length = 1.0 * nm, .kinetics = {.off_rate = 1e5, .slip_force = 10.0 * pN, .catch_rate = catch_rate, .catch_force = 4.0 * pN}});
    pair.bind(Vector3(0.0, 0.0, 1.0 * nm));
    REQUIRE(pair.bonds.bonds() == Close{receptors, 1e-12});
    // Drawn out by 8 nm, which is 8 pN, for a microsecond in three unequal steps.
    const double rate = 1e5 * std::exp(0.8) + catch_rate * std::exp(-2.0);
    for (const double t : {0.0, 0.2e-6, 0.3e-6, 1e-6}) {
      const Vector3 force = pair.pull(Vector3(0.0, 0.0, 9.0 * nm), t);
      CHECK(pair.bonds.bonds() == Close{receptors * std::exp(-rate * t), 1e-10});
      CHECK(force[2] == Close{-receptors * std::exp(-rate * t) * 8.0 * pN, 1e-10});
    }
  }
  CHECK(BondKinetics{.slip_force = 1.0 * pN}.detachment_rate(-5.0 * pN) == BondKinetics{}.detachment_rate(0.0));  // compressed
  CHECK(std::isfinite(BondKinetics{}.detachment_rate(1.0)));
}

TEST_CASE("Bonds that are stretched at a constant rate break at Bell's mean force and most probable force") {
  constexpr double F = 10.0 * pN, off = 1e5, speed = 0.05, rate = 1e-3 * speed, x = off * F / rate;
  const double mean = -F * std::exp(x) * std::expint(-x);  // F eˣ E₁(x)
  const double most_probable = F * std::log(rate / (off * F));
  for (const bool stochastic : {false, true}) {
    Pair pair({.density = stochastic ? 2e15 : 1e14, .kinetics = {.off_rate = off, .slip_force = F}, .stochastic = stochastic});
    pair.bind(Vector3::Zero());
    const double all = pair.bonds.bonds();
    double sum = 0.0, before = all, steepest = 0.0, at = 0.0, work = 0.0, pulled = 0.0, dissipated = 0.0;
    const double step = stochastic ? 1e-9 : 1e-10;
    for (int k = 1; k * step * rate < 12.0 * F; ++k) {
      const double force = -pair.pull(Vector3(0.0, 0.0, speed * k * step), k * step)[2];
      const double now = pair.bonds.bonds();
      sum += 0.5 * (before + now) * rate * step;
      if (before - now > steepest) steepest = before - now, at = k * step * rate;
      work += 0.5 * (pulled + force) * speed * step;
      dissipated += pair.energy.dissipated_power * step;
      pulled = force;
      before = now;
    }
    MESSAGE("stochastic " << stochastic << ": mean over Bell's " << sum / all / mean << ", most probable over Bell's " << at / most_probable
                          << ", energy lost over work " << (dissipated + pair.energy.potential) / work);
    // The spread of a single rupture is below F; there are 2000 stochastic bonds.
    CHECK(sum / all == Close{mean, stochastic ? 4.0 * F / mean / std::sqrt(all) : 1e-3});
    if (!stochastic) CHECK(at == Close{most_probable, 2e-3});
    CHECK(dissipated + pair.energy.potential == Close{work, stochastic ? 1e-2 : 2e-3});
  }
}

TEST_CASE("Pulled off at a constant speed: the force over the distance, its maximum, the work of separation") {
  // n(F) = N exp(−a (e^x − 1)), x = F/F_b, a = k F_b/(κ v): the force N F_b x exp(−a (e^x − 1)) is largest where a x eˣ = 1.
  constexpr double F_b = 10.0 * pN, off = 1e5, stiffness = 1e-3;
  for (const double speed : {0.005, 0.05}) {
    const double a = off * F_b / (stiffness * speed);
    const auto exact = [&](double x) { return receptors * F_b * x * std::exp(-a * std::expm1(x)); };
    double strongest = 1.0;
    for (int k = 0; k < 50; ++k) strongest -= (a * strongest * std::exp(strongest) - 1.0) / (a * (1.0 + strongest) * std::exp(strongest));
    const double largest = receptors * F_b * strongest * std::exp(a - 1.0 / strongest);
    REQUIRE(exact(strongest) == Close{largest, 1e-10});
    const double end = 8.0;
    double separation = 0.0;  // ∫ force d(distance), by Simpson's rule
    for (int k = 0; k <= 4000; ++k) separation += exact(end * k / 4000.0) * (k == 0 || k == 4000 ? 1.0 : k % 2 == 1 ? 4.0 : 2.0);
    separation *= end / 4000.0 / 3.0 * F_b / stiffness;

    struct Pulled {
      double curve = 0.0, largest = 0.0, at = 0.0, work = 0.0;
    };
    const auto pull_off = [&](int steps) {
      Pair pair({.stiffness = stiffness, .kinetics = {.off_rate = off, .slip_force = F_b}});
      pair.bind(Vector3::Zero());
      const double step = end * F_b / (stiffness * speed) / steps;
      Pulled p;
      double before = 0.0;
      for (int k = 1; k <= steps; ++k) {
        const double force = -pair.pull(Vector3(0.0, 0.0, speed * k * step), k * step)[2], x = end * k / steps;
        p.curve = std::max(p.curve, std::abs(force - exact(x)) / largest);
        if (force > p.largest) p.largest = force, p.at = x;
        p.work += 0.5 * (before + force) * speed * step;
        before = force;
      }
      return p;
    };
    const Pulled coarse = pull_off(8000), fine = pull_off(16000);
    MESSAGE("at " << speed << " m/s: largest force " << largest / pN << " pN, " << fine.largest / largest - 1.0 << " off, at "
                  << strongest << " F_b; curve within " << coarse.curve << ", " << fine.curve << " of it; work " << fine.work / separation - 1.0 << " off");
    CHECK(fine.curve < 4e-4);
    CHECK(coarse.curve / fine.curve == Close{2.0, 0.02});  // first order in the step
    CHECK(fine.largest == Close{largest, 4e-4});
    CHECK(fine.at == Close{strongest, 2e-2});  // the maximum is flat
    CHECK(fine.work == Close{separation, 4e-4});
  }
}

TEST_CASE("Pulled off where force does not matter: bonds in equilibrium up to the capture distance, then what is left") {
  constexpr double on = 3e6, off = 1e6, rest = 10.0 * nm, reach = 30.0 * nm, stiffness = 1e-3;
  constexpr double bound = receptors * on / (on + off), step = 1e-9;
  for (const double speed : {1e-4, 1e-2}) {
    Pair pair({.stiffness = stiffness, .rest_length = rest, .capture_distance = reach * (1.0 - 1e-9),
               .kinetics = {.on_rate = on, .off_rate = off, .slip_force = infinite}});
    const Vector3 start(0.0, 0.0, 20.0 * nm);
    pair.pull(start, -1.0);
    pair.pull(start, 0.0);  // a second is eternity: equilibrium
    REQUIRE(pair.bonds.bonds() == Close{bound, 1e-12});
    const double path = speed / off;  // how far it moves in the life of a bond
    const double h = speed < 1e-3 ? 100.0 * step : step, end = reach + 12.0 * path;
    double work = 0.0, before = bound * stiffness * 10.0 * nm, largest = 0.0, off_by = 0.0;
    for (int k = 1; start[2] + speed * k * h < end; ++k) {
      const double z = start[2] + speed * k * h, force = -pair.pull(Vector3(0.0, 0.0, z), k * h)[2];
      // The step that ends at the capture distance is the first in which none forms.
      const double lost = z < reach * (1.0 - 1e-8) ? 0.0 : (z - reach) / path + off * h;
      off_by = std::max(off_by, std::abs(force / (bound * stiffness * (z - rest) * std::exp(-lost)) - 1.0));
      largest = std::max(largest, force);
      work += 0.5 * (before + force) * speed * h;
      before = force;
    }
    CHECK(off_by < 1e-8);
    // Elastic up to the capture distance; beyond it ∫ n κ (z − ℓ) e^{−(z − d)/path} dz.
    const double d = reach - rest;
    const double exact = bound * stiffness * (0.5 * (d * d - 100.0 * nm * nm) + d * path + path * path);
    MESSAGE("at " << speed << " m/s: work " << work / exact - 1.0 << " off, largest force " << largest / (bound * stiffness * d)
                     << " of that at the capture distance, curve within " << off_by);
    CHECK(work == Close{exact, 2.0 * off * h * path / d + 1e-3});
    if (speed < 1e-3) CHECK(largest == Close{bound * stiffness * d, 1e-3});  // slow: what equilibrium gives
  }
}

TEST_CASE("Pulled off with bonds that catch, slip and form again: against the equation of the kinetics") {
  // n' = k_on (N − n) − k_off(F) n within reach, by Runge and Kutta's rule with a fine step.
  constexpr double speed = 0.02, on = 1e6, rest = 5.0 * nm, reach = 25.0 * nm, stiffness = 1e-3;
  const BondKinetics kinetics{.on_rate = on, .off_rate = 2e4, .slip_force = 5.0 * pN, .catch_rate = 2e6, .catch_force = 5.0 * pN};
  const auto rate = [&](double t, double n) {
    const double z = speed * t, f = std::max(0.0, stiffness * (z - rest));
    return (z < reach ? on * (receptors - n) : 0.0) - (2e4 * std::exp(f / (5.0 * pN)) + 2e6 * std::exp(-f / (5.0 * pN))) * n;
  };
  const auto worst = [&](int steps) {
    Pair pair({.stiffness = stiffness, .rest_length = rest, .capture_distance = reach, .kinetics = kinetics});
    pair.pull(Vector3::Zero(), 0.0);
    constexpr double end = 2.5e-6;  // 50 nm
    const double step = end / steps;
    double n = 0.0, off_by = 0.0, largest = 0.0;
    for (int k = 1; k <= steps; ++k) {
      constexpr int fine = 4;
      for (int i = 0; i < fine; ++i) {
        const double h = step / fine, t = (k - 1) * step + i * h;
        const double a = rate(t, n), b = rate(t + 0.5 * h, n + 0.5 * h * a), c = rate(t + 0.5 * h, n + 0.5 * h * b), e = rate(t + h * (1.0 - 1e-9), n + h * c);
        n += h / 6.0 * (a + 2.0 * b + 2.0 * c + e);
      }
      const double z = speed * k * step, force = -pair.pull(Vector3(0.0, 0.0, z), k * step)[2];
      off_by = std::max(off_by, std::abs(force - n * stiffness * (z - rest)));
      largest = std::max(largest, force);
    }
    MESSAGE("largest force " << largest / pN << " pN, curve within " << off_by / largest << " of it");
    return off_by / largest;
  };
  const double coarse = worst(5000), fine = worst(10000);
  CHECK(fine < 1e-3);
  CHECK(coarse / fine == Close{2.0, 0.05});
}

TEST_CASE("The density of bonds relaxes to its equilibrium at the sum of the rates") {
  for (const bool stochastic : {false, true}) {
    Pair pair({.density = stochastic ? 2e15 : 1e14, .kinetics = {.on_rate = 3e5, .off_rate = 1e5, .slip_force = infinite}, .stochastic = stochastic});
    const double all = stochastic ? 20.0 * receptors : receptors;
    const Vector3 place(0.0, 0.0, 10.0 * nm);
    pair.pull(place, 0.0);
    CHECK(pair.bonds.bonds() == 0.0);
    const int steps = stochastic ? 400 : 7;
    for (int k = 1; k <= steps; ++k) {
      const double t = 2e-6 * k / steps;
      pair.pull(place, t);
      const double expected = 0.75 * all * (1.0 - std::exp(-4e5 * t));
      if (stochastic) CHECK(std::abs(pair.bonds.bonds() - expected) < 5.0 * std::sqrt(all));
      else CHECK(pair.bonds.bonds() == Close{expected, 1e-10});
    }
    // Beyond the capture distance none forms, and those that are there vanish.
    const double before = pair.bonds.bonds();
    for (int k = 1; k <= steps; ++k) pair.pull(Vector3(0.0, 0.0, 31.0 * nm), 2e-6 * (1.0 + double(k) / steps));
    CHECK(pair.bonds.bonds() == Close{before * std::exp(-0.2), stochastic ? 0.05 : 1e-10});
  }
}

TEST_CASE("Friction of bonded surfaces that slide slowly: density, stiffness, mean lifetime") {
  constexpr double off = 1e6, on = 4e6, speed = 0.02;
  const double bound = receptors * on / (on + off), expected = bound * 1e-3 * speed / off;
  const auto slide = [&](double step) {
    Pair pair({.kinetics = {.on_rate = on, .off_rate = off, .slip_force = infinite}});
    Vector3 force = Vector3::Zero();
    const int steps = static_cast<int>(std::lround(30e-6 / step));  // over 0.6 µm: across the facets of the slab
    for (int k = 0; k <= steps; ++k) force = pair.pull(speed * k * step * Vector3(0.8, 0.6, 0.0), k * step);
    CHECK(force.cross(Vector3(0.8, 0.6, 0.0)).norm() < 1e-6 * force.norm());
    // Lifetimes are exponential: ⟨s²⟩ = 2 ⟨s⟩², and all that is done to them is lost in bonds that break.
    CHECK(pair.energy.potential == Close{bound * 1e-3 * speed * speed / off / off, 2.0 * off * step});
    CHECK(pair.energy.dissipated_power == Close{expected * speed, 2.0 * off * step});
    CHECK(pair.energy.external_power < 1e-12 * pair.energy.dissipated_power);  // they form without a length
    return -force.dot(Vector3(0.8, 0.6, 0.0)) / expected;
  };
  const double coarse = slide(2e-8), fine = slide(1e-8);
  MESSAGE("friction over its coefficient: " << coarse << ", " << fine);
  CHECK(fine == Close{1.0, 6e-3});
  CHECK((coarse - 1.0) / (fine - 1.0) == Close{2.0, 0.03});  // first order in the step
}

TEST_CASE("Bonds conserve momentum and angular momentum, and follow their energy") {
  Pair pair({.rest_length = 5.0 * nm, .kinetics = {.off_rate = 0.0}});
  pair.bind(Vector3(0.0, 0.0, 8.0 * nm));
  pair.cube.place(Vector3(40.0 * nm, -20.0 * nm, 15.0 * nm), 10.0 * nm, 3, 0.1, Vector3(1.0, 2.0, 3.0));
  pair.slab.place(Vector3::Zero(), 10.0 * nm, 5);
  pair.apply(0.0);
  Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
  double size = 0.0;
  for (const auto* body : {&pair.cube, &pair.slab})
    for (std::size_t i = 0; i < body->cloud.size(); ++i) {
      force += body->force[i].head<3>();
      torque += body->position[i].head<3>().cross(body->force[i].head<3>());
      size += body->force[i].norm();
    }
  CHECK(force.norm() < 1e-13 * size);
  CHECK(torque.norm() < 1e-13 * size * um);
  // f = −∂E/∂x of either body.
  for (auto* body : {&pair.cube, &pair.slab}) {
    const Field forces = body->force;
    double largest = 0.0;
    for (std::size_t i = 0; i < body->cloud.size(); ++i) largest = std::max(largest, forces[i].norm());
    for (std::size_t i = 0; i < body->cloud.size(); ++i) {
      if (forces[i].norm() < 0.1 * largest) continue;
      for (int k = 0; k < 3; ++k) {
        const double h = 1e-3 * nm, x = body->position[i][k];
        body->position[i][k] = x + h;
        pair.apply(0.0);
        const double up = pair.energy.potential;
        body->position[i][k] = x - h;
        pair.apply(0.0);
        CHECK((pair.energy.potential - up) / (2.0 * h) == doctest::Approx(forces[i][k]).epsilon(1e-6).scale(largest));
        body->position[i][k] = x;
      }
    }
    pair.apply(0.0);
  }
}

TEST_CASE("Receptors of the second body: the same as the bodies in the other order") {
  const TetheredBonds law{.rest_length = 5.0 * nm, .kinetics = {.off_rate = 0.0}};
  Pair pair(law);
  TetheredBonds second = law;
  second.sampled = ContactSide::second;
  auto cube = pair.cube.fields(), slab = pair.slab.fields();
  second.initialize(pair.slab.cloud, slab, pair.cube.cloud, cube);
  for (int k = 0; k < 3; ++k) {
    pair.pull(Vector3(3.0 * k * nm, 0.0, (8.0 + k) * nm), 1e-6 * k);
    const Field on_cube = pair.cube.force, on_slab = pair.slab.force;
    cube = pair.cube.fields(), slab = pair.slab.fields();
    CHECK(second.apply(slab, cube, 1e-6 * k).potential == pair.energy.potential);
    CHECK(pair.cube.force == on_cube);
    CHECK(pair.slab.force == on_slab);
    CHECK(second.stiffness_rate(slab, cube) == pair.bonds.stiffness_rate(cube, slab));
    const auto stiffness = [](const TetheredBonds& bonds, const ParticleFields& a, const ParticleFields& b, bool exchanged) {
      std::map<std::array<Index, 4>, double> sums;
      bonds.add_stiffness(a, b, [&](bool of_b, Index i, bool by_b, Index j, const Tensor3& K) {
        sums[{Index(of_b != exchanged), i, Index(by_b != exchanged), j}] += K(2, 2) + 2.0 * K(0, 0) + 3.0 * K(0, 2);
      });
      return sums;
    };
    const auto sums = stiffness(second, slab, cube, false);
    CHECK(sums.empty() == (k == 0));  // no time has gone by yet
    CHECK(sums == stiffness(pair.bonds, cube, slab, true));
  }
  CHECK(second.bonds() > 0.0);
}

TEST_CASE("The same bits for any number of threads, and after a restart") {
  const auto last = [](int threads, bool restart) {
    set_thread_count(threads);
    const TetheredBonds law{.density = 2e14, .rest_length = 5.0 * nm, .kinetics = {.on_rate = 2e6, .off_rate = 1e6}, .stochastic = true, .seed = 11};
    Pair pair(law);
    for (int k = 0; k < 60; ++k) {
      if (restart && k == 30) {
        SavedState saved;
        StateWriter writer(saved);
        pair.bonds.state(writer);
        Pair other(law);
        StateReader reader(saved);
        other.bonds.state(reader);
        pair.bonds = other.bonds;
      }
      pair.pull(Vector3(0.3 * k * nm, 0.0, 10.0 * nm), 2e-8 * k);
    }
    set_thread_count(1);
    return std::pair(pair.bonds.bonds(), pair.cube.force);
  };
  const auto one = last(1, false);
  CHECK(one.first > 50.0);
  for (const auto& other : {last(2, false), last(4, false), last(1, true)}) {
    CHECK(other.first == one.first);
    CHECK(other.second == one.second);
  }
}

TEST_CASE("Two blocks that bonds hold together: momentum and energy in a run") {
  const auto energy_error = [](double safety) {
    const auto block = [](const char* name, double z) {
      return Body{name, box({.size = {um, um, 0.5 * um}, .cells = {3, 3, 2}, .origin = {0.0, 0.0, z}}), Rkpm<3>{}, NodalCentroids{},
                  Materials{Region{"body", NeoHookean::from_young(1e6, 0.3)}}};
    };
    Body upper = block("upper", 10.0 * nm), lower = block("lower", -0.5 * um);
    upper.velocity.assign(upper.size(), Vector4(0.02, 0.0, 0.0, 0.0));
    Simulation simulation{Bodies{std::move(upper), std::move(lower)},
                          Contacts{between<0, 1>(TetheredBonds{.density = 1e15, .rest_length = 10.0 * nm, .kinetics = {.on_rate = 1e7, .off_rate = 1e6}})},
                          Boundaries{}, CentralDifference{.safety = safety}};
    const auto momenta = [&] {
      Vector3 linear = Vector3::Zero(), angular = Vector3::Zero();
      const auto add = [&](const auto& body, const Field& v) {
        for (std::size_t i = 0; i < body.size(); ++i) {
          const Vector3 x = (body.table().particle_position[i] + body.displacement[i]).template head<3>(), p = body.masses()[i] * v[i].template head<3>();
          linear += p;
          angular += x.cross(p);
        }
      };
      add(simulation.body<0>(), simulation.velocity<0>());
      add(simulation.body<1>(), simulation.velocity<1>());
      return std::pair(linear, angular);
    };
    const auto [p, l] = momenta();
    simulation.run(1e-6);
    const auto [p_end, l_end] = momenta();
    MESSAGE("bonds " << simulation.contact<0>().bonds() << ", momentum changed by " << (p_end - p).norm() / p.norm() << ", angular momentum by "
                     << (l_end - l).norm() / l.norm() << ", energy error " << simulation.ledger().error() << " in " << simulation.steps() << " steps");
    CHECK(simulation.contact<0>().bonds() > 500.0);
    CHECK((p_end - p).norm() < 1e-12 * p.norm());
    CHECK((l_end - l).norm() < 1e-8 * l.norm());  // the leapfrog keeps it to the order of the step
    return simulation.ledger().error();
  };
  const double coarse = energy_error(0.2), fine = energy_error(0.05);
  CHECK(coarse < 1e-2);
  CHECK(coarse / fine == doctest::Approx(4.0).epsilon(0.2));  // kinetics are first order in the step
}

TEST_CASE("Wrong parameters of bonds are refused") {
  const auto refused = [](TetheredBonds law, const std::string& name) {
    try {
      law.validate();
    } catch (const ParameterError& error) {
      return std::string(error.what()).find(name) != std::string::npos;
    }
    return false;
  };
  CHECK(refused({.density = 0.0}, "TetheredBonds.density"));
  CHECK(refused({.stiffness = -1.0}, "TetheredBonds.stiffness"));
  CHECK(refused({.rest_length = -1.0}, "TetheredBonds.rest_length"));
  CHECK(refused({.capture_distance = 0.0}, "TetheredBonds.capture_distance"));
  CHECK(refused({.kinetics = {.on_rate = -1.0}}, "BondKinetics.on_rate"));
  CHECK(refused({.kinetics = {.off_rate = std::nan("")}}, "BondKinetics.off_rate"));
  CHECK(refused({.kinetics = {.slip_force = 0.0}}, "BondKinetics.slip_force"));
  CHECK(refused({.kinetics = {.catch_rate = -1.0}}, "BondKinetics.catch_rate"));
  CHECK(refused({.kinetics = {.catch_force = infinite}}, "BondKinetics.catch_force"));
  CHECK(refused({.sampled = ContactSide::both}, "TetheredBonds.sampled"));
}

}  // namespace contact_bonds_test
