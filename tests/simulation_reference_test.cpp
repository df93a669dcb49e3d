// The force loop, which works on registers, lanes and chunks, against the equations written down plainly: one point and one pair
// after the other, in doubles.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include <tactoid/geometry/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/body.hpp>

namespace simulation_reference_test {

using namespace tactoid;

namespace {

struct Forces {
  Field force, director_flux;
  BodyTotals totals;
};

template <class Body>
Forces plain(const Body& body, double time_step) {
  const PointTable& table = body.table();
  Forces result{Field(body.size(), Vector4::Zero()), Field(body.size(), Vector4::Zero()), {}};
  const auto gradient = [&](const Field& f, std::size_t q) {
    Tensor3 sum = Tensor3::Zero();
    for (const TableEntry& e : table.row(q)) sum += f[e.particle].template head<3>() * Vector3(e.gradient[0], e.gradient[1], e.gradient[2]).transpose();
    return sum;
  };
  const auto distribute = [&](Field& f, const Tensor3& flux, std::size_t q) {
    for (const TableEntry& e : table.row(q)) f[e.particle] -= pad(Vector3(flux * Vector3(e.gradient[0], e.gradient[1], e.gradient[2])));
  };
  body.for_each_region([&](const auto& region, Index) {
    using Law = typename std::decay_t<decltype(region)>::Law;
    for (std::size_t q = region.begin; q < region.end; ++q) {
      const Tensor3 H = gradient(body.displacement, q), rate = gradient(body.velocity, q);
      PointState<double> state;
      state.deformation_gradient += H;
      state.deformation_rate = rate;
      state.time_step = time_step;
      if constexpr (Body::has_director) {
        state.director = body.director[table.owner[q]].template head<3>();
        state.director_gradient = gradient(body.director, q);
      }
      HistoryOf<Law, double> history{};
      const auto response = respond(region.law(q), state, history);
      const double V = table.volume[q];
      result.totals.strain_energy += V * response.energy;
      result.totals.dissipated_power += V * response.dissipated_power;
      result.totals.active_power += V * response.active_power;
      Tensor3 P = response.stress;
      for (int i = 0; i < 3; ++i)
        for (int K = 0; K < 3; ++K)
          if (i >= Body::dimension || K >= Body::dimension) P(i, K) = 0.0;
      distribute(result.force, V * P, q);
      if constexpr (Body::has_director) {
        const Tensor3 F_inverse = state.deformation_gradient.inverse();
        distribute(result.director_flux, V * state.deformation_gradient.determinant() * state.director_gradient * F_inverse * F_inverse.transpose(), q);
      }
      if (table.stabilization_scale.empty()) continue;
      const double kappa = region.stabilization.modulus * table.stabilization_scale[q], tau = region.stabilization.damping_time;
      const Index I = table.owner[q];
      const auto weights = table.bonds(q);
      for (std::size_t k = 0; k < weights.size(); ++k) {
        const Index J = table.row(q)[k].particle;
        Vector3 dX = (table.particle_position[J] - table.particle_position[I]).template head<3>();
        for (int a = 0; a < 3; ++a)
          if (table.period[a] > 0.0) dX[a] -= table.period[a] * std::round(dX[a] / table.period[a]);
        const Vector3 r = (body.displacement[J] - body.displacement[I]).template head<3>() - H * dX;
        const Vector3 s = (body.velocity[J] - body.velocity[I]).template head<3>() - rate * dX;
        const double w = kappa * static_cast<double>(weights[k]);
        const Vector3 force = w * (r + tau * s);
        result.force[J] -= pad(force);
        result.force[I] += pad(force);
        distribute(result.force, -force * dX.transpose(), q);
        result.totals.stabilization_energy += 0.5 * w * r.squaredNorm();
        result.totals.dissipated_power += tau * w * s.squaredNorm();
      }
    }
  });
  return result;
}

/// Moves and turns everything at random, and compares one evaluation.
template <class Body>
void compare(Body body) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  constexpr int D = Body::dimension;
  for (std::size_t i = 0; i < body.size(); ++i)
    for (int a = 0; a < D; ++a) {
      body.displacement[i][a] = 0.03e-6 * uniform(random);
      body.velocity[i][a] = 0.5 * uniform(random);
    }
  if constexpr (Body::has_director)
    for (Vector4& h : body.director) h.head<3>() += 0.3 * Vector3(uniform(random), uniform(random), uniform(random));
  const Forces expected = plain(body, 1e-9);
  const BodyTotals totals = body.add_internal_forces(1e-9, false);
  REQUIRE(body.failed_point() == body.table().points());

