// A drop: static (Laplace), oscillating (Rayleigh, Lamb), overdamped; forces of its surface at a general shape.
#include <cmath>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include <Eigen/Dense>

#include <tactoid/boundary/curvature_surface_tension.hpp>
#include <tactoid/boundary/surface_tension.hpp>
#include <tactoid/director/director_field.hpp>
#include <tactoid/geometry/ball.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/integrator/implicit_dynamics.hpp>
#include <tactoid/kernel/rkpm.hpp>
#include <tactoid/material/nematic_gel.hpp>
#include <tactoid/material/regions.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/simulation/implicit_problem.hpp>
#include <tactoid/simulation/simulation.hpp>

#include "drop_modes.hpp"
#include "fields_at_rest.hpp"
#include "studies.hpp"

namespace tactoid::verification {
namespace drop_study {
namespace {

constexpr double density = 1000.0;

/// A ball of gel without activity, held together by its surface.
struct Drop {
  double radius = 5e-6;          ///< R, of the sphere that the surface particles lie on, m
  double tension = 0.072e-3;     ///< σ₀, N/m
  double viscosity = 0.003;      ///< μ, Pa s
  double stiffness = 1000.0;     ///< K over the Laplace pressure 2σ₀/R: changes of volume are a thousandth
  double pressure = 1.0;         ///< reference pressure over 2σ₀/R
  double fluid_modulus = 5.0;    ///< of NodalCentroids, Pa
  int core_cells = 10, shells = 5;
  double elongation = 0.0;  ///< of the axis z at the start, at constant volume

  [[nodiscard]] double laplace() const { return 2.0 * tension / radius; }
  [[nodiscard]] double capillary_time() const { return std::sqrt(density * radius * radius * radius / tension); }
  [[nodiscard]] double ohnesorge() const { return viscosity / std::sqrt(density * tension * radius); }
};

template <class Tension, class Integrator = CentralDifference>
[[nodiscard]] auto suspend(const Drop& drop, const Integrator& integrator = {}) {
  PointCloud<3> cloud = ball({.radius = drop.radius,
                              .core_radius = 0.5 * drop.radius,
                              .core_cells = drop.core_cells,
                              .shells = drop.shells,
                              .core_region = "drop",
                              .shell_region = "drop"});
  const NematicGel<> gel{.density = density,
                         .viscosity = drop.viscosity,
                         .bulk_modulus = drop.stiffness * drop.laplace(),
                         .reference_pressure = drop.pressure * drop.laplace(),
                         .director_elasticity = 0.0,
                         .activity = 0.0};
  Body body{"drop",
            std::move(cloud),
            Rkpm<3>{},
            NodalCentroids{.fluid_modulus = drop.fluid_modulus},
            Materials{Region{"drop", gel}},
            DirectorField<>{.diffusivity = 0.0},
            [](const Vector3&) { return Vector3(0.0, 0.0, 1.0); }};
  const double along = 1.0 + drop.elongation, across = 1.0 / std::sqrt(along);
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector4& X = body.table().particle_position[i];
    body.displacement[i] = Vector4((across - 1.0) * X[0], (across - 1.0) * X[1], (along - 1.0) * X[2], 0.0);
  }
  return Simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{on<0>(Tension{.tension = drop.tension})},
                    integrator};
}

/// The n = 2 part of the shape, ∫ (2z² − x² − y²) dm over its value for a small elongation: about the elongation.
template <class S>
[[nodiscard]] double elongation(const S& simulation) {
  const auto& body = simulation.template body<0>();
  double sum = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector4 &X = body.table().particle_position[i], x = X + body.displacement[i];
    sum += body.masses()[i] * (2.0 * x[2] * x[2] - x[0] * x[0] - x[1] * x[1]);
    scale += body.masses()[i] * (4.0 * X[2] * X[2] + X[0] * X[0] + X[1] * X[1]);
  }
  return sum / scale;
}

struct Trace {
  std::vector<double> time, elongation;
};

template <class S>
[[nodiscard]] Trace trace(S& simulation, double end, double interval) {
  Trace t;
  simulation.run(end, every(interval, [&](auto& s) {
                   t.time.push_back(s.time());
                   t.elongation.push_back(drop_study::elongation(s));
                 }));
  return t;
}

// --- at rest -------------------------------------------------------------------------------------------------------

