// Internal forces of bodies: derivative of their energy, balance, the lanes of the force loop against plain loops,
// threads, regions, grading, masses.
#include <cstring>

#include <doctest/doctest.h>

#include <tactoid/core/random.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/body.hpp>

#include "relative.hpp"

namespace body_test {

using namespace tactoid;

namespace {

Field random_field(std::size_t n, double size, std::uint64_t seed, int components = 3) {
  Random random(seed);
  Field f(n, Vector4::Zero());
  for (Vector4& v : f)
    for (int k = 0; k < components; ++k) v[k] = size * random.uniform(-1.0, 1.0);
  return f;
}

template <class Body>
double stored_energy(Body& body) {
  body.force.assign(body.size(), Vector4::Zero());
  const BodyTotals totals = body.add_internal_forces(0.0, false);
  REQUIRE(body.failed_point() == body.table().points());
  return totals.strain_energy + totals.stabilization_energy;
}

double dot(const Field& a, const Field& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

double norm(const Field& a) {
  return std::sqrt(dot(a, a));
}

/// Forces are −∂(energy)/∂u, have no resultant and no moment; `spacing` in m.
template <class Body>
void check_forces(Body body, double spacing) {
  constexpr int D = Body::dimension;
  for (std::uint64_t seed : {1u, 2u}) {
    body.displacement = random_field(body.size(), 0.08 * spacing, seed, D);
    const Field start = body.displacement;
    (void)stored_energy(body);
    const Field force = body.force;
    CHECK(norm(force) > 0.0);
    for (std::uint64_t direction = 0; direction < 4; ++direction) {
      const Field d = random_field(body.size(), 1.0, 100 * seed + direction, D);
      const double step = 2e-5 * spacing;
      const auto energy_at = [&](double s) {
        for (std::size_t i = 0; i < d.size(); ++i) body.displacement[i] = start[i] + s * d[i];
        return stored_energy(body);
      };
      // Fourth-order difference.
      const double slope =
          (8.0 * (energy_at(step) - energy_at(-step)) - energy_at(2.0 * step) + energy_at(-2.0 * step)) / (12.0 * step);
      CHECK(std::abs(slope + dot(force, d)) < 1e-7 * norm(force) * norm(d));
    }
    Vector3 total = Vector3::Zero(), torque = Vector3::Zero();
    double size = 0.0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      const Vector3 x = (body.table().particle_position[i] + start[i]).template head<3>(),
                    f = force[i].template head<3>();
      total += f;
      torque += Vector3(x[1] * f[2] - x[2] * f[1], x[2] * f[0] - x[0] * f[2], x[0] * f[1] - x[1] * f[0]);
      size += f.norm();
    }
    CHECK(total.norm() < 1e-13 * size);
    CHECK(torque.norm() < 1e-13 * size * 1e-6);  // bodies are about 1 µm large
    for (const Vector4& f : force)
      for (int k = D; k < 4; ++k) CHECK(f[k] == 0.0);
  }
}

PointCloud<3> block() {
  return jitter(box({.size = {1e-6, 1e-6, 1e-6}, .cells = {4, 4, 4}}), 0.15);
}

template <class Law, class Quadrature = NodalCentroids>
auto block_of(Law law, Quadrature rule = {}) {
  return Body{"block", block(), Rkpm<3>{}, rule, Materials{Region{"body", law}}};
}

/// A ball with Yang's solid inside and the gel outside, with a director: everything that the force loop can do.
auto full_ball() {
  const PointCloud<3> cloud = ball({.radius = 0.5e-6, .core_radius = 0.2e-6, .core_cells = 3, .shells = 2});
  NodalCentroids rule;
  rule.points_per_chunk = 16;
  return Body{
      "ball",
      cloud,
      Rkpm<3>{},
      rule,
      Materials{Region{"cytoplasm", NematicGel<>{.viscosity = 0.01, .director_elasticity = 2e-10, .activity = -300.0}},
                Region{"nucleus", YangVisco<>{.elastic = {.density = 1100.0}, .a1 = 3e4, .a2 = 5e3, .a3 = 1e-8}}},
      DirectorField<>{},
      RandomDirector{{.correlation_length = 0.3e-6, .seed = 3}}};
}

using FullBall = decltype(full_ball());

/// The same sums as Body::add_internal_forces, point by point in doubles, straight from the equations.
struct Plain {
  std::vector<YangVisco<>::History<double>> histories;
  Field force, flux;
  std::vector<Tensor3> rate;
  BodyTotals totals;

