// What a user writes: an own law, equation of state, gap law, contact, rigid surface, boundary term, integrator, observer, window,
// kernel, quadrature, director, cloud and output, each composed in a small simulation. The pages of the rooms
// (include/tactoid/<room>/README.md) show the code of this file, and a test compares them.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>

#include <tactoid/tactoid.hpp>
#include <tactoid/verify/all.hpp>

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

/// An elastic law with a viscosity in parallel, σ = σ_elastic + 2η d: a law that needs rates writes `response`.
struct KelvinVoigt {
  static constexpr bool uses_rate = true;
  NeoHookean elastic{};
  double viscosity = 0.005;          ///< η, Pa·s
  double density = elastic.density;  ///< kg/m³

  [[nodiscard]] double wave_speed() const { return elastic.wave_speed(); }
  [[nodiscard]] double shear_modulus() const { return elastic.shear_modulus(); }
  [[nodiscard]] double viscosity_modulus() const { return 2.0 * viscosity; }

  template <class T>
  [[nodiscard]] Response<T> response(const PointState<T>& point, NoHistory<T>&) const {
    const Inversion<T> F = invert(point.deformation_gradient);
    const Tensor<T> d = rate_of_deformation(velocity_gradient(point.deformation_rate, F.inverse));
    Response<T> r;
    r.stress = elastic.first_piola(point.deformation_gradient) + d * F.cofactors * T(2.0 * viscosity);  // P = J σ F⁻ᵀ
    r.energy = elastic.energy(point.deformation_gradient);
    r.dissipated_power = F.determinant * T(2.0 * viscosity) * contract(d, d);
    return r;
  }
};

/// Murnaghan's equation of state, which stiffens under pressure: p = p_ref + K/n (J⁻ⁿ − 1).
struct Murnaghan {
  static constexpr double n = 7.0;  // water

