// What a user writes: an own law, gap law, contact, boundary term, integrator, observer, window, kernel and quadrature,
// each composed in a small simulation. The pages of the rooms (include/tactoid/<room>/README.md) show the code of this
// file, and a test compares them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>

#include <tactoid/tactoid.hpp>

#include "relative.hpp"

using namespace tactoid;

// --- material ---------------------------------------------------------------------------------------------------

/// Saint-Venant–Kirchhoff: W = λ/2 (tr E)² + μ E:E. The stress comes from the energy.
struct SaintVenant {
  double density = 1000.0;  ///< ρ₀, kg/m³
  double lambda = 1.0e4;    ///< λ, Pa
  double mu = 5.0e3;        ///< μ, Pa

  void validate() const {
    require_positive("SaintVenant.density", density, "kg/m^3");
    require_positive("SaintVenant.mu", mu, "Pa");
  }
  [[nodiscard]] double wave_speed() const { return std::sqrt((lambda + 2.0 * mu) / density); }
  [[nodiscard]] double shear_modulus() const { return mu; }

  template <class T>
  [[nodiscard]] T energy(const Tensor<T>& F) const {
    const Tensor<T> E = green_lagrange(F);
    const T trace = first_invariant(E);
    return T(0.5 * lambda) * trace * trace + T(mu) * contract(E, E);
  }
};

/// An elastic law with a viscosity in parallel, P = P_elastic + η Ḟ: a law that needs rates writes `response`.
struct KelvinVoigt {
  static constexpr bool uses_rate = true;
  NeoHookean elastic{};
  double viscosity = 0.01;           ///< η, Pa·s
  double density = elastic.density;  ///< kg/m³

  [[nodiscard]] double wave_speed() const { return elastic.wave_speed(); }
  [[nodiscard]] double shear_modulus() const { return elastic.shear_modulus(); }
  [[nodiscard]] double viscosity_modulus() const { return viscosity; }

  template <class T>
  [[nodiscard]] Response<T> response(const PointState<T>& point, NoHistory<T>&) const {
    Response<T> r;
    r.stress = elastic.first_piola(point.deformation_gradient) + point.deformation_rate * T(viscosity);
    r.energy = elastic.energy(point.deformation_gradient);
    r.dissipated_power = T(viscosity) * contract(point.deformation_rate, point.deformation_rate);
    return r;
  }
};

// --- contact ----------------------------------------------------------------------------------------------------

/// Morse adhesion: Φ = w [(1 − e^{−g/l})² − 1], least at g = 0.
struct Morse {
  double work = 1e-5;     ///< w, J/m²
  double length = 50e-9;  ///< l, m

  void validate() const {
    require_non_negative("Morse.work", work, "J/m^2");
    require_positive("Morse.length", length, "m");
  }
  [[nodiscard]] double reach() const { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] double potential(double gap) const { return work * decay(gap) * (decay(gap) - 2.0); }
  [[nodiscard]] double traction(double gap) const { return 2.0 * work / length * decay(gap) * (decay(gap) - 1.0); }
  [[nodiscard]] double stiffness(double gap) const {
    return 2.0 * work / (length * length) * std::abs(decay(gap) * (1.0 - 2.0 * decay(gap)));
  }

 private:
  [[nodiscard]] double decay(double gap) const { return std::exp(-gap / length); }
};

/// A spring between the centres of mass of two bodies: a Contact from nothing.
struct Tether {
  double stiffness = 1e-3;  ///< k, N/m
  double length = 0.0;      ///< at rest: the distance at the start, m

