// Waves and vibrations: frequencies of the discrete body, K u = ω² M u with the stiffness of the library and its lumped
// masses, against exact solutions of linear elasticity; and the same frequency in a run.
#include <map>

#include <tactoid/contact/surface.hpp>
#include <tactoid/geometry/ball.hpp>
#include <tactoid/geometry/box.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/rkpm.hpp>
#include <tactoid/material/modified_mooney_rivlin.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/simulation/all.hpp>

#include "elastic_modes.hpp"
#include "studies.hpp"

namespace tactoid::verification {
namespace vibration_study {
namespace {

constexpr double pi = std::numbers::pi;
const ModifiedMooneyRivlin nucleus{};  // K/G = 148
const double shear_speed = std::sqrt(nucleus.shear_modulus() / nucleus.density);
const double bulk = nucleus.bulk_modulus(), shear = nucleus.shear_modulus();
const double poisson = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear);
const double young = 2.0 * shear * (1.0 + poisson);

auto elastic_body(PointCloud<3> cloud) {
  return Body{"body", std::move(cloud), Rkpm<3>{}, NodalCentroids{.solid_damping_time = 0.0},
              Materials{Region{"body", nucleus}}};
}
using ElasticBody = decltype(elastic_body({}));

constexpr auto nothing_held = [](const Point<3>&) { return false; };

// --- plane waves ------------------------------------------------------------------------------------------------

/// Speed of a plane wave along x in a periodic box, of `cells` cells per wave: by symmetry a sine is an exact mode, so
/// that its Rayleigh quotient is its frequency.
double plane_wave_speed(int cells, int component) {
  const double spacing = 1e-6, k = 2.0 * pi / (cells * spacing);
  const ElasticBody body = elastic_body(box(
      {.size = {cells * spacing, 4 * spacing, 4 * spacing}, .cells = {cells, 4, 4}, .periodic = {true, true, true}}));
  const StiffnessMatrix K = assemble_stiffness(body);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(K.rows());
  double mass = 0.0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const double s = std::sin(k * body.table().particle_position[i][0]);
    u[static_cast<Eigen::Index>(3 * i) + component] = s;
    mass += body.masses()[i] * s * s;
  }
  return std::sqrt(u.dot(K * u) / mass) / k;
}

void plane_waves(Report& report, Level level) {
  auto table = report.table("waves", {"cells_per_wave", "longitudinal_error", "shear_error"});
  const double longitudinal = nucleus.wave_speed();
  double last[2] = {0.0, 0.0}, before[2] = {0.0, 0.0};
  int cells = 8;
  for (; cells <= (level == Level::full ? 64 : 32); cells *= 2) {
    const double exact[2] = {longitudinal, shear_speed};
    for (int c = 0; c < 2; ++c) {
      before[c] = last[c];
      last[c] = plane_wave_speed(cells, c) / exact[c] - 1.0;
    }
    table.write(std::array{static_cast<double>(cells), last[0], last[1]});
  }
  report.compare(fmt::format("longitudinal wave, speed over sqrt((K + 4G/3)/rho), {} cells per wave", cells / 2),
                 1.0 + last[0], 1.0, 0.01, "plane wave, linear elasticity");
  report.compare(fmt::format("shear wave, speed over sqrt(G/rho), {} cells per wave", cells / 2), 1.0 + last[1], 1.0,
                 0.01, "plane wave, linear elasticity");
  report.at_least("order of the longitudinal speed", std::log2(before[0] / last[0]), 1.9, "second order");
  report.at_least("order of the shear speed", std::log2(before[1] / last[1]), 1.9, "second order");
}

// --- bars -------------------------------------------------------------------------------------------------------

PointCloud<3> bar_cloud(int across, bool clamped) {
  const double width = 2e-6;
  const Point<3> size(6.0 * width, width, width);
  return box({.size = size,
              .cells = {6 * across, across, across},
              .origin = {clamped ? 0.0 : -0.5 * size[0], -0.5 * size[1], -0.5 * size[2]}});
}

/// A kind of mode of the bar: class, number within it, name.
struct BarMode {
  std::string name;
  bool clamped;
  Parity parity;
  int number;  // 0: the lowest one that is not a rigid motion
};

const std::vector<BarMode> bar_modes{
    {"free bar, bending 1", false, {1, 1, -1}, 0},   {"free bar, bending 2", false, {-1, 1, -1}, 0},
    {"free bar, bending 3", false, {1, 1, -1}, 1},   {"free bar, longitudinal 1", false, {1, 1, 1}, 0},
    {"free bar, torsion 1", false, {-1, -1, -1}, 0}, {"clamped bar, bending 1", true, {0, 1, -1}, 0},
    {"clamped bar, bending 2", true, {0, 1, -1}, 1},
};

/// First frequency of a bar in longitudinal waves, ends free: k = π/L, with Rayleigh's and Love's correction for
/// the inertia of the lateral contraction, ω² = (E/ρ) k²/(1 + ν² r² k²), r² = (b² + h²)/12 (Love, Mathematical Theory
/// of Elasticity, 4th ed. 1927, article 278).
double love_frequency(double length, double width) {
  const double k = pi / length, r2 = width * width / 6.0;
  return k * std::sqrt(young / nucleus.density / (1.0 + poisson * poisson * r2 * k * k));
}

void bars(Report& report, Level level) {
  const std::vector<int> resolutions = level == Level::full ? std::vector{2, 3, 4, 6} : std::vector{2, 3};
  const ElasticBar exact{
      .half = {6e-6, 1e-6, 1e-6}, .lambda = bulk - 2.0 / 3.0 * shear, .mu = shear, .density = nucleus.density};
  std::vector<std::string> columns{"cells_across"};
  for (const BarMode& mode : bar_modes) columns.push_back(mode.name);
  for (std::string& column : columns) std::erase(column, ',');
  auto table = report.table("bars", columns);

  const double scale = 0.1 * pi * pi / 36.0 * shear_speed / 2e-6;
  std::vector<double> reference;
  std::map<std::pair<bool, Parity>, std::vector<double>> computed;
  for (const BarMode& mode : bar_modes) {
    ElasticBar bar = exact;
    bar.clamped = mode.clamped;
    const std::array degrees = mode.clamped ? std::array{10, 6, 6} : std::array{13, 7, 7};
    auto& frequencies = computed[{mode.clamped, mode.parity}];
    if (frequencies.empty()) {
      frequencies = ritz_frequencies(bar, mode.parity, degrees);
      std::erase_if(frequencies, [&](double f) { return f < scale; });
    }
    reference.push_back(frequencies[static_cast<std::size_t>(mode.number)]);
  }
  report.compare("Ritz against Love: free bar, longitudinal 1, rad/s", reference[3], love_frequency(12e-6, 2e-6), 2e-3,
                 "Love 1927, article 278: the reference is right");

  std::vector<std::vector<double>> errors;
  for (const int across : resolutions) {
    std::vector<double>& row = errors.emplace_back();
    for (const bool clamped : {false, true}) {
      const ElasticBody body = elastic_body(bar_cloud(across, clamped));
      const StiffnessMatrix K = assemble_stiffness(body);
      std::map<Parity, std::vector<double>> found;
      for (std::size_t m = 0; m < bar_modes.size(); ++m) {
        const BarMode& mode = bar_modes[m];
        if (mode.clamped != clamped) continue;
        auto& frequencies = found[mode.parity];
        if (frequencies.empty()) {
          const auto held = [&](const Point<3>& X) { return clamped && X[0] < 1e-9; };
          for (const Mode& one : lowest_modes(body, K, mode.parity, 4, scale, held))
            if (one.frequency > scale) frequencies.push_back(one.frequency);
        }
        row.push_back(frequencies[static_cast<std::size_t>(mode.number)] / reference[m] - 1.0);
      }
    }
    std::vector<double> line{static_cast<double>(across)};
    line.insert(line.end(), row.begin(), row.end());
    table.write(line);
    for (std::size_t m = 0; m < bar_modes.size(); ++m) {
      const std::string what = fmt::format("{}, {} cells across, over the exact frequency", bar_modes[m].name, across);
      const std::string source = "Ritz solution in three dimensions (Visscher et al. 1991)";
      // The masses are lumped at the particles, also at those on the surface, which exaggerates the inertia of rotation
      // and of free ends: free bars converge with it.
      const bool required =
          bar_modes[m].name == "clamped bar, bending 1" || bar_modes[m].name == "free bar, longitudinal 1";
      if (required && across >= 3)
        report.compare(what, 1.0 + row[m], 1.0, 0.01, source);
      else
        report.note(what, 1.0 + row[m], 1.0, source);
    }
  }
}

// --- ball -------------------------------------------------------------------------------------------------------

constexpr double ball_radius = 5e-6;

PointCloud<3> ball_cloud(int core_cells, int shells, double core) {
  return ball({.radius = ball_radius,
               .core_radius = core * ball_radius,
               .core_cells = core_cells,
               .shells = shells,
               .core_region = "body",
               .shell_region = "body"});
}

/// Real spherical harmonic, cos(mφ) for m >= 0 and sin(|m|φ) for m < 0; ∫ Y² dΩ = 1.
double spherical_harmonic(int l, int m, const Vector3& direction) {
  const auto n = static_cast<unsigned>(l), k = static_cast<unsigned>(std::abs(m));
  const double angle = std::abs(m) * std::atan2(direction[1], direction[0]);
  const double norm =
      std::sqrt((2.0 * l + 1.0) / (m == 0 ? 4.0 * pi : 2.0 * pi) * std::tgamma(n - k + 1) / std::tgamma(n + k + 1));
  return norm * std::assoc_legendre(n, k, direction[2]) * (m < 0 ? std::sin(angle) : std::cos(angle));
}

/// How many harmonics of degree l have a parity.
int harmonics_in(int l, const Parity& parity) {
  int count = 0;
  for (int m = -l; m <= l; ++m) {
    const int even = m % 2 == 0 ? 1 : -1, y = m < 0 ? -1 : 1;
    count += Parity{y * even, y, (l - m) % 2 == 0 ? 1 : -1} == parity ? 1 : 0;
  }
  return count;
}

/// Degree of a mode by the radial displacement of the surface: the share of each degree in ∫ u_r² dΩ.
struct Shape {
  int degree = 0;
  double share = 0.0;   // of that degree in the radial displacement
  double radial = 0.0;  // ∫ u_r² over ∫ |u|²: small for the toroidal modes
};
Shape shape_of(const Field& u, const PointCloud<3>& cloud, const FacetSurface<3>& surface) {
  constexpr int highest = 6;
  double radial = 0.0, all = 0.0;
  std::map<std::pair<int, int>, double> coefficient;
  for (const Index i : surface.nodes) {
    const Vector3 n = cloud.positions[i].normalized();
    const double weight = surface.nodal_area[i] / (ball_radius * ball_radius), r = u[i].head<3>().dot(n);
    radial += weight * r * r;
    all += weight * u[i].squaredNorm();
    for (int l = 0; l <= highest; ++l)
      for (int m = -l; m <= l; ++m) coefficient[{l, m}] += weight * r * spherical_harmonic(l, m, n);
  }
  std::array<double, highest + 1> power{};
  for (const auto& [lm, a] : coefficient) power[static_cast<std::size_t>(lm.first)] += a * a;
  const auto largest = std::max_element(power.begin(), power.end());
  return {static_cast<int>(largest - power.begin()), *largest / radial, radial / all};
}

/// A run that begins in a mode, with a displacement of 1e-6 of the spacing: the frequency of its amplitude a, which for
/// a pure mode obeys a(t + Δt) − 2 a(t) + a(t − Δt) = −ω² Δt² a(t) under central differences, by least squares.
double frequency_of_run(ElasticBody body, const Mode& mode, double periods) {
  double largest = 0.0;
  for (const Vector4& u : mode.shape) largest = std::max(largest, u.norm());
  for (std::size_t i = 0; i < body.size(); ++i) body.displacement[i] = 1e-12 / largest * mode.shape[i];
  StableStep stable;
  stable.calibrate(body);
  const double step = 0.5 * stable.largest_step(body, 0.0);
  Simulation simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{}, CentralDifference{.time_step = step}};
  std::vector<double> amplitude;
  const auto steps = static_cast<int>(periods * 2.0 * pi / mode.frequency / step);
  simulation.run((steps + 0.5) * step, every_steps(1, [&](auto& s) {
                   double a = 0.0;
                   const auto& b = s.template body<0>();
                   for (std::size_t i = 0; i < b.size(); ++i) a += b.masses()[i] * b.displacement[i].dot(mode.shape[i]);
                   amplitude.push_back(a);
                 }));
  double up = 0.0, down = 0.0;  // the last step is cut at the end of the run
  for (std::size_t n = 1; n + 2 < amplitude.size(); ++n) {
    up -= amplitude[n] * (amplitude[n + 1] - 2.0 * amplitude[n] + amplitude[n - 1]);
    down += amplitude[n] * amplitude[n];
  }
  return std::sqrt(up / down) / step;
}

