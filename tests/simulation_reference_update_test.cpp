// Updates of the reference: what is carried over to the bit and what is not, forces and tangents afterwards, solids that do not
// notice, a fluid that flows further than its first neighbours allow, restarts, and what is refused.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactoid/boundary/all.hpp>
#include <tactoid/contact/all.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/director/all.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/observe/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/all.hpp>

#include "fields.hpp"
#include "relative.hpp"

namespace simulation_reference_update_test {

using namespace tactoid;
using tactoid::test::relative;

namespace {

constexpr double um = 1e-6;

/// A compressible Newtonian fluid: energy K/2 (ln J)², and 2 μ d.
struct Newtonian {
  static constexpr bool uses_rate = true;
  double density = 1000.0;
  double viscosity = 1.0;
  double bulk_modulus = 200.0;
  [[nodiscard]] double wave_speed() const { return std::sqrt(bulk_modulus / density); }
  [[nodiscard]] double viscosity_modulus() const { return 2.0 * viscosity; }
  template <class T>
  [[nodiscard]] Response<T> response(const PointState<T>& point, NoHistory<T>&) const {
    using std::log;
    const Inversion<T> F = invert(point.deformation_gradient);
    const Tensor<T> d = rate_of_deformation(velocity_gradient(point.deformation_rate, F.inverse));
    const T strain = log(F.determinant);
    Response<T> r;
    r.energy = T(0.5 * bulk_modulus) * strain * strain;
    r.dissipated_power = T(2.0 * viscosity) * F.determinant * contract(d, d);
    Tensor<T> sigma = d * T(2.0 * viscosity);
    for (int i = 0; i < 3; ++i) sigma(i, i) += T(bulk_modulus) * strain / F.determinant;
    r.stress = piola_from_cauchy(sigma, point.deformation_gradient);
    return r;
  }
};
static_assert(Material<Newtonian>);

auto solid_and_fluid(double fluid_modulus = 50.0) {
  return Body{"block", jitter(box({.size = {2.0 * um, 2.0 * um, 2.0 * um}, .cells = {4, 4, 4}}), 0.15), Rkpm<3>{}, NodalCentroids{.fluid_modulus = fluid_modulus},
              Materials{Region{"body", ModifiedMooneyRivlin{}}}};
}
/// A ball in a shell with a director, in 3D or in its meridian section.
template <int D, class Law>
auto cell(const Law& law) {
  PointCloud<D> cloud;
  if constexpr (D == 3) cloud = ball({.radius = 2.0 * um, .core_radius = 0.8 * um, .core_cells = 2, .shells = 2});
  else cloud = meridian(Ball{.radius = 2.0 * um, .core_radius = 0.8 * um, .core_cells = 4, .shells = 3});
  return Body{"cell", std::move(cloud), Rkpm<D>{}, NodalCentroids{.fluid_modulus = 50.0},
              Materials{Region{"nucleus", ModifiedMooneyRivlin{}}, Region{"cytoplasm", law}},
              DirectorField<>{}, RandomDirector({.seed = 2})};
}

/// Moves particles by a smooth field that is not affine, of a size relative to the body.
template <class AnyBody>
void bend(AnyBody& body, double size) {
  const auto& X = body.reference();
  double length = 0.0;
  for (const Vector4& x : X) length = std::max(length, x.norm());
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector3 x = X[i].template head<3>() / length;
    Vector3 u(x[0] * (0.8 + 0.3 * x[1]), -0.4 * x[1] + 0.3 * x[0] * x[0], -0.4 * x[2] + 0.2 * std::sin(2.0 * x[0]) * x[1]);
    if (body.table().axisymmetric) u = Vector3(x[0] * (0.5 + 0.2 * x[1]), -0.4 * x[1] + 0.2 * x[0] * x[0], 0.0);
    if (body.dimension < 3) u[2] = 0.0;
    body.displacement[i] = pad(Vector3(size * length * u));
  }
}

template <class AnyBody>
BodyTotals evaluate(AnyBody& body) {
  body.force.assign(body.size(), Vector4::Zero());
  return body.add_internal_forces(0.0, false);
}

/// Largest difference of two fields over the largest vector of the first.
double difference(const Field& a, const Field& b) {
  return test::largest_difference(a, b) / test::largest(a);
}

/// Σ V J of a body.
template <class AnyBody>
double volume(AnyBody& body, const std::vector<PointSample>& samples) {
  double sum = 0.0;
  for (std::size_t q = 0; q < samples.size(); ++q) sum += body.point_volume(q) * samples[q].J;
  return sum;
}

template <int D>
void check_carried_over() {
  // Solids keep everything.
  auto body = cell<D>(NeoHookean{.mu = 400.0, .lambda = 4000.0});
  bend(body, 0.3);
  const BodyTotals before = evaluate(body);
  const auto samples = body.sample_points();
  const Field force = body.force, displacement = body.displacement;
  const auto masses = body.masses();
  REQUIRE(body.distortion() > 1.2);
  body.update_reference();
  const BodyTotals after = evaluate(body);
  CHECK(body.distortion() == relative(1.0).epsilon(1e-7));
  CHECK(body.displacement == displacement);
  CHECK(body.masses() == masses);
  CHECK(after.strain_energy == relative(before.strain_energy).epsilon(1e-12));
  CHECK(after.stabilization_energy < 1e-18 * before.strain_energy);
  CHECK(before.stabilization_energy > 1e-6 * before.strain_energy);
  double stress = 0.0, change = 0.0;
  const auto again = body.sample_points();
  for (std::size_t q = 0; q < samples.size(); ++q) {
    stress = std::max(stress, samples[q].cauchy.norm());
    change = std::max(change, (samples[q].cauchy - again[q].cauchy).norm());
    CHECK(again[q].J == relative(samples[q].J).epsilon(1e-12));
  }
  CHECK(change < 1e-11 * stress);
  CHECK(difference(force, body.force) > 1e-6);  // of other gradients

  // The volume ratio of a fluid is smoothed: its sum is kept, and energy of compression is lost, not gained.
  auto gel = cell<D>(NematicGel<>{.viscosity = 0.01, .bulk_modulus = 1e5, .director_elasticity = 1e-11, .activity = -500.0});
  bend(gel, 0.3);
  const BodyTotals rough = evaluate(gel);
  const double kept = volume(gel, gel.sample_points());
  gel.update_reference();
  CHECK(volume(gel, gel.sample_points()) == relative(kept).epsilon(1e-12));
  CHECK(evaluate(gel).strain_energy < rough.strain_energy);
  // After a second update, in another state: action and reaction.
  bend(gel, 0.4);
  evaluate(gel);
  gel.update_reference();
  bend(gel, 0.45);
  evaluate(gel);
  double total = 0.0;
  Vector4 sum = Vector4::Zero();
  for (const Vector4& f : gel.force) sum += f, total += f.norm();
  if constexpr (D == 3) CHECK(sum.norm() < 1e-12 * total);
  CHECK(std::abs(sum[D - 1]) < 1e-12 * total);
}

/// The forces of an elastic body after two updates are the derivative of its energy, and its stiffness that of the forces.
template <class AnyBody>
void check_derivatives(AnyBody body) {
  constexpr int D = AnyBody::dimension;
  bend(body, 0.2);
  evaluate(body);
  body.update_reference();
  bend(body, 0.35);
  evaluate(body);
  body.update_reference();
  bend(body, 0.45);
  const Field start = body.displacement;
  evaluate(body);
  const Field force = body.force;
  const StiffnessMatrix K = assemble_stiffness(body);
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double length = 0.0;
  for (const Vector4& X : body.reference()) length = std::max(length, X.norm());
  Eigen::VectorXd direction(static_cast<Eigen::Index>(D * body.size()));
  for (Eigen::Index k = 0; k < direction.size(); ++k) direction[k] = uniform(engine);
  const double step = 1e-5 * length;
  double energy[2] = {};
  Field forces[2];
  for (int side = 0; side < 2; ++side) {
    for (std::size_t i = 0; i < body.size(); ++i)
      body.displacement[i].template head<D>() = start[i].template head<D>() + (side == 0 ? step : -step) * direction.segment<D>(static_cast<Eigen::Index>(D * i));
    const BodyTotals totals = evaluate(body);
    energy[side] = totals.strain_energy + totals.stabilization_energy;
    forces[side] = body.force;
  }
  double power = 0.0, worst = 0.0, size = 0.0;
  const Eigen::VectorXd product = K * direction;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const auto along = direction.segment<D>(static_cast<Eigen::Index>(D * i));
    power += force[i].template head<D>().dot(along);
    const Eigen::Matrix<double, D, 1> slope = (forces[1][i] - forces[0][i]).template head<D>() / (2.0 * step);
    worst = std::max(worst, (slope - product.segment<D>(static_cast<Eigen::Index>(D * i))).norm());
    size = std::max(size, slope.norm());
  }
  CHECK((energy[1] - energy[0]) / (2.0 * step) == relative(power).epsilon(1e-6));
  CHECK(worst < 1e-6 * size);
}

}  // namespace