  template <int D>
  void initialize(const PointCloud<D>&, const ParticleFields& a, const PointCloud<D>&, const ParticleFields& b) {
    require_non_negative("Tether.stiffness", stiffness, "N/m");
    length = (center(b) - center(a)).norm();
  }
  TermEnergy apply(const ParticleFields& a, const ParticleFields& b, double) const {
    const Vector4 r = center(b) - center(a);
    const double stretch = r.norm() - length;
    const Vector4 pull = (stiffness * stretch / r.norm()) * r;
    const double ma = mass(a), mb = mass(b);
    for (std::size_t i = 0; i < a.mass.size(); ++i) a.force[i] += (a.mass[i] / ma) * pull;
    for (std::size_t i = 0; i < b.mass.size(); ++i) b.force[i] -= (b.mass[i] / mb) * pull;
    return {.potential = 0.5 * stiffness * stretch * stretch};
  }
  [[nodiscard]] double stiffness_rate(const ParticleFields& a, const ParticleFields& b) const {
    return stiffness * (1.0 / mass(a) + 1.0 / mass(b));
  }

 private:
  static double mass(const ParticleFields& body) { return std::accumulate(body.mass.begin(), body.mass.end(), 0.0); }
  static Vector4 center(const ParticleFields& body) {
    Vector4 sum = Vector4::Zero();
    for (std::size_t i = 0; i < body.mass.size(); ++i) sum += body.mass[i] * body.position[i];
    return sum / mass(body);
  }
};

// --- boundary ---------------------------------------------------------------------------------------------------

/// An optical trap: every particle is drawn to a centre, f = −m ω² (x − c).
struct Trap {
  double frequency = 1e5;             ///< ω, 1/s
  Vector3 center = Vector3::Zero();   ///< c, m

  template <int D>
  void initialize(const PointCloud<D>&, const ParticleFields&) {
    require_positive("Trap.frequency", frequency, "1/s");
  }
  TermEnergy apply(const ParticleFields& body, double) const {
    TermEnergy total;
    for (std::size_t i = 0; i < body.mass.size(); ++i) {
      const Vector4 r = body.position[i] - pad(center);
      body.force[i] -= body.mass[i] * frequency * frequency * r;
      total.potential += 0.5 * body.mass[i] * frequency * frequency * r.squaredNorm();
    }
    return total;
  }
  [[nodiscard]] double stiffness_rate(const ParticleFields&) const { return frequency * frequency; }
};

// --- integrator -------------------------------------------------------------------------------------------------

/// Central differences whose first steps are short, and grow.
struct GentleStart {
  double safety = 0.8;  ///< of the largest stable step
  int ramp = 20;        ///< steps until the full step is reached
  int taken = 0;

  template <class System>
  void initialize(System&) {
    require_positive("GentleStart.safety", safety);
  }
  template <class System>
  void step(System& system, double until) {
    const double share = std::min(1.0, (taken + 1.0) / (ramp + 1.0));
    const double dt = std::min(share * safety * system.largest_stable_time_step(), until - system.time());
    system.kick(0.5 * (system.last_time_step() + dt));
    system.drift(dt);
    system.evaluate();
    ++taken;
  }
  template <class Archive>
  void state(Archive& archive) { archive("taken", taken); }
};

// --- observer ---------------------------------------------------------------------------------------------------

/// Remembers the largest kinetic energy and when it was reached.
struct Peak {
  double energy = 0.0, time = 0.0;

  template <class S>
  void after_step(S& simulation) {
    if (simulation.ledger().kinetic <= energy) return;
    energy = simulation.ledger().kinetic;
    time = simulation.time();
  }
  template <class S>
  void begin(S& simulation) { after_step(simulation); }
  template <class S>
  void end(S&) {}
  template <class S>
  void last_good_state(S&) {}
  template <class S>
  [[nodiscard]] double next_time(const S&) const { return std::numeric_limits<double>::infinity(); }
};

// --- kernel -----------------------------------------------------------------------------------------------------

/// w(q) = (1 − q²)³ as a window.
struct Bell {
  [[nodiscard]] static double value(double q) { return q < 1.0 ? std::pow(1.0 - q * q, 3) : 0.0; }
  [[nodiscard]] static double slope(double q) { return q < 1.0 ? -6.0 * q * std::pow(1.0 - q * q, 2) : 0.0; }
};

