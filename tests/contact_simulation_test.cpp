// Contact between moving bodies: what two free bodies exchange, and a body that bounces off a rigid plate.
#include <doctest/doctest.h>

#include <tactoid/boundary/all.hpp>
#include <tactoid/contact/all.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/observe/motion.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/simulation/all.hpp>

namespace contact_simulation_test {

using namespace tactoid;

namespace {

constexpr double radius = 2e-6;

auto elastic_ball(const char* name, double height, double speed) {
  Body body{name, ball({.radius = radius, .core_cells = 4, .shells = 0, .center = {0.1e-6, 0.0, height}}), Rkpm<3>{},
            NodalCentroids{.solid_damping_time = 0.0},
            Materials{Region{"nucleus", ModifiedMooneyRivlin{.c1 = 2126.0, .c2 = 170.0, .lambda = 1.7e5}}}};
  for (auto& v : body.velocity) v[2] = speed;
  return body;
}

}  // namespace

TEST_CASE("two free bodies that collide and stick keep their momentum to round-off") {
  Simulation simulation{Bodies{elastic_ball("upper", 4.15e-6, -0.1), elastic_ball("lower", 0.0, 0.05)},
                        Contacts{between<0, 1>(LigandReceptor{}), between<0, 1>(VanDerWaals{.strength = 1e5, .reaction = true})},
                        Boundaries{}, CentralDifference{.safety = 0.5}};
  const Motion upper = motion<0>(simulation), lower = motion<1>(simulation);
  const Vector3 start = upper.momentum + lower.momentum, spin = upper.angular_momentum + lower.angular_momentum;
  double drift = 0.0, exchanged = 0.0, angular = 0.0;
  simulation.run(4e-6, every_steps(10, [&](auto& s) {
                   const Motion a = motion<0>(s), b = motion<1>(s);
                   exchanged = std::max(exchanged, (a.momentum - upper.momentum).norm());
                   drift = std::max(drift, (a.momentum + b.momentum - start).norm());
                   angular = std::max(angular, (a.angular_momentum + b.angular_momentum - spin).norm());
                 }));
  const EnergyLedger& energy = simulation.ledger();
  MESSAGE("momentum exchanged ", exchanged, " kg m/s, drift ", drift / exchanged, " of it; angular drift ",
          angular / (exchanged * radius), " of exchange x radius; energy error ", energy.error(), ", ", simulation.steps(),
          " steps");
  CHECK(exchanged > 0.5 * upper.momentum.norm());  // they do collide
  CHECK(drift <= 1e-12 * exchanged);
  CHECK(angular <= 1e-11 * exchanged * radius);
  CHECK(energy.error() < 2e-3);
}

TEST_CASE("a ball bounces off a rigid plate: the plate feels the change of momentum") {
  // A gap law without adhesion; the impulse on the plate is the momentum that the ball gives up.
  Simulation simulation{Bodies{elastic_ball("ball", 2.15e-6, -0.1)}, Contacts{},
                        Boundaries{on<0>(RigidPlate{.point = {0.0, 0.0, 0.0}, .normal = {0.0, 0.0, 1.0},
                                                    .law = LigandReceptorLaw{.cutoff = 20.0}})},
                        CentralDifference{.safety = 0.3}};
  const double start = motion<0>(simulation).momentum[2];
  double impulse = 0.0, last_force = simulation.boundary<0>().force()[2];
  simulation.run(4e-6, every_steps(1, [&](auto& s) {
                   const double force = s.template boundary<0>().force()[2];
                   impulse += 0.5 * (force + last_force) * s.last_time_step();
                   last_force = force;
                 }));
  const double change = motion<0>(simulation).momentum[2] - start;
  MESSAGE("change of momentum ", change, ", impulse on the plate ", impulse, ", energy error ", simulation.ledger().error());
  CHECK(std::abs(change) > 0.5 * std::abs(start));
  CHECK(std::abs(change + impulse) < 1e-10 * std::abs(change));
  CHECK(simulation.ledger().error() < 1e-4);
}

TEST_CASE("a flat block that meets a stiff wall in one step: the step is short before the first touch") {
  // The step of the free block, 0.3 µs, is eight times too long for the wall. Met with it the block was thrown back.
  Body block{"block", rectangle({.size = {5e-6, 5e-6}, .cells = {4, 4}, .origin = {0.0, 0.25e-6}}), Rkpm<2>{},
             NodalCentroids{.solid_damping_time = 0.0}, Materials{Region{"body", NeoHookean::from_young(1.5e3, 0.45)}}};
  for (auto& v : block.velocity) v[1] = -0.05;
  Simulation simulation{Bodies{std::move(block)}, Contacts{},
                        Boundaries{on<0>(RigidPlate{.normal = Vector3::UnitY(), .law = RepulsiveWall{.penalty = 5e11}})},
                        CentralDifference{.safety = 0.5}};
  const double before = simulation.largest_stable_time_step();
  simulation.run(12e-6);
  MESSAGE("first stable step ", before, " s, last ", simulation.last_time_step(), " s, energy error ", simulation.ledger().error());
  CHECK(simulation.ledger().error() < 0.1);
}

TEST_CASE("a ball that hits a plate fast, with large steps, gains no energy") {
  // In ten steps the surface crosses the wall, whose stiffness rises from nothing to more than the ball's own: the step
  // must follow at once.
  Simulation simulation{Bodies{elastic_ball("ball", 2.3e-6, -0.4)}, Contacts{},
                        Boundaries{on<0>(RigidPlate{.law = LigandReceptorLaw{}})}, CentralDifference{}};
  const double initial = simulation.ledger().total();
  double error = 0.0;
  simulation.run(10e-6, every_steps(1, [&](auto& s) { error = std::max(error, std::abs(s.ledger().defect())); }));
  MESSAGE("energy error ", error / initial, " of the kinetic energy, ", simulation.steps(), " steps");
  CHECK(error < 0.1 * initial);
}

}  // namespace contact_simulation_test