  void evaluate(const FullBall& body, double time_step) {
    const PointTable& table = body.table();
    histories.resize(table.points());
    force.assign(body.size(), Vector4::Zero());
    flux.assign(body.size(), Vector4::Zero());
    rate.assign(table.points(), Tensor3::Zero());
    totals = {};
    body.for_each_region([&](const auto& region, Index) {
      for (std::size_t q = region.begin; q < region.end; ++q) {
        PointState<double> p;
        p.time_step = time_step;
        p.director = body.director[table.owner[q]].template head<3>();
        for (const TableEntry& e : table.row(q))
          for (int i = 0; i < 3; ++i)
            for (int K = 0; K < 3; ++K) {
              p.deformation_gradient(i, K) += body.displacement[e.particle][i] * e.gradient[K];
              p.deformation_rate(i, K) += body.velocity[e.particle][i] * e.gradient[K];
              p.director_gradient(i, K) += body.director[e.particle][i] * e.gradient[K];
            }
        const Response<double> r = answer(region.law(q), p, q);
        const double V = table.volume[q];
        totals.strain_energy += V * r.energy;
        totals.dissipated_power += V * r.dissipated_power;
        totals.active_power += V * r.active_power;
        for (const TableEntry& e : table.row(q))
          for (int i = 0; i < 3; ++i)
            for (int K = 0; K < 3; ++K) force[e.particle][i] -= V * r.stress(i, K) * e.gradient[K];

        const Tensor3& F = p.deformation_gradient;
        const Tensor3 C_inverse = (F.transpose() * F).inverse();
        const Tensor3 h_flux = V * F.determinant() * p.director_gradient * C_inverse;
        for (const TableEntry& e : table.row(q))
          for (int i = 0; i < 3; ++i)
            for (int K = 0; K < 3; ++K) flux[e.particle][i] -= h_flux(i, K) * e.gradient[K];
        const Tensor3 L = p.deformation_rate * (F - 0.5 * time_step * p.deformation_rate).inverse();
        rate[q] = 0.5 * (L - L.transpose());

        // Stabilisation: pair forces κ w (r + τ ṙ) on J, and their reaction through the owner and through F.
        const double kappa = region.stabilization.modulus * table.stabilization_scale[q],
                     tau = region.stabilization.damping_time;
        const Index I = table.owner[q];
        const auto weights = table.bonds(q);
        for (std::size_t k = 0; k < weights.size(); ++k) {
          const TableEntry& e = table.row(q)[k];
          const Vector3 dX = (table.particle_position[e.particle] - table.particle_position[I]).head<3>();
          const Vector3 du = (body.displacement[e.particle] - body.displacement[I]).head<3>();
          const Vector3 dv = (body.velocity[e.particle] - body.velocity[I]).head<3>();
          const Vector3 residual = du - (F - Tensor3::Identity()) * dX, rate_of = dv - p.deformation_rate * dX;
          const double w = kappa * static_cast<double>(weights[k]);
          totals.stabilization_energy += 0.5 * w * residual.squaredNorm();
          totals.dissipated_power += tau * w * rate_of.squaredNorm();
          const Vector3 g = w * (residual + tau * rate_of);
          force[e.particle].head<3>() -= g;
          force[I].head<3>() += g;
          for (const TableEntry& m : table.row(q))
            for (int K = 0; K < 3; ++K) force[m.particle].head<3>() += g * (dX[K] * m.gradient[K]);
        }
      }
    });
  }

