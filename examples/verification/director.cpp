// The director in bodies that are held or driven: relaxation by Dh/Dt = A(L) h + D {∇²h − (|h|² − 1) h/ε_d²} and
// transport by the two objective rates, against exact solutions.
#include "studies.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include <tactoid/director/objective_rates.hpp>
#include <tactoid/geometry/jitter.hpp>

#include "driven.hpp"
#include "gel_strip.hpp"

namespace tactoid::verification {
namespace director_study {
namespace {

constexpr double pi = std::numbers::pi, sqrt2 = std::numbers::sqrt2;
constexpr double length = 10e-6, diffusivity = 1e-7;

/// A gel without stresses of the director, soft, so that the director sets the step.
constexpr NematicGel<> quiet{
    .viscosity = 0.0, .bulk_modulus = 10.0, .reference_pressure = 0.0, .director_elasticity = 0.0, .activity = 0.0};

/// Order from the last two of several errors.
[[nodiscard]] double last_order(const std::vector<double>& errors) {
  return order(errors[errors.size() - 2], errors.back());
}

/// A strip whose walls hold the director, at rest, until it is steady.
[[nodiscard]] auto anchored_strip(int cells, double core_size, const DirectorFunction& start) {
  PlaneGel<Corotational> plane{.cloud = strip(length, cells),
                               .gel = quiet,
                               .field = {.diffusivity = diffusivity, .core_size = core_size},
                               .director = start};
  plane.first = fixed(everything(plane.cloud));
  plane.integrator.safety = 0.5;
  return plane;
}
template <class Simulation>
void anchor_walls(Simulation& simulation) {
  auto& body = simulation.template body<0>();
  body.anchored.assign(body.size(), 0);
  for (const auto& wall : {lower_wall(body.cloud()), upper_wall(body.cloud(), length)})
    for (const Index i : wall) body.anchored[i] = 1;
}

/// h = ρ (cos qy, sin qy, 0) with ρ² = 1 − ε²q² is steady between its own end values: the angle is linear.
void study_anchored_ends(Report& report) {
  const double q = 0.5 * pi / length, core = 2e-6, rho = std::sqrt(1.0 - core * core * q * q);
  const auto steady = [=](double y) { return Vector3(rho * std::cos(q * y), rho * std::sin(q * y), 0.0); };
  const std::vector<int> cells{16, 32};
  const auto errors = side_by_side<double>(cells.size(), [&](std::size_t c) {
    // The start is far from it: the angle is bent, the length 1.
    const DirectorFunction start = [&](const Vector3& X) {
      const double y = X[1];
      if (y == 0.0 || y > length * (1.0 - 1e-9)) return steady(y);
      const double angle = q * y + 0.6 * std::sin(2.0 * pi * y / length);
      return Vector3(std::cos(angle), std::sin(angle), 0.0);
    };
    auto simulation = anchored_strip(cells[c], core, start).simulation();
    anchor_walls(simulation);
    simulation.run(2.0 * length * length / diffusivity);  // e⁻²⁰
    double largest = 0.0;
    const auto& body = simulation.template body<0>();
    for (std::size_t i = 0; i < body.size(); ++i) {
      const double y = body.cloud().positions[i][1];
      largest = std::max(largest, std::abs(std::atan2(body.director[i][1], body.director[i][0]) - q * y));
    }
    return largest / (q * length);
  });
  report.at_most(fmt::format("anchored ends, {} cells: angle less the linear one, over the turn", cells.back()),
                 errors.back(), 1e-3, "steady state: h = sqrt(1 - (q eps)^2) (cos qy, sin qy)");
  report.at_least("anchored ends: order in the spacing", last_order(errors), 1.9, "second order");
}

/// h = (tanh(y/(√2 ε)), 0, 0); its energy ∫ ½|h'|² + (h² − 1)²/(4ε²) is 2√2/(3ε) per area: ½|h'|² = R = sech⁴/(4ε²).
void study_wall(Report& report, Level level) {
  const double core = 1e-6;
  const auto exact = [=](double y) { return std::tanh((y - 0.5 * length) / (sqrt2 * core)); };
  std::vector<int> cells{20, 40};
  if (level == Level::full) cells.push_back(80);
  struct Wall {
    double profile, energy;
  };
  const auto walls = side_by_side<Wall>(cells.size(), [&](std::size_t c) {
    const DirectorFunction start = [&](const Vector3& X) {  // a ramp
      const double y = X[1], end = exact(length);
      if (y == 0.0) return Vector3(-end, 0.0, 0.0);
      return Vector3(end * std::clamp(2.0 * (2.0 * y / length - 1.0), -1.0, 1.0), 0.0, 0.0);
    };
    auto simulation = anchored_strip(cells[c], core, start).simulation();
    anchor_walls(simulation);
    simulation.run(20.0 * core * core / diffusivity);
    Wall wall{0.0, 0.0};
    const auto& body = simulation.template body<0>();
    for (std::size_t i = 0; i < body.size(); ++i)
      wall.profile = std::max(wall.profile, std::abs(body.director[i][0] - exact(body.cloud().positions[i][1])));
    for (std::size_t p = 0; p < body.table().points(); ++p) {
      Vector3 slope = Vector3::Zero();
      for (const TableEntry& entry : body.table().row(p))
        slope += body.director[entry.particle][0] * entry.vector();
      const Vector3 h = body.director[body.table().owner[p]].template head<3>();
      wall.energy += body.table().volume[p] * (0.5 * slope.squaredNorm() + ginzburg_landau_energy(h, core));
    }
    wall.energy /= body.cloud().period[0];
    return wall;
  });
  const double energy = 2.0 * sqrt2 / (3.0 * core);
  std::vector<double> profile_errors, energy_errors;
  auto table = report.table("wall", {"cells", "profile_error", "energy_per_area_1_per_m", "energy_error"});
  for (std::size_t c = 0; c < cells.size(); ++c) {
    profile_errors.push_back(walls[c].profile);
    energy_errors.push_back(std::abs(walls[c].energy / energy - 1.0));
    table.write(std::array{double(cells[c]), profile_errors[c], walls[c].energy, energy_errors[c]});
  }
  const auto spacings = std::lround(core / length * cells.back());
  report.at_most(fmt::format("wall, {} spacings per core size: profile less tanh(x/(sqrt2 eps))", spacings),
                 profile_errors.back(), level == Level::full ? 2.5e-3 : 1e-2, "Ginzburg-Landau wall");
  report.compare(fmt::format("wall, {} spacings per core size: energy per area, 1/m", spacings), walls.back().energy,
                 energy, level == Level::full ? 2e-3 : 5e-3, "2 sqrt2/(3 eps)");
  report.at_least("wall: order of the profile in the spacing", last_order(profile_errors), 1.9, "second order");
  report.at_least("wall: order of the energy in the spacing", last_order(energy_errors), 1.9, "second order");
}

/// A periodic square held in the state x = X + (a/K) sin(KY) e_x, which keeps the volume; the director has the angle
/// δ sin(k·x), k = (K, 2K), in the *current* configuration, where it decays as e^{−D k² t}.
struct Decay {
  double rate = 0.0, exact = 0.0;
};
[[nodiscard]] Decay fourier_mode(int cells, double shear) {
  const double K = 2.0 * pi / length, small = 1e-4;
  PlaneGel<Corotational> plane{
      .cloud = rectangle({.size = {length, length}, .cells = {cells, cells}, .periodic = {true, true}}),
      .gel = quiet,
      .field = {.diffusivity = diffusivity, .core_size = 100e-6}};
  const auto place = [=](const Vector3& X) { return Vector3(X[0] + shear / K * std::sin(K * X[1]), X[1], 0.0); };
  const auto wave = [=](const Vector3& X) {
    const Vector3 x = place(X);
    return std::sin(K * (x[0] + 2.0 * x[1]));
  };
  plane.director = [=](const Vector3& X) {
    const double angle = small * wave(X);
    return Vector3(std::cos(angle), std::sin(angle), 0.0);
  };
  plane.first = {everything(plane.cloud), [=](const Vector3& X, double) { return Vector3(place(X) - X); }};
  plane.integrator.safety = 0.05;
  auto simulation = plane.simulation();
  const auto& body = simulation.body<0>();
  const auto amplitude = [&] {
    double sum = 0.0;
    for (std::size_t i = 0; i < body.size(); ++i)
      sum += body.director[i][1] * wave(body.table().particle_position[i].head<3>());
    return sum;
  };
  Decay decay;
  decay.exact = diffusivity * 5.0 * K * K;
  const double start = amplitude();
  const double end = 1.0 / decay.exact;
  simulation.run(end);
  decay.rate = std::log(start / amplitude()) / end;
  return decay;
}

/// Decay rate over D k² of the shortest wave, ± from one particle to the next along x, in an undeformed periodic
/// square.
[[nodiscard]] double shortest_wave(const PointCloud<2>& cloud, int cells) {
  const double spacing = length / cells, wave_number = pi / spacing;
  PlaneGel<Corotational> plane{
      .cloud = cloud, .gel = quiet, .field = {.diffusivity = diffusivity, .core_size = 100e-6}};
  const auto sign = [=](const Vector3& X) { return std::lround(X[0] / spacing) % 2 == 0 ? 1.0 : -1.0; };
  plane.director = [=](const Vector3& X) { return Vector3(1.0, 1e-4 * sign(X), 0.0); };
  plane.first = fixed(everything(plane.cloud));
  plane.integrator.safety = 0.1;
  auto simulation = plane.simulation();
  const auto& body = simulation.body<0>();
  const auto amplitude = [&] {
    double sum = 0.0;
    for (std::size_t i = 0; i < body.size(); ++i)
      sum += body.director[i][1] * sign(body.table().particle_position[i].head<3>());
    return sum;
  };
  const double exact = diffusivity * wave_number * wave_number, start = amplitude();
  simulation.run(0.1 / exact);
  return std::log(start / amplitude()) / 0.1;
}

/// A square stretched by a and b along its sides, J = a b. The density of the director per reference volume is
/// constant, so that γ/ρᵈ = D J: a mode cos(πX/l) along x decays with D J k² = D (b/a) (π/l)², and the length of a
/// uniform director is |h|² = 1/(1 + (1/h₀² − 1) e^{−2 D J t/ε²}).
struct Stretched {
  double rate = 0.0, length = 0.0;
};
constexpr double stretch_a = 1.6, stretch_b = 1.2;
[[nodiscard]] Stretched stretched(int cells) {
  const double small = 1e-4, core = 1e-6;
  PlaneGel<Corotational> plane{.cloud = rectangle({.size = {length, length}, .cells = {cells, cells}}), .gel = quiet};
  Tensor3 F = Tensor3::Identity();
  F(0, 0) = stretch_a, F(1, 1) = stretch_b;
  plane.first = affine(everything(plane.cloud), [=](double) { return F; });
  plane.integrator.safety = 0.3;
  plane.field = {.diffusivity = diffusivity, .core_size = 100e-6};
  const auto wave = [=](const Vector3& X) { return std::cos(pi * X[0] / length); };
  plane.director = [=](const Vector3& X) {
    const double angle = small * wave(X);
    return Vector3(std::cos(angle), std::sin(angle), 0.0);
  };
  Stretched result;
  {
    auto simulation = plane.simulation();
    const auto& body = simulation.body<0>();
    const auto amplitude = [&] {
      double sum = 0.0;
      for (std::size_t i = 0; i < body.size(); ++i)
        sum += body.nodal_volumes()[i] * body.director[i][1] * wave(body.table().particle_position[i].head<3>());
      return sum;
    };
    const double end = stretch_a / stretch_b * length * length / (diffusivity * pi * pi), start = amplitude();
    simulation.run(end);
    result.rate = std::log(start / amplitude()) / end;
  }
  plane.field.core_size = core;
  plane.director = [](const Vector3&) { return Vector3(0.0, 0.18, 0.24); };
  plane.integrator.safety = 0.01;
  auto simulation = plane.simulation();
  simulation.run(core * core / diffusivity);
  result.length = simulation.body<0>().director[0].norm();
  return result;
}

void study_decay(Report& report, Level level) {
  const std::string source = "Fourier mode in the current configuration: D k^2";
  for (const double shear : {0.0, 0.8}) {
    std::vector<int> cells{16, 32};
    if (level == Level::full) cells.push_back(64);
    const auto modes = side_by_side<Decay>(cells.size(), [&](std::size_t c) {
      return fourier_mode(cells[cells.size() - 1 - c], shear);  // the finest first
    });
    std::vector<double> errors;
    for (std::size_t c = 0; c < cells.size(); ++c)
      errors.insert(errors.begin(), std::abs(modes[c].rate / modes[c].exact - 1.0));
    const std::string label = shear > 0.0 ? "sheared by 0.8 sin(Ky)" : "undeformed";
    report.compare(fmt::format("decay of a mode, {}, {} cells, 1/s", label, cells.back()), modes[0].rate,
                   modes[0].exact, level == Level::full ? 0.02 : 0.07, source);
    report.at_least("order of the decay in the spacing, " + label, last_order(errors), 1.9, source);
  }
  const PointCloud<2> regular = rectangle({.size = {length, length}, .cells = {10, 10}, .periodic = {true, true}});
  const std::string nyquist = "two spacings long; a gradient at the particles does not see it";
  report.note("decay of the shortest wave over D k^2, regular cloud", shortest_wave(regular, 10), 1.0, nyquist);
  report.note("decay of the shortest wave over D k^2, cloud jittered by 20 %", shortest_wave(jitter(regular, 0.2), 10),
              1.0, nyquist);
}

// ---- transport ----------------------------------------------------------------------------------------------------

/// A cube with a director, three-dimensional and whole driven.
template <class Rate>
[[nodiscard]] auto driven_cube(PrescribedMotion motion, const PointCloud<3>& cloud, const DirectorFunction& start,
                               double step) {
  return Simulation{Bodies{Body{"cube", cloud, Rkpm<3>{}, NodalCentroids{}, Materials{Region{"body", quiet}},
                                DirectorField<Rate>{.diffusivity = 0.0}, start}},
                    Contacts{}, Boundaries{on<0>(motion)}, CentralDifference{.time_step = step}};
}

const Vector3 start_director(0.6, 0.48, 0.64);

/// Largest error of the director of a cube that follows F(t), after `steps` steps of the time `end`.
template <class Rate>
[[nodiscard]] double transport_error(const std::function<Tensor3(double)>& F, const Vector3& exact, double end,
                                     int steps) {
  const PointCloud<3> cloud = jitter(box({.size = {2e-3, 2e-3, 2e-3}, .cells = {2, 2, 2}}), 0.2);
  auto simulation = driven_cube<Rate>(
      affine(everything(cloud), F), cloud, [](const Vector3&) { return start_director; }, end / steps);
  simulation.run(end);
  double largest = 0.0;
  for (const Vector4& h : simulation.template body<0>().director)
    largest = std::max(largest, (h.head<3>() - exact).norm());
  return largest;
}

void study_transport(Report& report) {
  // Rigid spin by ten turns: h turns with the body, at any step.
  const Vector3 axis = Vector3(1.0, -2.0, 0.5).normalized();
  const double end = 1e-3, turns = 10.0;
  const auto spin = [=](double t) {
    return Tensor3(Eigen::AngleAxisd(2.0 * pi * (turns + 0.2) * t / end, axis).toRotationMatrix());
  };
  const Vector3 turned = spin(end) * start_director;
  report.at_most("rigid spin by ten turns, corotational: error of h",
                 transport_error<Corotational>(spin, turned, end, 400), 1e-10, "h turns with the body");
  report.at_most("rigid spin by ten turns, convected: error of h", transport_error<Convected>(spin, turned, end, 400),
                 1e-10, "h turns with the body");

  // Simple shear γ(t) = γ₁ sin²: the spin turns h by −γ/2 about z; the convected rate gives F⁻ᵀ h₀.
  const double shear = 1.5;
  const auto sheared = [=](double t) {
    Tensor3 F = Tensor3::Identity();
    F(0, 1) = shear * std::pow(std::sin(0.5 * pi * t / end), 2);
    return F;
  };
  const Vector3 half = Eigen::AngleAxisd(-0.5 * shear, Vector3::UnitZ()) * start_director;
  const double coarse = transport_error<Corotational>(sheared, half, end, 50);
  const double fine = transport_error<Corotational>(sheared, half, end, 100);
  report.at_most("simple shear by 1.5, corotational, 100 steps: error of h", fine, 1e-4, "turned by half the shear");
  report.at_least("simple shear, corotational: order in the time step", order(coarse, fine), 1.95, "second order");
  const Vector3 covariant = sheared(end).inverse().transpose() * start_director;
  report.at_most("simple shear by 1.5, convected, 50 steps: error of h",
                 transport_error<Convected>(sheared, covariant, end, 50), 1e-11, "F^-T h, exact at any step");

  // Pure stretch: the corotational rate leaves h, the convected one shrinks it along the stretch.
  const auto stretch = [=](double t) {
    Tensor3 F = Tensor3::Identity();
    F(0, 0) = 1.0 + 0.8 * t / end, F(1, 1) = 1.0 / F(0, 0);
    return F;
  };
  report.at_most("pure stretch by 1.8, corotational: error of h",
                 transport_error<Corotational>(stretch, start_director, end, 50), 1e-13, "h stays");
  report.at_most("pure stretch by 1.8, convected: error of h",
                 transport_error<Convected>(stretch, stretch(end).inverse().transpose() * start_director, end, 50),
                 1e-11, "F^-T h");

  // A periodic motion that varies in space, x = X + s (sin KY, sin KZ, sin KX)/K: order in the spacing.
  const double K = 2.0 * pi / 2e-3, strain = 0.4;
  const auto error = [&](int cells) {
    const double edge = 2e-3;
    const PointCloud<3> cloud =
        box({.size = {edge, edge, 4 * edge / cells}, .cells = {cells, cells, 4}, .periodic = {true, true, true}});
    PrescribedMotion motion{everything(cloud), [=](const Vector3& X, double t) {
                              const double s = strain / K * t / end;
                              return Vector3(s * std::sin(K * X[1]), s * std::sin(K * X[0]), s * std::cos(K * X[0]));
                            }};
    auto simulation = driven_cube<Convected>(motion, cloud, [](const Vector3&) { return start_director; }, end / 40);
    simulation.run(end);
    double sum = 0.0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Point<3>& X = cloud.positions[i];
      Tensor3 F = Tensor3::Identity();
      F(0, 1) = strain * std::cos(K * X[1]), F(1, 0) = strain * std::cos(K * X[0]);
      F(2, 0) = -strain * std::sin(K * X[0]);
      const Vector3 h = simulation.template body<0>().director[i].template head<3>();
      sum += (h - F.inverse().transpose() * start_director).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(cloud.size()));
  };
  const double wide = error(10), narrow = error(20);
  report.at_most("motion that varies in space, convected, 20 cells: rms error of h", narrow, 0.01, "F^-T h");
  report.at_least("motion that varies in space, convected: order in the spacing", order(wide, narrow), 1.9,
                  "second order");
}

}  // namespace
}  // namespace director_study

void director(Report& report, Level level) {
  using namespace director_study;
  study_anchored_ends(report);
  study_wall(report, level);
  study_decay(report, level);
  const Stretched s = stretched(level == Level::full ? 32 : 16);
  const double rate = diffusivity * stretch_b / stretch_a * pi * pi / (length * length);
  report.compare("decay of a mode across a stretched square, J = 1.92, 1/s", s.rate, rate, 0.02, "D J k^2");
  const double J = stretch_a * stretch_b;
  const double exact = 1.0 / std::sqrt(1.0 + (1.0 / 0.09 - 1.0) * std::exp(-2.0 * J));
  report.compare("length of a uniform director after eps^2/D, J = 1.92", s.length, exact, 1e-3,
                 "logistic, rate 2 D J/eps^2");
  study_transport(report);
}

}  // namespace tactoid::verification
