// The director in simulations, against exact solutions; and the same bits for any number of threads with everything on.
#include <cstring>
#include <numbers>

#include <doctest/doctest.h>

#include <tactoid/boundary/surface_tension.hpp>
#include <tactoid/contact/ligand_receptor.hpp>
#include <tactoid/contact/van_der_waals.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/body.hpp>
#include <tactoid/simulation/simulation.hpp>

#include "relative.hpp"

namespace simulation_director_test {

using namespace tactoid;

namespace {

constexpr double pi = std::numbers::pi;

std::vector<Index> everything(std::size_t n) {
  std::vector<Index> all(n);
  for (Index i = 0; i < n; ++i) all[i] = i;
  return all;
}

/// Periodic line with a director; the gel exerts no director stress, so that only the director moves.
template <class Initial>
auto line(const Initial& initial, DirectorField<> field, int cells = 48) {
  return Body{"line",
              bar({.length = 1e-6, .cells = cells, .periodic = true}),
              Rkpm<1>{},
              NodalCentroids{},
              Materials{Region{"body", NematicGel<>{.director_elasticity = 0.0, .activity = 0.0}}},
              field,
              initial};
}

}  // namespace

TEST_CASE("A Fourier mode of the director in a periodic line decays as exp(-D k² t)") {
  const double D = 1e-7, k = 2.0 * pi / 1e-6, small = 1e-4;
  const auto wave = [&](const Vector3& X) {
    const double angle = small * std::sin(k * X[0]);
    return Vector3(std::cos(angle), std::sin(angle), 0.0);
  };
  Simulation simulation{Bodies{line(wave, {.diffusivity = D, .core_size = 0.5e-6})}, Contacts{}, Boundaries{},
                        CentralDifference{.safety = 0.2}};
  const double end = 1.0 / (D * k * k);
  simulation.run(end);
  const auto& body = simulation.body<0>();
  double mode = 0.0;
  for (std::size_t i = 0; i < body.size(); ++i)
    mode += 2.0 / static_cast<double>(body.size()) * body.director[i][1] *
            std::sin(k * body.table().particle_position[i][0]);
  MESSAGE("decay over the exact one: " << mode / (small * std::exp(-1.0)));
  CHECK(mode == test::relative(small * std::exp(-1.0)).epsilon(0.02));
}

TEST_CASE("The length of a uniform director relaxes to 1 as the Ginzburg–Landau term says") {
  const double D = 1e-7, core = 0.1e-6, start = 0.3;
  const auto uniform = [&](const Vector3&) { return Vector3(0.0, start, 0.0); };
  Simulation simulation{Bodies{line(uniform, {.diffusivity = D, .core_size = core}, 8)}, Contacts{}, Boundaries{},
                        CentralDifference{.safety = 0.05}};
  const double end = core * core / D;
  simulation.run(end);
  const double exact = 1.0 / std::sqrt(1.0 + (1.0 / (start * start) - 1.0) * std::exp(-2.0));  // |h|² is logistic
  for (const Vector4& h : simulation.body<0>().director) {
    CHECK(h[1] == test::relative(exact).epsilon(0.01));
    CHECK(h[0] == 0.0);
  }
}

TEST_CASE("The director turns exactly with a rigidly rotating body, in 2D and with a director out of the plane") {
  const Vector3 start = Vector3(0.6, 0.0, 0.8);
  const double rate = 2.0 * pi / 1e-6, end = 0.3e-6;
  const PointCloud<2> cloud = jitter(rectangle({.size = {1e-6, 1e-6}, .cells = {5, 5}}), 0.15);
  PrescribedMotion turn{everything(cloud.size()), [=](const Vector3& X, double t) {
                          const double c = std::cos(rate * t), s = std::sin(rate * t);
                          return Vector3(c * X[0] - s * X[1] - X[0], s * X[0] + c * X[1] - X[1], 0.0);
                        }};
  Body body{"film",
            cloud,
            Rkpm<2>{},
            NodalCentroids{},
            Materials{Region{"body", NematicGel<>{}}},
            DirectorField<>{},
            UniformDirector{start}};
  Simulation simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{on<0>(turn)}, CentralDifference{}};
  simulation.run(end);
  CHECK(simulation.steps() > 20);
  const double c = std::cos(rate * end), s = std::sin(rate * end);
  const Vector3 expected(c * start[0] - s * start[1], s * start[0] + c * start[1], start[2]);
  for (const Vector4& h : simulation.body<0>().director) CHECK((h.head<3>() - expected).norm() < 1e-10);
}