  Response<double> answer(const YangVisco<>& law, const PointState<double>& p, std::size_t q) {
    return law.response(p, histories[q]);
  }
  Response<double> answer(const NematicGel<>& law, const PointState<double>& p, std::size_t) {
    NoHistory<double> none;
    return law.response(p, none);
  }
};

double distance(const Field& a, const Field& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum);
}

bool same_bits(const Field& a, const Field& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vector4)) == 0;
}

}  // namespace

TEST_CASE("Internal forces are the derivative of the energy: ModifiedMooneyRivlin") {
  check_forces(block_of(ModifiedMooneyRivlin{.initial_pressure = 30.0}), 0.25e-6);
  check_forces(block_of(ModifiedMooneyRivlin{}, NodalCentroids{.solid_ratio = 20.0}), 0.25e-6);  // mostly stabilisation
}

TEST_CASE("Internal forces are the derivative of the energy: NeoHookean on Gauss cells") {
  check_forces(block_of(NeoHookean{}, GaussCells<2>{}), 0.25e-6);
}

TEST_CASE("Internal forces are the derivative of the energy: Yang's solid without its branch, 2D") {
  const PointCloud<2> cloud = jitter(rectangle({.size = {1e-6, 1e-6}, .cells = {6, 5}}), 0.2);
  check_forces(
      Body{"plate", cloud, Rkpm<2>{}, NodalCentroids{}, Materials{Region{"body", YangVisco<>{.a1 = 0.0, .a2 = 0.0}}}},
      0.2e-6);
}

TEST_CASE("Internal forces are the derivative of the energy: a gel at rest with the director frozen") {
  const PointCloud<3> cloud = block();
  // Without activity and director elasticity the gel's stress has an energy.
  const NematicGel<> gel{.bulk_modulus = 2e4, .director_elasticity = 0.0, .activity = 0.0};
  check_forces(Body{"gel", cloud, Rkpm<3>{}, NodalCentroids{}, Materials{Region{"body", gel}}, DirectorField<>{},
                    UniformDirector{Vector3(1.0, 2.0, 0.5)}},
               0.25e-6);
}

TEST_CASE("The force loop in lanes agrees with plain loops in doubles; histories, director and rates included") {
  FullBall body = full_ball();
  Plain plain;
  const double time_step = 2e-9;
  for (std::uint64_t step = 1; step <= 3; ++step) {
    body.displacement = random_field(body.size(), 4e-9, step);
    body.velocity = random_field(body.size(), 1.0, 10 + step);
    body.force.assign(body.size(), Vector4::Zero());
    const BodyTotals totals = body.add_internal_forces(time_step, true);
    body.accept_histories();
    REQUIRE(body.failed_point() == body.table().points());
    plain.evaluate(body, time_step);
    CHECK(distance(body.force, plain.force) < 1e-12 * norm(plain.force));
    CHECK(distance(body.director_flux, plain.flux) < 1e-12 * norm(plain.flux));
    CHECK(totals.strain_energy == test::relative(plain.totals.strain_energy).epsilon(1e-11));
    CHECK(totals.stabilization_energy == test::relative(plain.totals.stabilization_energy).epsilon(1e-11));
    CHECK(totals.dissipated_power == test::relative(plain.totals.dissipated_power).epsilon(1e-11));
    CHECK(totals.active_power == test::relative(plain.totals.active_power).epsilon(1e-11));
    // The operator of the director at a particle: the mean over its points.
    for (std::size_t i = 0; i < body.size(); ++i) {
      Tensor3 mean = Tensor3::Zero();
      double volume = 0.0;
      for (std::size_t q = 0; q < body.table().points(); ++q)
        if (body.table().owner[q] == i)
          mean += body.table().volume[q] * plain.rate[q], volume += body.table().volume[q];
      CHECK((body.director_rate(i).first - mean / volume).norm() < 1e-9 * (mean / volume).norm());
    }
  }
  // A view of the stress advances nothing, and is the committed state's.
  const auto samples = body.sample_points(), again = body.sample_points();
  for (std::size_t q = 0; q < samples.size(); ++q) CHECK((samples[q].cauchy - again[q].cauchy).norm() == 0.0);
}