TEST_CASE("An update of the reference carries stress, energy, mass and motion over; the stabilisation starts anew: 3D") { check_carried_over<3>(); }
TEST_CASE("An update of the reference carries stress, energy, mass and motion over; the stabilisation starts anew: a meridian section") {
  check_carried_over<2>();
}

TEST_CASE("Forces and stiffness after updates are derivatives") {
  check_derivatives(solid_and_fluid());
  check_derivatives(Body{"ball", meridian(Ball{.radius = 2.0 * um, .core_radius = 0.8 * um, .core_cells = 4, .shells = 3}), Rkpm<2>{}, NodalCentroids{},
                         Materials{Region{"nucleus", ModifiedMooneyRivlin{}}, Region{"cytoplasm", NeoHookean{.mu = 400.0, .lambda = 4000.0}}}});
  check_derivatives(Body{"plate", jitter(rectangle({.size = {2.0 * um, 2.0 * um}, .cells = {5, 5}}), 0.1), Rkpm<2>{}, NodalCentroids{},
                         Materials{Region{"body", Graded{[](const Vector3& X) { return NeoHookean{.mu = 400.0 * (1.0 + 1e6 * X[0]), .lambda = 4000.0}; }}}}});
}

TEST_CASE("The patch test holds on an updated reference: affine on affine") {
  auto body = solid_and_fluid();
  Tensor3 first, second;
  first << 1.5, 0.4, 0.0, 0.1, 0.8, 0.2, 0.0, -0.3, 0.9;
  second << 0.9, -0.2, 0.3, 0.0, 1.3, 0.1, 0.2, 0.0, 1.1;
  const auto deform = [&](const Tensor3& F) {
    for (std::size_t i = 0; i < body.size(); ++i) body.displacement[i] = pad(Vector3((F - Tensor3::Identity()) * body.reference()[i].head<3>()));
    return evaluate(body);
  };
  deform(first);
  body.update_reference();
  const BodyTotals totals = deform(second * first);
  const Tensor3 P = ModifiedMooneyRivlin{}.first_piola(Tensor3(second * first));
  const double volume = 8.0 * um * um * um, J = determinant(Tensor3(second * first));
  CHECK(totals.strain_energy == relative(volume * ModifiedMooneyRivlin{}.energy(Tensor3(second * first))).epsilon(1e-11));
  CHECK(totals.stabilization_energy < 1e-20 * totals.strain_energy);
  for (const PointSample& sample : body.sample_points()) {
    CHECK((sample.cauchy - cauchy_from_piola(P, Tensor3(second * first))).norm() < 1e-10 * sample.cauchy.norm());
    CHECK(sample.J == relative(J).epsilon(1e-12));
  }
  double inside = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector3 X = body.reference()[i].head<3>();
    const bool surface = X.minCoeff() < 1e-9 || X.maxCoeff() > 2.0 * um - 1e-9;
    (surface ? largest : inside) = std::max(surface ? largest : inside, body.force[i].norm());
  }
  CHECK(inside < 1e-10 * largest);
}

