// A soft ball is pulled onto an elastic disc, sticks and spreads: the smallest complete program.
#include <tactoid/tactoid.hpp>

int main() {
  using namespace tactoid;
  PointCloud<3> disc_cloud = disc({.radius = 8_um, .height = 2_um, .core_cells = 8, .rings = 4, .layers = 4});
  const auto bottom = select(disc_cloud, [](const Point<3>& X) { return X[2] < -1.99_um; });
  PointCloud<3> ball_cloud = ball({.radius = 5_um, .core_radius = 2_um, .core_cells = 6, .shells = 3,
                                   .center = {0.0, 0.0, 5.2_um}, .core_region = "core", .shell_region = "shell"});

  Body soft{"ball", std::move(ball_cloud), Rkpm<3>{}, NodalCentroids{},
            Materials{Region{"core", ModifiedMooneyRivlin{}}, Region{"shell", NeoHookean{.mu = 300.0}}}};
  Body base{"disc", std::move(disc_cloud), Rkpm<3>{}, NodalCentroids{},
            Materials{Region{"body", NeoHookean::from_young(100_kPa, 0.4)}}};

  Simulation simulation{Bodies{std::move(soft), std::move(base)},
                        Contacts{between<0, 1>(LigandReceptor{}), between<0, 1>(VanDerWaals{.strength = 1e6})},
                        Boundaries{on<0>(SurfaceTension{}), on<1>(fixed(bottom))}, CentralDifference{.safety = 0.3}};
  simulation.run(2_us, every(0.5_us, [](auto& s) {
    fmt::print("t = {:.1f} us: the centre of the ball is at z = {:.3f} um, energy error {:.1e}\n", 1e6 * s.time(),
               1e6 * motion(s.template particles<0>()).center_of_mass[2], s.ledger().error());
  }));
  auto& body = simulation.body<0>();
  write_body_frame("ball.vtu", body, simulation.particles<0>(), stress_fields(body), simulation.time());
}