/// Weighted least squares of a linear function: an own gradient operator, with the shape functions of MLS.
template <int D>
struct LeastSquares {
  static constexpr int dimension = D, order = 1, basis_size = D + 1;
  using Window = Bell;
  double support = 2.1;  ///< support radius per longest cell edge

  void validate() const { require_positive("LeastSquares.support", support, "spacings"); }

  void shape_functions(std::span<const KernelNeighbor<D>> neighbors, ShapeFunctions<D>& out) const {
    Mls<D, 1, Bell>{.support = support}.shape_functions(neighbors, out);
  }
  double direct_gradient(std::span<const KernelNeighbor<D>> neighbors, std::vector<Point<D>>& out) const {
    using Basis = Eigen::Matrix<double, D + 1, 1>;
    out.assign(neighbors.size(), Point<D>::Zero());
    if (neighbors.empty()) return std::numeric_limits<double>::infinity();
    const double length = neighbors.front().support;  // only scales the basis
    const auto basis = [&](const auto& n) { return Basis((Basis() << 1.0, n.offset / length).finished()); };
    const auto weight = [](const auto& n) { return Window::value(n.offset.norm() / n.support); };
    Eigen::Matrix<double, D + 1, D + 1> M = Eigen::Matrix<double, D + 1, D + 1>::Zero();
    for (const auto& n : neighbors) M += weight(n) * basis(n) * basis(n).transpose();
    const Eigen::SelfAdjointEigenSolver<decltype(M)> spectrum(M);
    const double least = spectrum.eigenvalues()[0], largest = spectrum.eigenvalues()[D];
    if (!(least > 1e-14 * largest)) return std::numeric_limits<double>::infinity();
    const Eigen::Matrix<double, D, D + 1> rows = M.inverse().template bottomRows<D>();
    for (std::size_t k = 0; k < neighbors.size(); ++k)
      out[k] = (weight(neighbors[k]) / length) * (rows * basis(neighbors[k]));
    return largest / least;
  }
};

// --- quadrature -------------------------------------------------------------------------------------------------

/// One point at every particle, with its nodal volume, and the kernel's value-based gradients: plain nodal integration,
/// without correction and without stabilisation. For bodies of one region.
struct PlainNodal {
  [[nodiscard]] Stabilization stabilization(double) const { return {}; }

  template <Kernel K>
  [[nodiscard]] PointTable build(const PointCloud<K::dimension>& cloud, const K& kernel) const {
    constexpr int D = K::dimension;
    const std::vector<double> supports = support_radii(kernel, cloud);
    PointTable table = empty_table(cloud);
    table.volume = nodal_volumes(cloud);
    table.region.assign(cloud.size(), 0);
    for (Index i = 0; i < cloud.size(); ++i) {
      table.owner.push_back(i);
      table.position.push_back(pad(cloud.positions[i]).template head<3>());
    }
    const NeighborTable neighbors = neighbor_table(cloud, cloud.positions, supports);
    lay_out_rows(table, neighbors);
    std::vector<KernelNeighbor<D>> near;
    std::vector<Point<D>> gradient;
    for (Index q = 0; q < cloud.size(); ++q) {
      near.clear();
      for (Index i : neighbors.row(q))
        near.push_back({cloud.difference(cloud.positions[q], cloud.positions[i]), supports[i], 1.0});
      check_condition(q, table.position[q], near.size(), kernel.direct_gradient(near, gradient), 1e10);
      for (std::size_t k = 0; k < near.size(); ++k)
        for (int d = 0; d < D; ++d) table.entries[table.offsets[q] + k].gradient[d] = gradient[k][d];
    }
    color_chunks(table, 64);
    return table;
  }
};

// --- the tests --------------------------------------------------------------------------------------------------