struct Rest {
  double pressure = 0.0;  ///< mean over the volume, Pa
  double scatter = 0.0;   ///< root mean square of the deviation from it, Pa
  double radius = 0.0;    ///< of the ball of the polyhedron's volume, m
  double speed = 0.0;     ///< largest at the end, m/s
};

template <class Tension>
[[nodiscard]] Rest rest(const Drop& drop, double end) {
  auto simulation = suspend<Tension>(drop);
  simulation.run(end);
  auto& body = simulation.template body<0>();
  const std::vector<PointSample> samples = body.sample_points();
  Rest r;
  double volume = 0.0, square = 0.0;
  for (std::size_t q = 0; q < samples.size(); ++q) {
    const double v = body.table().volume[q] * samples[q].J, p = -samples[q].cauchy.trace() / 3.0;
    volume += v;
    r.pressure += v * p;
    square += v * p * p;
  }
  r.pressure /= volume;
  r.scatter = std::sqrt(std::max(0.0, square / volume - r.pressure * r.pressure));
  r.radius = std::cbrt(0.75 * volume / std::numbers::pi);
  for (const Vector4& v : simulation.template velocity<0>()) r.speed = std::max(r.speed, v.norm());
  return r;
}

template <class Tension>
void laplace(Report& report, const std::string& name, Drop drop) {
  drop.pressure = 0.0;  // the surface has to compress the drop, by 2σ₀/(R K) = 10⁻³, until it carries the pressure
  const Rest r = rest<Tension>(drop, 20e-6);
  const double particles = std::pow(drop.core_cells + 1, 3) +
                           drop.shells * (std::pow(drop.core_cells + 1, 3) - std::pow(drop.core_cells - 1, 3));
  const std::string what =
      fmt::format("{}, {:.0f} particles, stabilisation {:g} Pa", name, particles, drop.fluid_modulus);
  report.compare("mean pressure, Pa: " + what, r.pressure, drop.laplace(), 0.01,
                 "2 sigma_0/R (Laplace), R of the surface particles");
  report.note("mean pressure, Pa, R of the volume: " + what, r.pressure, 2.0 * drop.tension / r.radius, "2 sigma_0/R");
  report.note("scatter of the pressure over its mean: " + what, r.scatter / r.pressure, 0.0, "uniform");
  report.note("largest speed at the end over sqrt(sigma_0/(rho R)): " + what,
              r.speed / std::sqrt(drop.tension / (density * drop.radius)), 0.0, "at rest");
}

// --- oscillating ---------------------------------------------------------------------------------------------------

struct Oscillation {
  double frequency = 0.0, damping = 0.0;  ///< imaginary and negative real part of the rate, 1/s
};

/// Of equidistant samples of c + e^{−γt} cos(ωt + φ): their differences obey d(t + τ) − p d(t) + q d(t − τ) = 0 with
/// p = 2 e^{−γτ} cos(ωτ) and q = e^{−2γτ}, for every t, in the sense of least squares; τ = `lag` samples.
[[nodiscard]] Oscillation oscillation(const Trace& t, std::size_t lag) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  const auto difference = [&](std::size_t i) { return t.elongation[i] - t.elongation[i - lag]; };
  for (std::size_t i = 2 * lag; i + lag < t.time.size(); ++i) {
    const Eigen::Vector2d row(difference(i), -difference(i - lag));
    normal += row * row.transpose();
    right += row * difference(i + lag);
  }
  const Eigen::Vector2d pq = normal.inverse() * right;
  const double tau = t.time[lag] - t.time[0];
  return {std::acos(0.5 * pq[0] / std::sqrt(pq[1])) / tau, -0.5 * std::log(pq[1]) / tau};
}