  template <class T>
  [[nodiscard]] static T pressure(const T& J, double reference_pressure, double bulk_modulus) {
    using std::exp, std::log;
    return T(reference_pressure) + T(bulk_modulus / n) * (exp(log(J) * T(-n)) - T(1.0));
  }
  template <class T>
  [[nodiscard]] static T energy(const T& J, double reference_pressure, double bulk_modulus) {
    using std::exp, std::log;
    const T power = exp(log(J) * T(1.0 - n));
    return T(bulk_modulus / n) * ((power - T(1.0)) * T(1.0 / (n - 1.0)) + J - T(1.0)) - T(reference_pressure) * (J - T(1.0));
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

/// A rigid fibre along y: a surface of your own.
struct RigidFibre {
  Vector3 center = Vector3::Zero();  ///< a point of the axis, m
  double radius = 1e-6;              ///< m

  void validate() const { require_positive("RigidFibre.radius", radius, "m"); }
  [[nodiscard]] RigidGap at(const Vector3& x, double) const {
    const Vector3 r(x[0] - center[0], 0.0, x[2] - center[2]);
    const double distance = r.norm();
    return {distance - radius, distance > 0.0 ? Vector3(r / distance) : Vector3(Vector3::UnitZ()), Vector3::Zero()};
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

// --- director ---------------------------------------------------------------------------------------------------

/// A director that aligns with the flow, A = w + χ d: χ = 1 carries it as a line of particles, χ = −1 is Convected.
struct FlowAligning {
  static constexpr double alignment = 0.8;  ///< χ

  template <class T>
  [[nodiscard]] static Tensor<T> rate_operator(const Tensor<T>& L) {
    return spin(L) + rate_of_deformation(L) * T(alignment);
  }
};

/// A twist: the director turns around z once in every `pitch`.
struct Twist {
  double pitch = 2e-6;  ///< m

  [[nodiscard]] Vector3 operator()(const Vector3& X) const {
    const double angle = 2.0 * std::numbers::pi * X[2] / pitch;
    return {std::cos(angle), std::sin(angle), 0.0};
  }
};

// --- geometry ---------------------------------------------------------------------------------------------------

/// A slab whose upper side is a wave: a box that is deformed before it becomes a body.
[[nodiscard]] inline PointCloud<3> wavy_slab(double amplitude) {
  const double length = 6e-6, height = 2e-6;
  PointCloud<3> cloud = box({.size = {length, 3e-6, height}, .cells = {12, 6, 4}});
  for (Point<3>& X : cloud.positions)
    X[2] += amplitude * X[2] / height * std::cos(2.0 * std::numbers::pi * X[0] / length);
  validate(cloud);  // GeometryError where a cell is inverted
  return cloud;
}

/// Two regions side by side, from positions and cells: what a generator or a reader of files has to fill in.
[[nodiscard]] inline PointCloud<2> two_squares(double edge) {
  PointCloud<2> cloud;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 3; ++i) cloud.positions.push_back(edge * Point<2>(i, j));
  cloud.cells = {{0, 1, 3, 4}, {1, 2, 4, 5}};  // tensor order: x first, then y
  cloud.regions = {"soft", "stiff"};
  cloud.cell_regions = {0, 1};
  cloud.facets = extract_facets(cloud);  // the surface, oriented outwards
  return morton_ordered(cloud);          // neighbours in space are near in memory
}

// --- output -----------------------------------------------------------------------------------------------------

/// A frame for ParaView with a field of your own: the particles of body 0 and their speeds.
template <class S>
void write_speeds(const std::filesystem::path& path, S& simulation) {
  const ParticleFields particles = simulation.template particles<0>();
  std::vector<double> speed;
  for (const Vector4& v : particles.velocity) speed.push_back(v.norm());
  VtuGrid grid(simulation.time());
  grid.points(particles.position);
  grid.vertices(particles.position.size());  // or grid.cells(body.cloud().cells): the background cells
  grid.point_data("speed", speed);
  grid.write(path);
}

/// An observer that keeps a history and a series of such frames.
[[nodiscard]] inline auto speed_recorder(const std::filesystem::path& folder, double interval) {
  prepare_folder(folder);
  return every(interval, [folder, history = HistoryWriter(folder / "history.csv", {"time", "kinetic_energy"}),
                          series = PvdSeries(folder / "speeds.pvd"), frame = 0](auto& simulation) mutable {
    history.write(std::array{simulation.time(), simulation.ledger().kinetic});
    const std::string file = fmt::format("speeds_{:04}.vtu", frame++);
    write_speeds(folder / file, simulation);
    series.add(simulation.time(), file);
  });
}

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
static_assert(ObjectiveRate<FlowAligning> && InitialDirector<Twist> && RigidSurface<RigidFibre>);
static_assert(EquationOfState<Murnaghan> && DirectorMaterial<NematicGel<Murnaghan>>);

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
  const KelvinVoigt law;
  CHECK(material_gate(law).passed());
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

TEST_CASE("An own equation of state: the pressure is the derivative of its energy") {
  CHECK(material_gate(NematicGel<Murnaghan>{}).passed());
  const double h = 1e-6, K = 2e5;
  CHECK(Murnaghan::pressure(1.0, 30.0, K) == 30.0);
  CHECK((Murnaghan::pressure(1.0 - h, 0.0, K) - Murnaghan::pressure(1.0 + h, 0.0, K)) / (2.0 * h) == test::relative(K).epsilon(1e-6));
  CHECK((Murnaghan::energy(0.9 - h, 30.0, K) - Murnaghan::energy(0.9 + h, 30.0, K)) / (2.0 * h) ==
        test::relative(Murnaghan::pressure(0.9, 30.0, K)).epsilon(1e-6));
}

TEST_CASE("An own rate and an own initial director: the director turns into the direction of stretch") {
  Body gel{"gel",           block(0.0), Rkpm<3>{}, NodalCentroids{}, Materials{Region{"body", NematicGel<>{}}},
           DirectorField<FlowAligning>{.diffusivity = 0.0}, Twist{.pitch = 8.0 * edge}};
  const double rate = 1e4, time = 1e-6;  // velocity (a x, −a y, 0)
  std::vector<Index> all(gel.size());
  std::iota(all.begin(), all.end(), Index{0});
  const PrescribedMotion stretch{all, [rate](const Vector3& X, double t) {
                                   return Vector3(X[0] * (std::exp(rate * t) - 1.0), X[1] * (std::exp(-rate * t) - 1.0), 0.0);
                                 }};
  const Field before = gel.director;
  Simulation simulation{Bodies{std::move(gel)}, Contacts{}, Boundaries{on<0>(stretch)}, CentralDifference{.time_step = 1e-9}};
  simulation.run(time);
  const double factor = std::exp(FlowAligning::alignment * rate * time);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Vector4& h = simulation.body<0>().director[i];
    CHECK(std::abs(h[0] - before[i][0] * factor) < 1e-5);
    CHECK(std::abs(h[1] - before[i][1] / factor) < 1e-5);
  }
}

TEST_CASE("Own clouds are bodies: volumes, regions and the patch test") {
  const PointCloud<3> slab = wavy_slab(0.5e-6);
  CHECK(volume(slab) == test::relative(6e-6 * 3e-6 * 2e-6).epsilon(1e-12));
  CHECK_THROWS_AS((void)wavy_slab(2.5e-6), GeometryError);
  Tensor3 F = Tensor3::Identity();
  F(0, 0) = 1.05;
  F(0, 2) = 0.02;
  Body b{"slab", slab, Rkpm<3>{}, NodalCentroids{}, Materials{Region{"body", NeoHookean{}}}};
  CHECK(patch_test(b, F).displacement_error < 1e-10);
  const PointCloud<2> squares = two_squares(1e-6);
  validate(squares);
  CHECK(squares.facets.size() == 6);
  CHECK(boundary_area(squares) == test::relative(6e-6).epsilon(1e-12));
}

TEST_CASE("An own rigid surface holds a body, and own output is there afterwards") {
  auto b = body(0.0, NeoHookean{});
  for (Vector4& v : b.velocity) v[2] = -0.05;
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "tactoid_own_output";
  Simulation simulation{Bodies{std::move(b)}, Contacts{},
                        Boundaries{on<0>(OnRigid<RepulsiveWall, RigidFibre>{
                            .law = {.penalty = 1e11}, .surface = {.center = {0.5 * edge, 0.0, -1.01e-6}, .radius = 1e-6}})},
                        CentralDifference{.safety = 0.3}};
  auto recorder = speed_recorder(folder, 1e-6);
  simulation.run(4e-6, recorder);
  CHECK(simulation.boundary<0>().force()[2] < 0.0);
  CHECK(simulation.ledger().error() < 1e-2);
  CHECK(std::filesystem::exists(folder / "speeds_0004.vtu"));
  CHECK(std::filesystem::exists(folder / "speeds.pvd"));
  std::filesystem::remove_all(folder);
}