TEST_CASE("A cell on a substrate with everything on: the same bits for 1, 2 and 4 threads") {
  const auto run = [](int threads) {
    set_thread_count(threads);
    NodalCentroids rule;
    rule.points_per_chunk = 16;
    Body cell{"cell",
              ball({.radius = 5e-6, .core_radius = 2e-6, .core_cells = 2, .shells = 2, .center = {0.0, 0.0, 5.15e-6}}),
              Rkpm<3>{},
              rule,
              Materials{Region{"nucleus", ModifiedMooneyRivlin{}}, Region{"cytoplasm", NematicGel<>{}}},
              DirectorField<>{},
              RandomDirector{{.correlation_length = 2e-6, .seed = 2}}};
    PointCloud<3> ground = disc({.radius = 8e-6, .height = 3e-6, .core_cells = 4, .rings = 2, .layers = 4});
    const auto bottom = select(ground, [](const Point<3>& X) { return X[2] < -2.99e-6; });
    Body substrate{"substrate", std::move(ground), Rkpm<3>{}, rule, Materials{Region{"body", YangVisco<>{}}}};
    Simulation simulation{
        Bodies{std::move(cell), std::move(substrate)},
        Contacts{between<0, 1>(LigandReceptor{}), between<0, 1>(VanDerWaals{}), between<0, 1>(ContactAnchoring{})},
        Boundaries{on<0>(SurfaceTension{}), on<1>(fixed(bottom))}, CentralDifference{}};
    simulation.run(0.5e-6);
    CHECK(simulation.steps() > 15);
    std::vector<Field> fields = {simulation.body<0>().displacement, simulation.body<0>().velocity,
                                 simulation.body<0>().director, simulation.body<1>().displacement,
                                 simulation.body<1>().velocity};
    const EnergyLedger& l = simulation.ledger();
    fields.push_back({Vector4(l.kinetic, l.strain, l.adhesion, l.surface),
                      Vector4(l.stabilization, l.dissipated, l.external_work, simulation.time())});
    return fields;
  };
  const int threads_before = thread_count();
  const std::vector<Field> one = run(1);
  double moved = 0.0;
  for (const Vector4& u : one[3]) moved += u.norm();
  CHECK(moved > 0.0);  // the contact has reached the substrate
  for (int threads : {2, 4}) {
    const std::vector<Field> more = run(threads);
    for (std::size_t f = 0; f < one.size(); ++f)
      CHECK(std::memcmp(one[f].data(), more[f].data(), one[f].size() * sizeof(Vector4)) == 0);
  }
  set_thread_count(threads_before);
}

TEST_CASE("Where the penalty of the director limits the step, the limit goes with 1/J") {
  const auto step = [](double stretch) {
    Body body{"bar", bar({.length = 1e-6, .cells = 12}), Rkpm<1>{}, NodalCentroids{},
              Materials{Region{"body", NematicGel<>{}}}, DirectorField<>{.diffusivity = 1e-3, .core_size = 1e-9},
              [](const Vector3&) { return Vector3(1.0, 0.0, 0.0); }};
    for (std::size_t i = 0; i < body.size(); ++i) body.displacement[i][0] = (stretch - 1.0) * body.cloud().positions[i][0];
    const Simulation simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{}, CentralDifference{}};
    return simulation.largest_stable_time_step();
  };
  CHECK(step(1.0) == test::relative(1e-15).epsilon(1e-3));  // ε_d²/D; the diffusion adds little
  CHECK(step(1.0) / step(1.25) == doctest::Approx(1.25).epsilon(1e-3));
}

}  // namespace simulation_director_test