TEST_CASE("What updates of a solid take is the energy of its stabilisation, and it is booked; momentum is kept") {
  // A free block that is stretched and let go, updated whenever lengths have changed by a tenth, or never.
  const auto compose = [](double distortion) {
    Body block{"block", jitter(box({.size = {4.0 * um, 2.0 * um, 2.0 * um}, .cells = {6, 3, 3}}), 0.1), Rkpm<3>{}, NodalCentroids{.solid_damping_time = 0.0},
               Materials{Region{"body", NeoHookean{.mu = 1000.0, .lambda = 2000.0}}}};
    for (std::size_t i = 0; i < block.size(); ++i) {
      const Vector3 X = block.reference()[i].head<3>();
      block.displacement[i] = pad(Vector3(0.2 * X[0], -0.05 * X[1], -0.05 * X[2]));
      block.velocity[i] = Vector4(0.0, 0.02, 0.01, 0.0);
    }
    return Simulation{Bodies{std::move(block)}, Contacts{}, Boundaries{}, UpdatedReference{CentralDifference{.safety = 0.2}, distortion, 2}};
  };
  auto updated = compose(1.1), plain = compose(1e9);
  const auto momentum = [](auto& s) { return motion(s.template particles<0>()).momentum; };
  const auto p0 = momentum(plain);
  updated.run(6e-6);
  plain.run(6e-6);
  const ReferenceReport& report = updated.integrator().reference;
  REQUIRE(report.updates >= 5);
  CHECK(plain.integrator().reference.updates == 0);
  CHECK((momentum(updated) - p0).norm() < 1e-12 * p0.norm());
  CHECK(report.lost_energy > 1e-3 * updated.ledger().initial);
  CHECK(report.lost_energy < 0.3 * updated.ledger().initial);
  CHECK(updated.ledger().reference_updates == relative(report.lost_energy).epsilon(1e-12));
  CHECK(updated.ledger().error() < 2.0 * plain.ledger().error());
  CHECK(updated.ledger().error() < 5e-3);
}

