// Energy, momentum and angular momentum over many steps. Central differences are symplectic: the energy of the scheme
// swings about a mean by (ω Δt)² of the modes that move, and the mean does not drift; momenta are kept to round-off.
#include <tactoid/geometry/box.hpp>
#include <tactoid/geometry/ball.hpp>
#include <tactoid/geometry/jitter.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/rkpm.hpp>
#include <tactoid/material/modified_mooney_rivlin.hpp>
#include <tactoid/observe/motion.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/simulation/all.hpp>

#include "studies.hpp"

namespace tactoid::verification {
namespace balances_study {
namespace {

constexpr double radius = 2e-6;

auto elastic_body(double damping_time) {
  return Body{"ball", ball({.radius = radius, .core_cells = 3, .shells = 0}), Rkpm<3>{},
              NodalCentroids{.solid_damping_time = damping_time}, Materials{Region{"nucleus", ModifiedMooneyRivlin{}}}};
}

/// A ball that flies, spins and vibrates: stretched fast along one axis, with strains of several per cent.
void free_ball(Report& report, long steps) {
  auto body = elastic_body(0.0);
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector3 X = body.table().particle_position[i].head<3>() / radius;
    const Vector3 spin = Vector3(0.02, 0.05, 0.15).cross(X);
    body.velocity[i] = pad(
        Vector3(spin + Vector3(0.1 * X[0], -0.05 * X[1] + 0.03 * X[0] * X[2], -0.05 * X[2]) + Vector3(0.2, 0.1, 0.0)));
  }
  StableStep stable;
  stable.calibrate(body);
  const double step = 0.7 * stable.largest_step(body, 0.0);
  Simulation simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{}, CentralDifference{.time_step = step}};
  const Motion start = motion<0>(simulation);
  const double kinetic = simulation.ledger().kinetic, drifting = 0.5 * start.momentum.squaredNorm() / start.mass;
  const double scale = kinetic - drifting;  // of spin and vibration: the flight is no part of what could drift
  double linear = 0.0, angular = 0.0, swing = 0.0, strain = 0.0, first = 0.0, last = 0.0;
  long first_count = 0, last_count = 0;
  auto table = report.table("free", {"time_s", "defect_over_vibration", "momentum_drift", "angular_momentum_drift"});
  simulation.run((static_cast<double>(steps) - 0.5) * step, every_steps(1, [&](auto& s) {
                   const double defect = s.ledger().defect() / scale;
                   swing = std::max(swing, std::abs(defect));
                   strain = std::max(strain, s.ledger().strain);
                   const auto n = static_cast<long>(s.steps());
                   if (n > 0 && n <= steps / 10) first += defect, ++first_count;
                   if (n > steps - steps / 10) last += defect, ++last_count;
                   if (n % (steps / 500) != 0) return;
                   const Motion now = motion<0>(s);
                   const double p = (now.momentum - start.momentum).norm() / start.momentum.norm();
                   // About the centre of mass: of the spin alone.
                   const auto own = [](const Motion& m) {
                     return Vector3(m.angular_momentum - m.center_of_mass.cross(m.momentum));
                   };
                   const double l = (own(now) - own(start)).norm() / own(start).norm();
                   linear = std::max(linear, p);
                   angular = std::max(angular, l);
                   table.write(std::array{s.time(), defect, p, l});
                 }));
  const std::string over = fmt::format(", {} steps", simulation.steps());
  report.at_least("free ball: largest strain energy over that of spin and vibration" + over, strain / scale, 0.1,
                  "it does vibrate");
  report.at_most("free ball: drift of the mean energy, last tenth against first" + over,
                 std::abs(last / static_cast<double>(last_count) - first / static_cast<double>(first_count)), 1e-4,
                 "conserved; over spin and vibration");
  report.at_most("free ball: largest swing of the energy", swing, 1e-2,
                 "bounded; over spin and vibration, at 0.7 of the stable step");
  report.at_most("free ball: drift of the momentum" + over, linear, 1e-11, "round-off; over the momentum");
  report.at_most("free ball: drift of the angular momentum" + over, angular, 1e-8, "round-off; over that of the spin");
}

/// A body whose end is moved: the work of the motion is the gain of energy.
void driven_block(Report& report, long steps) {
  PointCloud<3> cloud = jitter(box({.size = {3e-6, 2e-6, 2e-6}, .cells = {3, 2, 2}}), 0.1);
  const auto end = select(cloud, [](const Point<3>& X) { return X[0] > 2.99e-6; });
  const auto start = select(cloud, [](const Point<3>& X) { return X[0] < 0.01e-6; });
  Body body{"block", std::move(cloud), Rkpm<3>{}, NodalCentroids{.solid_damping_time = 2e-9},
            Materials{Region{"body", ModifiedMooneyRivlin{}}}};
  StableStep stable;
  stable.calibrate(body);
  const double step = 0.3 * stable.largest_step(body, 0.0);  // deformation halves the stable step at times
  const auto shake = [](const Vector3&, double t) { return Vector3(0.0, 0.15e-6 * (1.0 - std::cos(4e6 * t)), 0.0); };
  Simulation simulation{Bodies{std::move(body)}, Contacts{},
                        Boundaries{on<0>(fixed(start)), on<0>(PrescribedMotion{end, shake})},
                        CentralDifference{.time_step = step}};
  double worst = 0.0;
  simulation.run((static_cast<double>(steps) - 0.5) * step,
                 every_steps(1, [&](auto& s) { worst = std::max(worst, std::abs(s.ledger().defect())); }));
  const EnergyLedger& energy = simulation.ledger();
  report.at_most(
      fmt::format("driven block: energy + dissipated - work, over the largest work, {} steps", simulation.steps()),
      worst / energy.largest_work, 1e-2, "balance; 0.3 of the stable step at rest");
  report.note("driven block: dissipated by the stabilisation over the largest work",
              energy.dissipated / energy.largest_work, std::numeric_limits<double>::quiet_NaN(), "part of the balance");
}

}  // namespace
}  // namespace balances_study

void balances(Report& report, Level level) {
  using namespace balances_study;
  const long steps = level == Level::full ? 100000 : 10000;
  free_ball(report, steps);
  driven_block(report, steps);
}

}  // namespace tactoid::verification