TEST_CASE("A step that is not accepted leaves the histories as they were") {
  auto body = block_of(YangVisco<>{});
  body.displacement = random_field(body.size(), 1e-8, 3);
  const auto stress = [&] {
    Tensor3 sum = Tensor3::Zero();
    for (const PointSample& sample : body.sample_points()) sum += sample.cauchy;
    return sum;
  };
  const Tensor3 before = stress();
  body.add_internal_forces(1e-6, true);
  CHECK(stress() == before);
  body.accept_histories();
  CHECK((stress() - before).norm() > 1e-3 * before.norm());
}

TEST_CASE("The same bits for 1, 2 and 4 threads") {
  const FullBall start = full_ball();
  CHECK(start.table().chunks.size() > 8);
  const int threads_before = thread_count();
  Field force, flux;
  for (int threads : {1, 2, 4}) {
    set_thread_count(threads);
    FullBall body = start;
    body.displacement = random_field(body.size(), 4e-9, 5);
    body.velocity = random_field(body.size(), 1.0, 6);
    body.add_internal_forces(1e-9, true);
    body.accept_histories();
    const BodyTotals totals = body.add_internal_forces(1e-9, true);
    if (threads == 1) force = body.force, flux = body.director_flux;
    CHECK(same_bits(body.force, force));
    CHECK(same_bits(body.director_flux, flux));
    CHECK(std::isfinite(totals.strain_energy));
  }
  set_thread_count(threads_before);
}

TEST_CASE("A graded law that is constant is the uniform law; one that varies is evaluated where the point is") {
  const ModifiedMooneyRivlin law{};
  auto uniform = block_of(law);
  auto graded = block_of(Graded{[law](const Vector3&) { return law; }});
  uniform.displacement = graded.displacement = random_field(uniform.size(), 1e-8, 9);
  uniform.velocity = graded.velocity = random_field(uniform.size(), 1.0, 10);
  uniform.add_internal_forces(1e-9, true);
  graded.add_internal_forces(1e-9, true);
  CHECK(distance(uniform.force, graded.force) < 1e-13 * norm(uniform.force));

  // Under one affine deformation the energy is the integral of the stiffness factor: 1 + x/L has the mean 1.5.
  auto slope = block_of(Graded{[law](const Vector3& X) { return law.scaled(1.0 + X[0] / 1e-6); }});
  const auto stretch = [](auto& body) {
    for (std::size_t i = 0; i < body.size(); ++i) body.displacement[i] = 0.1 * body.table().particle_position[i];
    return body.add_internal_forces(0.0, false).strain_energy;
  };
  CHECK(stretch(slope) == test::relative(1.5 * stretch(uniform)).epsilon(1e-9));

  // So is the stabilisation: three times as strong where the law is three times as stiff.
  auto step = block_of(Graded{[law](const Vector3& X) { return law.scaled(X[0] < 0.3e-6 ? 1.0 : 3.0); }});
  const auto shaken_at_the_end = [](auto& body) {
    body.displacement = random_field(body.size(), 1e-8, 11);
    for (std::size_t i = 0; i < body.size(); ++i)
      if (body.table().particle_position[i][0] < 0.8e-6) body.displacement[i].setZero();
    return body.add_internal_forces(0.0, false);
  };
  const BodyTotals weak = shaken_at_the_end(uniform), strong = shaken_at_the_end(step);
  CHECK(weak.stabilization_energy > 0.0);
  CHECK(strong.stabilization_energy == test::relative(3.0 * weak.stabilization_energy).epsilon(1e-12));
  CHECK(strong.strain_energy == test::relative(3.0 * weak.strain_energy).epsilon(1e-12));
}