namespace {

constexpr double inner = 0.5 * um, outer = 1.0 * um;

/// Rings of particles between two circles.
PointCloud<2> annulus(int rings, int around) {
  PointCloud<2> cloud;
  const auto number = [&](int ring, int k) { return static_cast<Index>(ring * around + k % around); };
  for (int ring = 0; ring <= rings; ++ring)
    for (int k = 0; k < around; ++k) {
      const double r = inner + (outer - inner) * ring / rings, angle = 2.0 * std::numbers::pi * k / around;
      cloud.positions.emplace_back(r * std::cos(angle), r * std::sin(angle));
    }
  for (int ring = 0; ring < rings; ++ring)
    for (int k = 0; k < around; ++k) cloud.cells.push_back({number(ring, k), number(ring + 1, k), number(ring, k + 1), number(ring + 1, k + 1)});
  cloud.cell_regions.assign(cloud.cells.size(), 0);
  for (int k = 0; k < around; ++k) {
    cloud.facets.push_back({number(rings, k), number(rings, k + 1)});
    cloud.facets.push_back({number(0, k + 1), number(0, k)});
  }
  return cloud;
}

/// Torque per turn of a cylinder that turns in a viscous fluid, over Couette's 4πμΩ/(1/a² − 1/b²): after each tenth of a turn.
std::vector<double> torques(double distortion, double turns, ReferenceReport& report) {
  const Newtonian law;
  Body fluid{"fluid", annulus(6, 48), Rkpm<2>{}, NodalCentroids{.fluid_modulus = 1.0, .fluid_viscosity = 0.1 * law.viscosity}, Materials{Region{"body", law}}};
  const auto hub = select(fluid.cloud(), [](const Point<2>& X) { return X.norm() < 1.001 * inner; });
  const auto rim = select(fluid.cloud(), [](const Point<2>& X) { return X.norm() > 0.999 * outer; });
  const double omega = 1.0, turn = 2.0 * std::numbers::pi / omega;
  const auto turning = [=](const Vector3& X, double t) {
    const double c = std::cos(omega * t) - 1.0, s = std::sin(omega * t);
    return Vector3(c * X[0] - s * X[1], s * X[0] + c * X[1], 0.0);
  };
  Simulation simulation{Bodies{std::move(fluid)}, Contacts{}, Boundaries{on<0>(PrescribedMotion{hub, turning, {true, true, false}}), on<0>(fixed(rim))},
                        UpdatedReference{ImplicitDynamics{.inertia = false, .time_step = turn / 200.0}, distortion, 1}};
  const double exact = 4.0 * std::numbers::pi * law.viscosity * omega * omega / (1.0 / (inner * inner) - 1.0 / (outer * outer));
  std::vector<double> list;
  double work = 0.0;
  try {
    simulation.run(turns * turn, every(0.1 * turn, [&](auto& s) {
                     if (s.time() > 0.0) list.push_back((s.ledger().external_work - work) / (0.1 * turn) / exact);
                     work = s.ledger().external_work;
                   }));
  } catch (const ComputationError&) {  // the list is as long as the run
  }
  report = simulation.integrator().reference;
  return list;
}

}  // namespace