void balls(Report& report, Level level) {
  report.compare("Lamb's equation, l = 2, nu = 1/4: c_t k a", lamb_root(2, 0.25), 0.840 * pi, 1e-3,
                 "Love 1927, article 196: 0.840 pi");
  report.compare("Lamb's equation, l = 2, nu = 1/2: c_t k a", lamb_root(2, 0.499999), 0.848 * pi, 1e-3,
                 "Love 1927, article 196: 0.848 pi");

  struct Grid {
    int core_cells, shells;
    double core;  // radius of the core, of the ball's: the paper's two nuclei
  };
  const std::vector<Grid> grids = level == Level::full
                                      ? std::vector<Grid>{{6, 3, 0.618}, {10, 5, 0.618}, {14, 7, 0.618}, {10, 5, 0.382}}
                                      : std::vector<Grid>{{6, 3, 0.618}, {10, 5, 0.618}, {10, 5, 0.382}};
  // The classes, with how many more there are by an exchange of the axes.
  struct Class {
    Parity parity;
    int copies;
  };
  const std::array classes{Class{{1, 1, 1}, 1}, Class{{1, -1, -1}, 3}, Class{{-1, -1, -1}, 1}, Class{{-1, 1, 1}, 3}};
  auto table = report.table(
      "ball", {"particles", "spacing_m", "l2_error", "l3_error", "l4_error", "l2_spread", "l3_spread", "l4_spread"});
  std::vector<std::array<double, 3>> errors;
  for (const Grid& grid : grids) {
    const ElasticBody body = elastic_body(ball_cloud(grid.core_cells, grid.shells, grid.core));
    const double content = volume(body.cloud());
    const double radius = std::cbrt(0.75 * content / pi);  // of the ball with the volume of the polyhedron
    const FacetSurface<3> surface(body.cloud());
    const StiffnessMatrix K = assemble_stiffness(body);
    const bool paper = grid.core_cells == 10;
    const int highest = level == Level::full || !paper ? 4 : 2;
    std::array<std::vector<double>, 5> found;
    double purity = 1.0;
    for (const Class& one : classes) {
      int wanted = 0;
      for (int l = 2; l <= highest; ++l) wanted += harmonics_in(l, one.parity);
      if (wanted == 0) continue;
      const std::vector<Mode> modes =
          lowest_modes(body, K, one.parity, highest == 2 ? 4 : 12, 0.5 * shear_speed / radius, nothing_held);
      std::array<int, 5> count{};
      for (const Mode& mode : modes) {
        if (mode.frequency < 0.5 * shear_speed / radius) continue;  // rigid
        const Shape shape = shape_of(mode.shape, body.cloud(), surface);
        const auto l = static_cast<std::size_t>(shape.degree);
        if (shape.radial < 0.1 || l < 2 || l > static_cast<std::size_t>(highest) ||
            count[l] == harmonics_in(shape.degree, one.parity))
          continue;
        ++count[l];
        found[l].insert(found[l].end(), static_cast<std::size_t>(one.copies), mode.frequency);
        if (l == 2) purity = std::min(purity, shape.share);
        if (l == 2 && one.parity == Parity{1, 1, 1} && count[l] == 1 && (paper == (level == Level::full)) &&
            grid.core > 0.5) {
          report.compare(
              fmt::format("ball of {} particles, l = 2: frequency of a run over that of the mode", body.size()),
              frequency_of_run(body, mode, 2.0) / mode.frequency, 1.0, 1e-4, "eigenvalue of K u = w^2 M u");
        }
      }
    }
    std::array<double, 3> spread{};
    auto& error = errors.emplace_back();
    error.fill(std::numeric_limits<double>::quiet_NaN());
    spread.fill(std::numeric_limits<double>::quiet_NaN());
    for (int l = 2; l <= highest; ++l) {
      const auto& f = found[static_cast<std::size_t>(l)];
      if (f.size() != static_cast<std::size_t>(2 * l + 1))
        throw ComputationError(fmt::format("{} of the {} modes with l = {} were found.", f.size(), 2 * l + 1, l));
      const double exact = lamb_root(l, poisson) * shear_speed / radius;
      double mean = 0.0;
      for (const double one : f) mean += one / exact / (2 * l + 1);
      const auto k = static_cast<std::size_t>(l - 2);
      error[k] = mean - 1.0;
      spread[k] = (*std::max_element(f.begin(), f.end()) - *std::min_element(f.begin(), f.end())) / exact;
      const std::string what = fmt::format("ball of {} particles, core {} R, l = {}: mean of {} modes over Lamb's",
                                           body.size(), grid.core, l, 2 * l + 1);
      if (l == 2 && body.size() >= 4341) {
        report.compare(what, mean, 1.0, 0.01, "Lamb 1882, radius of the polyhedron's volume");
        for (const double extreme : {*std::min_element(f.begin(), f.end()), *std::max_element(f.begin(), f.end())})
          report.compare("... its lowest and its highest", extreme / exact, 1.0, 0.01, "the same");
        report.at_least("share of l = 2 in the radial displacement of these modes", purity, 0.99,
                        "spherical harmonics");
      } else {
        report.note(what, mean, 1.0, "Lamb 1882, radius of the polyhedron's volume");
      }
    }
    table.write(std::array{static_cast<double>(body.size()), std::cbrt(content / static_cast<double>(body.size())),
                           error[0], error[1], error[2], spread[0], spread[1], spread[2]});
  }
  if (level == Level::fast) return;
  for (int l = 2; l <= 4; ++l) {
    const auto k = static_cast<std::size_t>(l - 2);
    const double order = std::log(std::abs(errors[0][k] / errors[2][k])) / std::log(std::cbrt(11621.0 / 997.0));
    report.at_least(fmt::format("ball, l = {}: order of the frequency, 997 to 11621 particles", l), order, 1.5,
                    "converging");
  }
}

}  // namespace
}  // namespace vibration_study

void vibration(Report& report, Level level) {
  using namespace vibration_study;
  plane_waves(report, level);
  bars(report, level);
  balls(report, level);
}

}  // namespace tactoid::verification