template <class Tension>
void oscillate(Report& report, Level level, const std::string& name, Drop drop) {
  drop.radius = 1e-3;
  drop.tension = 0.072;
  drop.viscosity = 5e-4;
  drop.elongation = 0.005;
  const double rayleigh = std::sqrt(8.0) / drop.capillary_time(), period = 2.0 * std::numbers::pi / rayleigh;
  const double lamb = 5.0 * drop.viscosity / (density * drop.radius * drop.radius);
  auto simulation = suspend<Tension>(drop);
  const Trace t = trace(simulation, (level == Level::full ? 4.0 : 2.0) * period, period / 80.0);
  const Oscillation o = oscillation(t, 20);
  const std::complex<double> exact =
      drop_mode_rate(drop.ohnesorge(), {-5.0 * drop.ohnesorge(), std::sqrt(8.0)}) / drop.capillary_time();
  const std::string what = fmt::format("{}, core {}, stabilisation {:g} Pa", name, drop.core_cells, drop.fluid_modulus);
  report.compare("n = 2 frequency, rad/s: " + what, o.frequency, rayleigh, 0.03,
                 "sqrt(8 sigma_0/(rho R^3)) (Rayleigh 1879)");
  // The curvature policy is the gradient of no energy: what it gives to the motion is of the size of this small
  // damping.
  if constexpr (std::is_same_v<Tension, SurfaceTension>)
    report.compare("n = 2 damping, 1/s: " + what, o.damping, lamb, 0.03, "5 nu/R^2 (Lamb)");
  else
    report.note("n = 2 damping, 1/s: " + what, o.damping, lamb, "5 nu/R^2 (Lamb); not a gradient of an energy");
  report.note("frequency of the normal mode: " + what, o.frequency, exact.imag(), "Chandrasekhar 1959, Oh = 0.0019");
  report.note("damping of the normal mode: " + what, o.damping, -exact.real(), "Chandrasekhar 1959, Oh = 0.0019");
  HistoryWriter table =
      report.table(fmt::format("oscillation_{}_{:g}", name, drop.fluid_modulus), {"time", "elongation", "theory"});
  for (std::size_t i = 0; i < t.time.size(); ++i)
    table.write(std::array{t.time[i], t.elongation[i],
                           t.elongation[0] * std::exp(exact.real() * t.time[i]) * std::cos(exact.imag() * t.time[i])});
}

// --- overdamped ----------------------------------------------------------------------------------------------------

template <class Tension>
void relax(Report& report, Level level, const std::string& name, Drop drop, bool required) {
  drop.elongation = 0.02;
  const double stokes = 20.0 / 19.0 * drop.tension / (drop.viscosity * drop.radius);
  auto simulation = suspend<Tension>(drop);
  const double viscous = density * drop.radius * drop.radius / drop.viscosity;  // 8 µs
  const Trace t = trace(simulation, viscous + (level == Level::full ? 0.25 : 0.05) / stokes, viscous / 4.0);
  // From one viscous time on, when the flow is that of Stokes.
  const std::size_t first = 4, last = t.time.size() - 1;
  const double rate = std::log(t.elongation[first] / t.elongation[last]) / (t.time[last] - t.time[first]);
  const double exact =
      -drop_mode_rate(drop.ohnesorge(), -20.0 / 19.0 / drop.ohnesorge()).real() / drop.capillary_time();
  const std::string what = fmt::format("{}, core {}, stabilisation {:g} Pa", name, drop.core_cells, drop.fluid_modulus);
  if (required)
    report.compare("overdamped rate, 1/s: " + what, rate, stokes, 0.03, "(20/19) sigma_0/(mu R)");
  else
    report.note("overdamped rate, 1/s: " + what, rate, stokes, "(20/19) sigma_0/(mu R); the stabilisation holds back");
  report.note("overdamped rate of the normal mode: " + what, rate, exact, "Chandrasekhar 1959, Oh = 5");
  HistoryWriter table =
      report.table(fmt::format("relaxation_{}_{:g}", name, drop.fluid_modulus), {"time", "elongation", "theory"});
  for (std::size_t i = 0; i < t.time.size(); ++i)
    table.write(
        std::array{t.time[i], t.elongation[i], t.elongation[first] * std::exp(-exact * (t.time[i] - t.time[first]))});
}