TEST_CASE("Couette flow keeps its torque with updates, for strains at which the first neighbours have lost it") {
  ReferenceReport report;
  const std::vector<double> updated = torques(1.5, 0.4, report);
  REQUIRE(updated.size() == 4);
  CHECK(report.updates >= 5);
  CHECK(report.refused == 0);
  for (const double x : updated) CHECK(x == relative(1.0).epsilon(0.03));

  const std::vector<double> plain = torques(1e9, 0.4, report);
  REQUIRE(plain.size() == 4);
  CHECK(report.updates == 0);
  CHECK(plain.front() == relative(1.0).epsilon(0.03));
  CHECK(plain.back() > 1.3);
}

TEST_CASE("A simulation with updates goes on with the same bits after a restart and on any number of threads") {
  const auto compose = [] {
    Body fluid{"fluid", annulus(4, 24), Rkpm<2>{}, NodalCentroids{.fluid_modulus = 1.0, .fluid_viscosity = 0.1}, Materials{Region{"body", Newtonian{.viscosity = 1e-3}}}};
    for (std::size_t i = 0; i < fluid.size(); ++i) {
      const Vector4& X = fluid.reference()[i];
      fluid.velocity[i] = (1.0 + 1e6 * X[0]) * Vector4(-X[1], X[0], 0.0, 0.0) * 3e5;
    }
    return Simulation{Bodies{std::move(fluid)}, Contacts{}, Boundaries{}, UpdatedReference{ImplicitDynamics{.time_step = 2e-8}, 1.001, 3}};
  };
  const auto run = [](auto& simulation, double end, int threads) {
    const int before = thread_count();
    set_thread_count(threads);
    simulation.run(end);
    set_thread_count(before);
  };
  auto whole = compose();
  run(whole, 14e-8, 1);  // a run hits its end exactly, and so a step may differ by round-off
  run(whole, 24e-8, 1);
  REQUIRE(whole.integrator().reference.updates >= 3);
  auto part = compose();
  run(part, 14e-8, 4);
  REQUIRE(part.integrator().reference.updates >= 1);
  const SavedState saved = save_state(part);
  auto resumed = compose();
  restore_state(resumed, saved);
  run(resumed, 24e-8, 2);
  CHECK(resumed.body<0>().displacement == whole.body<0>().displacement);
  CHECK(resumed.body<0>().velocity == whole.body<0>().velocity);
  CHECK(resumed.integrator().reference.updates == whole.integrator().reference.updates);
  CHECK(resumed.ledger().reference_updates == whole.ledger().reference_updates);
  // Back to before the first update: the table of the first configuration is gone.
  auto fresh = compose();
  const SavedState first = save_state(fresh);
  CHECK_THROWS_WITH_AS(restore_state(resumed, first), doctest::Contains("cannot be restored"), ParameterError);
}

TEST_CASE("Updates that cannot be are refused in one sentence") {
  const auto compose = [](double distortion, int interval) {
    return Simulation{Bodies{solid_and_fluid()}, Contacts{}, Boundaries{}, UpdatedReference{CentralDifference{}, distortion, interval}};
  };
  CHECK_THROWS_WITH_AS(compose(1.0, 10), doctest::Contains("UpdatedReference.distortion"), ParameterError);
  CHECK_THROWS_WITH_AS(compose(2.0, 0), doctest::Contains("UpdatedReference.interval"), ParameterError);
  Body ring{"ring", bar({.length = 1.0 * um, .cells = 10, .periodic = true}), Rkpm<1>{}, NodalCentroids{}, Materials{Region{"body", NeoHookean{}}}};
  CHECK_THROWS_WITH_AS(ring.update_reference(), doctest::Contains("periodic"), ParameterError);
  // A body whose points are inverted keeps its reference.
  auto body = solid_and_fluid();
  for (std::size_t i = 0; i < body.size(); ++i) body.displacement[i] = Vector4(-2.0 * body.reference()[i][0], 0.0, 0.0, 0.0);
  CHECK(std::isinf(body.distortion()));
  CHECK_THROWS_WITH_AS(body.update_reference(), doctest::Contains("is inverted"), GeometryError);
  CHECK(body.reference().data() == body.table().particle_position.data());
}

}  // namespace simulation_reference_update_test