namespace {

const double edge = 3e-6;

PointCloud<3> block(double z) {
  return box({.size = {edge, edge, edge}, .cells = {3, 3, 3}, .origin = {0.0, 0.0, z}});
}

template <class Law>
auto body(double z, const Law& law) {
  return Body{"block", block(z), Rkpm<3>{}, NodalCentroids{}, Materials{Region{"body", law}}};
}

/// A velocity that bends and stretches.
template <class B>
void stir(B& b) {
  for (std::size_t i = 0; i < b.size(); ++i) {
    const Point<3> X = b.cloud().positions[i] / edge;
    b.velocity[i] = Vector4(0.1 * X[2] * X[2], 0.05 * X[0] * X[1], 0.1 * X[0], 0.0);
  }
}

/// The energies after a free flight that begins with this motion.
template <class Law>
EnergyLedger free_flight(const Law& law, double safety) {
  auto b = body(0.0, law);
  stir(b);
  Simulation simulation{Bodies{std::move(b)}, Contacts{}, Boundaries{}, CentralDifference{.safety = safety}};
  simulation.run(2e-6);
  return simulation.ledger();
}

}  // namespace

static_assert(Material<SaintVenant> && Material<KelvinVoigt> && GapLaw<Morse> && Contact<Tether, 3>);
static_assert(BoundaryTerm<Trap, 3> && Window<Bell> && Kernel<LeastSquares<3>>);
static_assert(Quadrature<PlainNodal, Rkpm<3>> && Quadrature<PlainNodal, LeastSquares<2>>);

TEST_CASE("An own energy is a law: its stress is F S, and a run conserves energy") {
  const SaintVenant law;
  Tensor3 F;
  F << 1.1, 0.2, -0.1, 0.05, 0.9, 0.1, 0.0, -0.2, 1.05;
  const Tensor3 E = 0.5 * (F.transpose() * F - Tensor3::Identity());
  const Tensor3 S = law.lambda * E.trace() * Tensor3::Identity() + 2.0 * law.mu * E;
  CHECK((stress_of_energy(law, F) - F * S).norm() < 1e-12 * (F * S).norm());

  // Central differences: of second order in the step.
  const EnergyLedger coarse = free_flight(law, 0.4), fine = free_flight(law, 0.1);
  CHECK(fine.strain > 0.01 * fine.initial);
  CHECK(fine.error() < 1e-3);
  CHECK(fine.error() < coarse.error() / 12.0);
  CHECK_THROWS_AS(body(0.0, SaintVenant{.mu = -1.0}), ParameterError);
}

TEST_CASE("An own law with a rate dissipates what its stress says") {
  // Viscous forces see the velocity half a step late: of first order in the step.
  const KelvinVoigt law{.viscosity = 0.01};
  const EnergyLedger coarse = free_flight(law, 0.1), fine = free_flight(law, 0.025);
  CHECK(fine.dissipated > 0.05 * fine.initial);
  CHECK(fine.error() < 5e-3);
  CHECK(fine.error() < coarse.error() / 3.0);
}

TEST_CASE("An own gap law becomes a contact and a boundary term") {
  const Morse law;
  CHECK(law.traction(0.0) == 0.0);
  for (const double gap : {-20e-9, 10e-9, 30e-9, 200e-9}) {
    const double h = 1e-12;
    const double slope = (law.potential(gap + h) - law.potential(gap - h)) / (2.0 * h);
    const double stiffness = std::abs(law.traction(gap + h) - law.traction(gap - h)) / (2.0 * h);
    CHECK(law.traction(gap) == test::relative(-slope).epsilon(1e-6));
    CHECK(law.stiffness(gap) == test::relative(stiffness).epsilon(1e-5));
  }
  Simulation simulation{Bodies{body(0.0, NeoHookean{}), body(edge + 60e-9, NeoHookean{})},
                        Contacts{between<1, 0>(SurfaceContact<Morse>{})}, Boundaries{},
                        CentralDifference{.safety = 0.2}};
  simulation.run(1e-6);
  const Motion lower = motion(simulation.particles<0>()), upper = motion(simulation.particles<1>());
  CHECK(lower.momentum[2] > 0.0);  // drawn up
  CHECK(std::abs(lower.momentum[2] + upper.momentum[2]) < 1e-12 * lower.momentum[2]);
  CHECK(simulation.ledger().error() < 1e-2);

  Simulation resting{Bodies{body(30e-9, NeoHookean{})}, Contacts{}, Boundaries{on<0>(OnRigid<Morse>{})},
                     CentralDifference{}};
  resting.run(1e-7);
  CHECK(motion(resting.particles<0>()).momentum[2] < 0.0);
}