/// A drop as viscous as a cell, by implicit steps that are as long as its shape allows: 10⁵ to 10⁶ explicit ones.
void creep(Report& report, Drop drop) {
  drop.viscosity = 10.0;
  drop.elongation = 0.02;
  const double stokes = 20.0 / 19.0 * drop.tension / (drop.viscosity * drop.radius);
  auto simulation = suspend<SurfaceTension>(drop, ImplicitDynamics{.tolerance = 1e-5, .newton_tolerance = 1e-8});
  const double stable = simulation.largest_stable_time_step();
  simulation.run(0.2 / stokes);
  const double start = elongation(simulation);
  simulation.run(1.2 / stokes);
  const double rate = std::log(start / elongation(simulation)) * stokes;
  const std::string what = fmt::format("implicit steps, core {}, stabilisation {:g} Pa", drop.core_cells, drop.fluid_modulus);
  report.compare("overdamped rate of a drop of 10 Pa s, 1/s: " + what, rate, stokes, 0.03, "(20/19) sigma_0/(mu R)");
  report.at_most("energy error: " + what, simulation.ledger().error(), 0.02, "zero for exact integration in time");
  const ImplicitReport& r = simulation.integrator().report();
  report.note("steps: " + what, static_cast<double>(r.steps), simulation.time() / stable,
              fmt::format("explicit ones; {} iterations of Newton, {} of GMRES, {} factorisations", r.newton_iterations, r.linear_iterations, r.factorizations));
}

// --- forces of the surface -------------------------------------------------------------------------------------------

/// Largest of net force and torque (over R) of the surface of a drop deformed at random, over the sum of |f|.
template <class Tension>
[[nodiscard]] double imbalance(int core_cells, int shells) {
  const Drop drop;
  const PointCloud<3> cloud =
      ball({.radius = drop.radius, .core_radius = 0.5 * drop.radius, .core_cells = core_cells, .shells = shells});
  FieldsAtRest fields(cloud);
  for (Vector4& x : fields.position) {
    const Vector4 s = x / drop.radius;
    x += drop.radius * Vector4(0.15 * std::sin(2.0 * s[1] + 0.3) + 0.1 * s[0] * s[2], 0.2 * s[0] * s[0] - 0.1 * s[2],
                               0.2 * std::cos(1.5 * s[0] - s[1]), 0.0);
  }
  Tension term{.tension = drop.tension};
  term.initialize(cloud, fields.view());
  term.apply(fields.view(), 0.0);
  Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
  double sum = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3 f = fields.force[i].head<3>(), x = fields.position[i].head<3>();
    force += f;
    torque += x.cross(f) / drop.radius;
    sum += f.norm();
  }
  return std::max(force.norm(), torque.norm()) / sum;
}

}  // namespace
}  // namespace drop_study

void drop(Report& report, Level level) {
  using namespace drop_study;
  report.at_most("net force and torque of the variational tension, deformed drop, over the sum of the forces",
                 imbalance<SurfaceTension>(10, 5), 1e-13, "zero: the area does not change with a rigid motion");
  const double coarse = imbalance<CurvatureSurfaceTension>(6, 3), fine = imbalance<CurvatureSurfaceTension>(12, 6);
  report.note("net force and torque of the tension by curvature, core 12", fine, 0.0, "not exactly conservative");
  report.at_least("order of these in the spacing, core 6 to 12", std::log2(coarse / fine), 1.5,
                  "2 for bilinear facets");

  // The stabilisation is tied to the reference shape. That of the spreading examples is a sixth of the Laplace pressure;
  // the default of the rule, 17 times that pressure, holds a drop of little viscosity together, and slows relaxation down.
  Drop d;
  const double soft = d.fluid_modulus, stiff = NodalCentroids{}.fluid_modulus;
  laplace<SurfaceTension>(report, "variational", d);
  laplace<CurvatureSurfaceTension>(report, "curvature", d);
  if (level == Level::full) {
    for (const double modulus : {0.0, stiff}) {
      d.fluid_modulus = modulus;
      laplace<SurfaceTension>(report, "variational", d);
      laplace<CurvatureSurfaceTension>(report, "curvature", d);
    }
  }
  if (level == Level::fast) d.core_cells = 6, d.shells = 3;
  d.fluid_modulus = stiff;
  oscillate<SurfaceTension>(report, level, "variational", d);
  if (level == Level::full) oscillate<CurvatureSurfaceTension>(report, level, "curvature", d);
  d.fluid_modulus = soft;
  relax<SurfaceTension>(report, level, "variational", d, true);
  relax<CurvatureSurfaceTension>(report, level, "curvature", d, true);
  d.fluid_modulus = stiff;
  relax<SurfaceTension>(report, level, "variational", d, false);
  d.fluid_modulus = 0.1 * soft;
  d.core_cells = level == Level::full ? 6 : 4, d.shells = level == Level::full ? 3 : 2;
  creep(report, d);
}

}  // namespace tactoid::verification