  const auto difference = [](const Field& a, const Field& b) {
    double largest = 0.0, scale = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      largest = std::max(largest, (a[i] - b[i]).norm());
      scale = std::max(scale, b[i].norm());
    }
    REQUIRE(scale > 0.0);
    return largest / scale;
  };
  CHECK(difference(body.force, expected.force) < 1e-12);
  if constexpr (Body::has_director) CHECK(difference(body.director_flux, expected.director_flux) < 1e-12);
  CHECK(std::abs(totals.strain_energy - expected.totals.strain_energy) <= 1e-12 * std::abs(expected.totals.strain_energy));
  CHECK(std::abs(totals.stabilization_energy - expected.totals.stabilization_energy) <= 1e-12 * std::abs(expected.totals.stabilization_energy));
  CHECK(std::abs(totals.dissipated_power - expected.totals.dissipated_power) <= 1e-12 * std::abs(expected.totals.dissipated_power));
  CHECK(std::abs(totals.active_power - expected.totals.active_power) <= 1e-12 * std::abs(expected.totals.active_power));
}

}  // namespace

TEST_CASE("Forces, fluxes and energies are those of the equations: a ball of two materials with a director") {
  compare(Body{"cell", ball({.radius = 1e-6, .core_radius = 0.5e-6, .core_cells = 4}), Rkpm<3>{}, NodalCentroids{},
               Materials{Region{"nucleus", NeoHookean::from_young(1e5, 0.3)}, Region{"cytoplasm", NematicGel<>{}}}, DirectorField<>{},
               [](const Vector3&) { return Vector3(0.0, 0.6, 0.8); }});
}

TEST_CASE("The same in a periodic block, with and without damping and stabilisation") {
  const auto cloud = box(Box{.size = {1e-6, 1.1e-6, 1.2e-6}, .cells = {9, 9, 9}, .periodic = {true, false, true}});
  const Materials laws{Region{"body", NeoHookean::from_young(1e5, 0.3)}};
  for (const double time : {0.0, 2e-9}) compare(Body{"block", cloud, Rkpm<3>{}, NodalCentroids{.solid_damping_time = time}, laws});
  compare(Body{"block", cloud, Rkpm<3>{}, NodalCentroids{.solid_ratio = 0.0}, laws});
}

TEST_CASE("The same with the gradients that are stored in single precision") {
  const Materials laws{Region{"body", NeoHookean::from_young(1e5, 0.3)}};
  const auto cloud = box(Box{.size = {1e-6, 1.1e-6, 1.2e-6}, .cells = {6, 7, 8}});
  for (const double ratio : {0.0, 0.1})
    for (const double time : {0.0, 2e-9})
      compare(Body{"block", cloud, Rkpm<3>{}, stored_as<float>(NodalCentroids{.solid_ratio = ratio, .solid_damping_time = time}), laws});
  compare(Body{"gel", ball({.radius = 1e-6, .core_radius = 0.5e-6, .core_cells = 4}), Rkpm<3>{}, stored_as<float>(NodalCentroids{}),
               Materials{Region{"nucleus", NematicGel<>{}}, Region{"cytoplasm", NematicGel<>{}}}, DirectorField<>{},
               [](const Vector3&) { return Vector3(0.0, 0.6, 0.8); }});
}

TEST_CASE("The same in the plane, with a law that remembers") {
  compare(Body{"sheet", rectangle({.size = {1e-6, 1.1e-6}, .cells = {13, 11}}), Rkpm<2>{}, NodalCentroids{}, Materials{Region{"body", YangVisco<>{}}}});
}

}  // namespace simulation_reference_test