TEST_CASE("An own contact: the tether oscillates with its frequency") {
  auto a = body(0.0, NeoHookean{}), b = body(2.0 * edge, NeoHookean{});
  for (Vector4& v : b.velocity) v[2] = 0.01;
  Simulation simulation{Bodies{std::move(a), std::move(b)}, Contacts{between<0, 1>(Tether{.stiffness = 1e-4})},
                        Boundaries{}, CentralDifference{.safety = 0.3}};
  const double reduced = 0.5 * motion(simulation.particles<0>()).mass;
  const double omega = std::sqrt(1e-4 / reduced);
  simulation.run(0.5 * std::numbers::pi / omega);  // a quarter of a period: the tether is longest
  const Motion ma = motion(simulation.particles<0>()), mb = motion(simulation.particles<1>());
  CHECK(mb.center_of_mass[2] - ma.center_of_mass[2] - 2.0 * edge == test::relative(0.01 / omega).epsilon(1e-3));
  CHECK(simulation.ledger().error() < 1e-3);
}

TEST_CASE("An own boundary term: the trap swings the body as a pendulum") {
  const Vector3 middle(0.5 * edge, 0.5 * edge, 0.5 * edge), offset(0.0, 0.0, 1e-7);
  Simulation simulation{Bodies{body(0.0, NeoHookean{.mu = 1e5, .lambda = 1e5})}, Contacts{},
                        Boundaries{on<0>(Trap{.frequency = 1e6, .center = middle + offset})},
                        CentralDifference{.safety = 0.3}};
  simulation.run(2e-6);
  const double z = motion(simulation.particles<0>()).center_of_mass[2];
  CHECK(z - middle[2] == test::relative(1e-7 * (1.0 - std::cos(2.0))).epsilon(1e-3));
}

TEST_CASE("An own integrator and an own observer drive a run") {
  auto b = body(0.0, NeoHookean{});
  stir(b);
  Simulation simulation{Bodies{std::move(b)}, Contacts{}, Boundaries{}, GentleStart{.safety = 0.2}};
  Peak peak;
  simulation.run(1e-6, peak);
  CHECK(simulation.time() == 1e-6);
  CHECK(simulation.integrator().taken == static_cast<int>(simulation.steps()));
  CHECK(simulation.ledger().error() < 1e-3);
  CHECK(peak.energy >= simulation.ledger().kinetic);
  CHECK(peak.energy > 0.0);
}

TEST_CASE("An own window, kernel and quadrature make a body: linear fields have exact gradients") {
  Body b{"block", block(0.0), LeastSquares<3>{}, PlainNodal{}, Materials{Region{"body", NeoHookean{}}}};
  Tensor3 H;
  H << 0.01, 0.02, -0.03, 0.0, -0.01, 0.015, 0.005, 0.0, 0.02;
  for (std::size_t i = 0; i < b.size(); ++i) b.displacement[i] = pad(Vector3(H * b.cloud().positions[i]));
  const Tensor3 F = H + Tensor3::Identity();
  const Tensor3 sigma = cauchy_from_piola(NeoHookean{}.first_piola(F), F);
  for (const PointSample& sample : b.sample_points()) CHECK((sample.cauchy - sigma).norm() < 1e-10 * sigma.norm());

  Body windowed{"block", block(0.0), Rkpm<3, 1, Bell>{.support = 2.1}, NodalCentroids{},
                Materials{Region{"body", NeoHookean{}}}};
  stir(windowed);
  Simulation simulation{Bodies{std::move(windowed)}, Contacts{}, Boundaries{}, CentralDifference{.safety = 0.2}};
  simulation.run(1e-6);
  CHECK(simulation.ledger().error() < 1e-3);
}
