#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include <tactoid/tactoid.hpp>

#include "fields.hpp"
#include "relative.hpp"

namespace quadrature_stored_test {

using namespace tactoid;

namespace {

PointCloud<3> brick() { return jitter(box({.size = {2_um, 1.5_um, 1_um}, .cells = {6, 5, 4}}), 0.2, 7); }

/// A block in rotation, stretched and sheared, in both precisions.
template <class Real>
auto block(NodalCentroids rule = {.solid_ratio = 0.1}) {
  Body body{"block", brick(), Rkpm<3>{}, stored_as<Real>(rule), Materials{Region{"body", NeoHookean{.mu = 3_kPa, .lambda = 40_kPa}}}};
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector3 X = body.reference()[i].template head<3>();
    body.displacement[i] = pad(Vector3(0.2 * X[0] + 0.1 * X[1], 0.05 * std::sin(2e6 * X[2]) * 1_um - 0.1 * X[1], 0.15 * X[0]));
    body.velocity[i] = pad(Vector3(0.3 * X[1] * 1e6, -0.3 * X[0] * 1e6, 0.1 * X[0] * X[1] * 1e12));
  }
  return body;
}

TEST_CASE("rows in single precision: gradients to 6e-8, sums of a row to 1e-14, even lengths, the same shares of the stabilisation") {
  const auto exact = block<double>();
  const auto single = block<float>();
  const PointTable &a = exact.table(), &b = single.table();
  CHECK(b.entries.empty());
  REQUIRE(b.size() == b.single_entries.size());
  double largest = 0.0, gradient_error = 0.0, sum_error = 0.0, identity_error = 0.0;
  for (std::size_t q = 0; q < a.points(); ++q) {
    const TableRow left = a.row(q), right = b.row(q);
    REQUIRE(right.size() % 2 == 0);
    REQUIRE(right.size() >= left.size());
    REQUIRE(right.size() <= left.size() + 2);
    REQUIRE(b.bonds(q).size() == a.bonds(q).size());
    Vector3 sum = Vector3::Zero();
    Tensor3 moment = Tensor3::Zero();
    for (std::size_t k = 0; k < right.size(); ++k) {
      const TableEntry entry = right[k];
      for (int c = 0; c < 3; ++c) {
        if (k + 1 < left.size()) {
          REQUIRE(entry.particle == left[k].particle);
          gradient_error = std::max(gradient_error, std::abs(entry.gradient[c] - left[k].gradient[c]));
          largest = std::max(largest, std::abs(left[k].gradient[c]));
        }
        sum[c] += entry.gradient[c];
      }
      moment += b.particle_position[entry.particle].head<3>() * Vector3(entry.gradient[0], entry.gradient[1], entry.gradient[2]).transpose();
    }
    sum_error = std::max(sum_error, sum.norm());
    identity_error = std::max(identity_error, (moment - Tensor3::Identity()).norm());
  }
  CHECK(gradient_error <= 6e-8 * largest);
  CHECK(gradient_error > 1e-9 * largest);
  CHECK(sum_error < 1e-13 * largest);
  CHECK(identity_error < 2e-6);
}

TEST_CASE("forces in single precision: those of double to 1e-6, no net force, 16 bytes in the place of 28") {
  auto exact = block<double>();
  auto single = block<float>();
  const BodyTotals e = exact.add_internal_forces(0.0, false), s = single.add_internal_forces(0.0, false);
  CHECK(s.strain_energy == test::relative(e.strain_energy).epsilon(1e-6));
  CHECK(s.stabilization_energy == test::relative(e.stabilization_energy).epsilon(1e-5));
  CHECK(s.dissipated_power == test::relative(e.dissipated_power).epsilon(1e-5));
  const double difference = test::largest_difference(single.force, exact.force), size = test::largest(exact.force);
  Vector4 net = Vector4::Zero();
  for (const Vector4& f : single.force) net += f;
  CHECK(difference < 1e-6 * size);
  CHECK(difference > 1e-12 * size);
  CHECK(net.norm() < 1e-13 * size);
  // A row keeps its sum in the place of its padding, or in two pairs more.
  const std::size_t saved = exact.memory() - single.memory(), rows = exact.table().points();
  CHECK(saved < 12 * exact.table().size());
  CHECK(saved >= 12 * exact.table().size() - 32 * rows);
}

TEST_CASE("a run in single precision: momentum to round-off, energy and motion as in double, the same bits after a restart and on any number of threads") {
  const auto compose = [](auto real) {
    return Simulation{Bodies{block<decltype(real)>()}, Contacts{}, Boundaries{}, CentralDifference{}};
  };
  auto exact = compose(1.0);
  auto single = compose(1.0F);
  const auto momentum = [](auto& simulation) {
    Vector3 p = Vector3::Zero();
    const auto& body = simulation.template body<0>();
    for (std::size_t i = 0; i < body.size(); ++i) p += body.masses()[i] * body.velocity[i].template head<3>();
    return p;
  };
  const Vector3 before = momentum(single);
  exact.run(1_us);
  single.run(1_us);
  const auto& a = exact.body<0>();
  const auto& b = single.body<0>();
  const double scale = test::largest(a.velocity), difference = test::largest_difference(a.displacement, b.displacement);
  double mass = 0.0;
  for (const double m : b.masses()) mass += m;
  CHECK(single.steps() > 20);
  CHECK((momentum(single) - before).norm() < 1e-12 * mass * scale);
  CHECK(difference < 1e-5 * 1_um);
  CHECK(std::abs(single.ledger().error()) < 1.5 * std::abs(exact.ledger().error()) + 1e-6);

  set_thread_count(2);
  auto threads = compose(1.0F);
  threads.run(1_us);
  set_thread_count(1);
  auto first = compose(1.0F), second = compose(1.0F);
  first.run(0.5_us);
  restore_state(second, save_state(first));
  second.run(1_us);
  first.run(1_us);
  for (std::size_t i = 0; i < b.size(); ++i) {
    REQUIRE(threads.body<0>().displacement[i] == b.displacement[i]);
    REQUIRE(second.body<0>().displacement[i] == first.body<0>().displacement[i]);
  }
}

TEST_CASE("the reference of a body in single precision can be updated") {
  auto body = block<float>();
  (void)body.add_internal_forces(0.0, false);
  const double energy = body.add_internal_forces(0.0, false).strain_energy;
  body.update_reference();
  CHECK(body.table().entries.empty());
  std::fill(body.force.begin(), body.force.end(), Vector4::Zero());
  CHECK(body.add_internal_forces(0.0, false).strain_energy == test::relative(energy).epsilon(1e-6));
}

TEST_CASE("coefficients, directors and meridian sections take single precision, too") {
  const auto forces = [](auto body) {
    for (std::size_t i = 0; i < body.size(); ++i) {
      const Vector3 X = body.reference()[i].template head<3>();
      body.displacement[i] = pad(Vector3(0.1 * X[0], 0.0, 0.2 * X[2] - 0.1 * X[0] * X[0] * 1e6));
    }
    (void)body.add_internal_forces(0.0, false);
    return body.force;
  };
  const auto compare = [](const Field& a, const Field& b) {
    const double size = test::largest(a), difference = test::largest_difference(a, b);
    CHECK(difference < 2e-6 * size);
    CHECK(difference > 0.0);
  };
  const Materials rubber{Region{"body", NeoHookean{.mu = 3_kPa, .lambda = 40_kPa}}};
  compare(forces(Body{"gauss", brick(), Rkpm<3>{}, GaussCells<2>{}, rubber}), forces(Body{"gauss", brick(), Rkpm<3>{}, stored_as<float>(GaussCells<2>{}), rubber}));
  const auto section = [] { return meridian(Ball{.radius = 2_um, .core_radius = 0.8_um, .core_cells = 6, .shells = 3}); };
  const Materials two{Region{"nucleus", NeoHookean{.mu = 3_kPa, .lambda = 40_kPa}}, Region{"cytoplasm", NeoHookean{.mu = 1_kPa, .lambda = 9_kPa}}};
  compare(forces(Body{"section", section(), Rkpm<2>{}, NodalCentroids{}, two}), forces(Body{"section", section(), Rkpm<2>{}, stored_as<float>(NodalCentroids{}), two}));
  const auto turning = [](const Point<3>& X) { return Vector3(1.0, 1e6 * X[0], 0.5e6 * X[2]); };
  const Materials gel{Region{"body", NematicGel{}}};
  auto a = Body{"gel", brick(), Rkpm<3>{}, NodalCentroids{}, gel, DirectorField<>{}, turning};
  auto b = Body{"gel", brick(), Rkpm<3>{}, stored_as<float>(NodalCentroids{}), gel, DirectorField<>{}, turning};
  (void)a.add_internal_forces(0.0, false);
  (void)b.add_internal_forces(0.0, false);
  compare(a.director_flux, b.director_flux);
}

}  // namespace

}  // namespace quadrature_stored_test
