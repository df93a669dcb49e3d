// Collisions without dissipation: a ball that bounces on a rigid plate in the adhesive potential, and two deformable
// bodies.
#include <tactoid/boundary/body_force.hpp>
#include <tactoid/contact/all.hpp>
#include <tactoid/geometry/ball.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/rkpm.hpp>
#include <tactoid/material/modified_mooney_rivlin.hpp>
#include <tactoid/observe/motion.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/simulation/all.hpp>

#include "studies.hpp"

namespace tactoid::verification {
namespace bouncing_study {
namespace {

constexpr double radius = 2e-6;

auto elastic_ball(int cells, Point<3> center, const Vector3& velocity) {
  Body body{"ball", ball({.radius = radius, .core_cells = cells, .shells = 0, .center = center}), Rkpm<3>{},
            NodalCentroids{.solid_damping_time = 0.0}, Materials{Region{"nucleus", ModifiedMooneyRivlin{}}}};
  for (auto& v : body.velocity) v = pad(velocity);
  return body;
}

struct Bounces {
  int count = 0;
  double error = 0.0, final_error = 0.0, deepest = 0.0;  // energy over the kinetic energy at the start
};

/// A ball is thrown down and brought back by a body force, ten times.
Bounces bounce(int cells, double speed, CentralDifference integrator, HistoryWriter* table) {
  const double gravity = speed * speed / 0.5e-6;  // it would rise by 0.25 µm
  auto body = elastic_ball(cells, {0.0, 0.0, radius + 0.3e-6}, {0.0, 0.0, -speed});
  Simulation simulation{Bodies{std::move(body)}, Contacts{},
                        Boundaries{on<0>(RigidPlate{.law = LigandReceptorLaw{}}),
                                   on<0>(BodyForce<>{.acceleration = {0.0, 0.0, -gravity}})},
                        integrator};
  Bounces b;
  const double scale = simulation.ledger().kinetic;
  double momentum = motion<0>(simulation).momentum[2];
  const double interval = 0.2e-6 / speed;
  while (b.count < 10 && simulation.time() < 400.0 * interval)
    simulation.run(simulation.time() + interval, every_steps(10, [&](auto& s) {
                     if (b.count >= 10) return;
                     const Motion now = motion<0>(s);
                     if (momentum < 0.0 && now.momentum[2] >= 0.0) ++b.count;
                     momentum = now.momentum[2];
                     b.final_error = s.ledger().defect() / scale;
                     b.error = std::max(b.error, std::abs(b.final_error));
                     // Terms on a boundary count as surface energies: what is not that of the body force is adhesion.
                     const double adhesion = (s.ledger().surface - now.mass * gravity * now.center_of_mass[2]) / scale;
                     b.deepest = std::min(b.deepest, adhesion);
                     if (table)
                       table->write(std::array{s.time(), now.center_of_mass[2], b.final_error,
                                               s.ledger().kinetic / scale, adhesion});
                   }));
  return b;
}

void single_ball(Report& report, Level level) {
  auto table =
      report.table("height", {"time_s", "height_m", "energy_error", "kinetic_over_initial", "adhesion_over_initial"});
  const int cells = level == Level::full ? 6 : 4;
  const Bounces b = bounce(cells, 0.05, {.safety = 0.3}, &table);
  report.at_least("bounces of the ball, 0.05 m/s", b.count, 10.0, "counted by the sign of its momentum");
  report.at_least("depth of the adhesive well over the kinetic energy", -b.deepest, 0.05, "adhesion matters");
  report.at_most("largest change of the total energy in ten bounces, 0.05 m/s, safety 0.3", b.error, 1e-3,
                 "conserved; over the kinetic energy at the start");
  if (level == Level::fast) return;
  // What faster impacts cost, by the step: the wall of 30 nm is crossed in few steps.
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (const double speed : {0.1, 0.3})
    for (const double safety : {0.8, 0.3, 0.1})
      report.note(fmt::format("the same, {} m/s, safety {}", speed, safety),
                  bounce(4, speed, {.safety = safety}, nullptr).error, none, "second order in the step");
}

void two_balls(Report& report, Level level) {
  const int cells = level == Level::full ? 6 : 4;
  Simulation simulation{Bodies{elastic_ball(cells, {0.6e-6, 0.2e-6, 4.3e-6}, {-0.02, 0.0, -0.1}),
                               elastic_ball(cells, Point<3>::Zero(), {0.01, 0.0, 0.05})},
                        Contacts{between<0, 1>(LigandReceptor{})}, Boundaries{}, CentralDifference{.safety = 0.3}};
  const Motion upper = motion<0>(simulation), lower = motion<1>(simulation);
  const Vector3 momentum = upper.momentum + lower.momentum, spin = upper.angular_momentum + lower.angular_momentum;
  double exchanged = 0.0, exchanged_spin = 0.0, drift = 0.0, angular = 0.0, error = 0.0;
  const double kinetic = simulation.ledger().kinetic;
  simulation.run(12e-6, every_steps(10, [&](auto& s) {
                   const Motion a = motion<0>(s), b = motion<1>(s);
                   exchanged = std::max(exchanged, (a.momentum - upper.momentum).norm());
                   exchanged_spin = std::max(exchanged_spin, (a.angular_momentum - upper.angular_momentum).norm());
                   drift = std::max(drift, (a.momentum + b.momentum - momentum).norm());
                   angular = std::max(angular, (a.angular_momentum + b.angular_momentum - spin).norm());
                   error = std::max(error, std::abs(s.ledger().defect()));
                 }));
  report.at_least("two balls: momentum exchanged over that of the first", exchanged / upper.momentum.norm(), 0.5,
                  "they do collide");
  report.at_most("two balls: drift of the total momentum over what is exchanged", drift / exchanged, 1e-12,
                 "action and reaction");
  report.at_most("two balls: drift of the total angular momentum over what is exchanged", angular / exchanged_spin,
                 1e-11, "action and reaction");
  report.at_most("two balls: largest change of the total energy", error / kinetic, 5e-3,
                 "conserved; over the kinetic energy at the start");
}

}  // namespace
}  // namespace bouncing_study

void bouncing(Report& report, Level level) {
  using namespace bouncing_study;
  single_ball(report, level);
  two_balls(report, level);
}

}  // namespace tactoid::verification