TEST_CASE("Masses and volumes of regions") {
  const FullBall body = full_ball();
  double mass = 0.0, expected = 0.0, sum = 0.0;
  for (double m : body.masses()) mass += m;
  for (double v : body.nodal_volumes()) sum += v;
  for (const auto& point : gauss_points<2>(body.cloud()))
    expected += point.weight * (body.cloud().regions[point.region] == "nucleus" ? 1100.0 : 1000.0);
  CHECK(mass == test::relative(expected).epsilon(1e-12));
  CHECK(sum == test::relative(volume(body.cloud())).epsilon(1e-12));
  double gauss_mass = 0.0;
  const auto gauss = block_of(NeoHookean{}, GaussCells<2>{});
  for (double m : gauss.masses()) gauss_mass += m;
  CHECK(gauss_mass == test::relative(NeoHookean{}.density * 1e-18).epsilon(1e-12));
}

TEST_CASE("Lumped masses keep the centre of mass of a block whose particles are out of order") {
  const auto body = block_of(NeoHookean{});
  Vector3 moment = Vector3::Zero(), exact = Vector3::Zero();
  for (std::size_t i = 0; i < body.size(); ++i) {
    CHECK(body.masses()[i] > 0.5 * NeoHookean{}.density * body.nodal_volumes()[i]);
    moment += body.masses()[i] * body.table().particle_position[i].template head<3>();
  }
  for (const auto& point : gauss_points<2>(body.cloud())) exact += NeoHookean{}.density * point.weight * point.position;
  CHECK((moment - exact).norm() < 1e-12 * exact.norm());
}

TEST_CASE("A gel in the plane whose director leaves the plane feels no force out of it") {
  const PointCloud<2> cloud = jitter(rectangle({.size = {1e-6, 1e-6}, .cells = {6, 5}}), 0.2);
  Body body{"film",
            cloud,
            Rkpm<2>{},
            NodalCentroids{},
            Materials{Region{"body", NematicGel<>{.activity = -1e4}}},
            DirectorField<>{},
            RandomDirector{{.correlation_length = 0.3e-6}}};
  body.add_internal_forces(0.0, false);
  double in_plane = 0.0, out_of_plane = 0.0;
  for (const Vector4& f : body.force) in_plane += f.head<2>().norm(), out_of_plane += std::abs(f[2]);
  CHECK(in_plane > 0.0);
  CHECK(out_of_plane == 0.0);
}

TEST_CASE("Inverted and undefined states are reported by their first point") {
  auto body = block_of(ModifiedMooneyRivlin{});
  CHECK(body.failed_point() == body.table().points());
  for (std::size_t i = 0; i < body.size(); ++i) body.displacement[i][0] = -1.5 * body.table().particle_position[i][0];
  body.add_internal_forces(0.0, false);
  CHECK(body.failed_point() == 0);
  for (Vector4& u : body.displacement) u.setZero();
  body.displacement[7][0] = std::numeric_limits<double>::quiet_NaN();
  body.add_internal_forces(0.0, false);
  CHECK(body.failed_point() < body.table().points());
  body.displacement[7][0] = 0.0;
  body.add_internal_forces(0.0, false);
  CHECK(body.failed_point() == body.table().points());
}

TEST_CASE("Bodies reject what does not fit") {
  using M = ModifiedMooneyRivlin;
  const auto make = [](auto materials) { Body body{"b", block(), Rkpm<3>{}, NodalCentroids{}, std::move(materials)}; };
  CHECK_THROWS_WITH_AS(
      make(Materials{Region{"nucleus", M{}}}),
      "Body \"b\": region \"body\" of the cloud has no material; materials are given for: \"nucleus\".",
      ParameterError);
  CHECK_THROWS_WITH_AS(make(Materials{Region{"body", M{}}, Region{"shell", M{}}}),
                       doctest::Contains("2 materials are given for 1 regions"), ParameterError);
  CHECK_THROWS_WITH_AS(make(Materials{Region{"body", M{.density = -1.0}}}),
                       doctest::Contains("ModifiedMooneyRivlin.density = -1 kg/m^3"), ParameterError);
}

}  // namespace body_test
