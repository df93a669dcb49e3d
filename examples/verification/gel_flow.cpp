// The gel as a fluid, against exact solutions: shear flows that start from rest, the work of a cycle of a uniform bar,
// and the stresses of the director.
#include "studies.hpp"

#include <cmath>
#include <numbers>

#include <tactoid/director/objective_rates.hpp>
#include <tactoid/geometry/jitter.hpp>
#include <tactoid/observe/reaction.hpp>

#include "driven.hpp"
#include "gel_strip.hpp"

namespace tactoid::verification {
namespace gel_flow_study {
namespace {

constexpr double pi = std::numbers::pi;

// Cytosol (ν = μ/ρ = 3e-6 m²/s) between walls at a distance H; J = 1 in a plane shear flow, so K only sets the step.
constexpr double height = 10e-6, viscosity = 0.003, density = 1000.0, nu = viscosity / density;
constexpr double diffusion_time = height * height / nu;

enum class Flow { couette, poiseuille };

// Total shear is 0.5 at the end, t = ½ H²/ν.
constexpr double wall_speed = nu / height;                           // of the upper wall in Couette's flow
constexpr double push = 2.0 * nu * nu / (height * height * height);  // N/kg in Poiseuille's
constexpr double poiseuille_speed = push * height * height / (8.0 * nu);

/// Velocity at the height y and the time t after the start from rest; G. K. Batchelor, An Introduction to Fluid
/// Dynamics, 1967, section 4.3:
///   Couette     U y/H + Σ (2U/nπ) (−1)ⁿ e^{−n²π²νt/H²} sin(nπy/H)
///   Poiseuille  g y (H − y)/(2ν) − Σ_{n odd} 4 g H²/(ν n³π³) e^{−n²π²νt/H²} sin(nπy/H)
[[nodiscard]] double exact_velocity(Flow flow, double y, double t) {
  const double eta = y / height, tau = t / diffusion_time;
  double u = flow == Flow::couette ? wall_speed * eta : push * height * height / (2.0 * nu) * eta * (1.0 - eta);
  for (int n = 1; n < 200; ++n) {
    const double mode = std::exp(-n * n * pi * pi * tau) * std::sin(n * pi * eta);
    if (flow == Flow::couette)
      u += 2.0 * wall_speed / (n * pi) * (n % 2 == 0 ? 1.0 : -1.0) * mode;
    else if (n % 2 == 1)
      u -= 4.0 * push * height * height / (nu * n * n * n * pi * pi * pi) * mode;
  }
  return u;
}

/// Shear stress at the moving wall in Couette's flow, (μU/H) (1 + 2 Σ e^{−n²π²νt/H²}).
[[nodiscard]] double exact_drag(double t) {
  double sum = 1.0;
  for (int n = 1; n < 200; ++n) sum += 2.0 * std::exp(-n * n * pi * pi * t / diffusion_time);
  return viscosity * wall_speed / height * sum;
}

constexpr std::array times{0.05, 0.1, 0.2, 0.5};  // of H²/ν

/// Root mean square of the error over the height and the `times`, over the largest speed.
struct FlowResult {
  double error = 0.0;
  std::vector<std::array<double, 4>> profile;  // t, y, u, exact u
  double drag = 0.0, drag_exact = 0.0;         // of the moving wall at the end, Pa
  double dilatation = 0.0;                     // largest |J − 1|
};

[[nodiscard]] FlowResult start_from_rest(Flow flow, int cells, const NodalCentroids& rule) {
  PlaneGel<Corotational> plane{.cloud = strip(height, cells),
                               .gel = {.density = density,
                                       .viscosity = viscosity,
                                       .bulk_modulus = 5e3,
                                       .reference_pressure = 0.0,
                                       .director_elasticity = 0.0,
                                       .activity = 0.0},
                               .field = {.diffusivity = 0.0},
                               .rule = rule};
  plane.first = fixed(lower_wall(plane.cloud));
  plane.second = {upper_wall(plane.cloud, height), [=](const Vector3&, double t) {
                    return Vector3(flow == Flow::couette ? wall_speed * t : 0.0, 0.0, 0.0);
                  }};
  if (flow == Flow::poiseuille) plane.acceleration = Vector3(push, 0.0, 0.0);
  auto simulation = plane.simulation();
  FlowResult result;
  double sum = 0.0, count = 0.0;
  for (const double time : times) {
    simulation.run(time * diffusion_time);
    const Field v = simulation.velocity<0>();
    for (std::size_t i = 0; i < v.size(); ++i) {
      const Point<2>& X = plane.cloud.positions[i];
      const double exact = exact_velocity(flow, X[1], simulation.time());
      sum += (v[i].head<3>() - Vector3(exact, 0.0, 0.0)).squaredNorm();
      count += 1.0;
      if (X[0] == 0.0) result.profile.push_back({simulation.time(), X[1], v[i][0], exact});
    }
  }
  result.error = std::sqrt(sum / count) / (flow == Flow::couette ? wall_speed : poiseuille_speed);
  result.drag = reactions<0>(simulation).conditions[1][0] / plane.cloud.period[0];
  result.drag_exact = exact_drag(simulation.time() - simulation.last_time_step());
  for (const PointSample& sample : simulation.body<0>().sample_points())
    result.dilatation = std::max(result.dilatation, std::abs(sample.J - 1.0));
  return result;
}

void study_start(Report& report, Level level, Flow flow) {
  const std::string name = flow == Flow::couette ? "Couette" : "Poiseuille";
  const std::vector<int> cells = level == Level::full ? std::vector{16, 32, 64} : std::vector{12, 24};
  // The finest first: cases are shared between two threads.
  const auto cases = side_by_side<FlowResult>(2 * cells.size(), [&](std::size_t i) {
    return start_from_rest(flow, cells[cells.size() - 1 - i / 2], i % 2 == 0 ? unstabilised() : NodalCentroids{});
  });
  const auto at = [&](std::size_t k, bool stabilised) -> const FlowResult& {
    return cases[2 * (cells.size() - 1 - k) + (stabilised ? 1 : 0)];
  };
  auto table = report.table(name + "_convergence", {"cells", "error", "error_stabilised"});
  for (std::size_t k = 0; k < cells.size(); ++k)
    table.write(std::array{double(cells[k]), at(k, false).error, at(k, true).error});
  auto profile = report.table(name + "_profile", {"time_s", "y_m", "u_m_per_s", "exact_m_per_s"});
  for (const auto& line : at(0, true).profile) profile.write(line);

  const std::size_t last = cells.size() - 1;
  const std::string source = "Fourier solution (Batchelor 1967)";
  const double limit = level == Level::full ? 1e-3 : 4e-3;  // of the largest speed; a quarter for half the spacing
  report.at_most(name + fmt::format(" from rest, {} cells, rms error of the velocity", cells[last]),
                 at(last, false).error, limit, source);
  report.at_least(name + " from rest, order in the spacing", order(at(last - 1, false).error, at(last, false).error),
                  1.9, source);
  report.at_most(name + fmt::format(" from rest, {} cells, default stabilisation, rms error", cells[last]),
                 at(last, true).error, limit, source);
  report.at_least(name + " from rest, order in the spacing, default stabilisation",
                  order(at(last - 1, true).error, at(last, true).error), 1.9, source);
  report.at_most(name + " from rest, largest |J - 1|", at(last, true).dilatation, 1e-10,
                 "plane shear keeps the volume");
  if (flow == Flow::couette)
    report.compare("Couette, drag of the wall at the end, Pa", at(last, true).drag, at(last, true).drag_exact, 1e-3,
                   source);
}

/// A square of gel whose every particle follows F(t); its right side and the rest are the two motions.
[[nodiscard]] PlaneGel<Corotational> driven_square(const std::function<Tensor3(double)>& F, const NematicGel<>& gel) {
  const double edge = 10e-6;
  PlaneGel<Corotational> plane{.cloud = jitter(rectangle({.size = {edge, edge}, .cells = {3, 3}}), 0.2),
                               .gel = gel,
                               .field = {.diffusivity = 0.0}};
  const auto is_right = [=](const Point<2>& X) { return X[0] > edge * (1.0 - 1e-9); };
  plane.first = affine(select(plane.cloud, is_right), F);
  plane.second = affine(select(plane.cloud, [&](const Point<2>& X) { return !is_right(X); }), F);
  return plane;
}

/// F = 1 + e sin ωt along x: the viscous stress is 2 μ e ω cos ωt/(1 + e sin ωt), so that
///   work per cycle and reference volume  ∮ 2μ Ḟ²/F dt = 4πμω (1 − √(1 − e²)),   peak stress  2μωe/√(1 − e²).
void study_cycle(Report& report) {
  const double e = 0.5, omega = 2.0 * pi / 1e-4, period = 2.0 * pi / omega, edge = 10e-6;
  const NematicGel<> gel{.density = density,
                         .viscosity = viscosity,
                         .bulk_modulus = 500.0,
                         .reference_pressure = 0.0,
                         .director_elasticity = 0.0,
                         .activity = 0.0};
  const auto F = [=](double t) {
    Tensor3 f = Tensor3::Identity();
    f(0, 0) += e * std::sin(omega * t);
    return f;
  };
  struct Cycle {
    double work, dissipated, peak;
  };
  const auto cycle = [&](int steps) {
    PlaneGel<Corotational> plane = driven_square(F, gel);
    plane.integrator.time_step = period / steps;
    auto simulation = plane.simulation();
    simulation.run(period);
    const EnergyLedger before = simulation.ledger();
    double peak = 0.0;
    simulation.run(2.0 * period, every_steps(1, [&](auto& s) {
                     const double J = F(s.time())(0, 0);
                     for (const PointSample& sample : s.template body<0>().sample_points())
                       peak = std::max(peak, sample.cauchy(0, 0) + gel.pressure(J));
                   }));
    const EnergyLedger& after = simulation.ledger();
    return Cycle{(after.external_work - before.external_work) / (edge * edge),
                 (after.dissipated - before.dissipated) / (edge * edge), peak};
  };
  const double work = 4.0 * pi * viscosity * omega * (1.0 - std::sqrt(1.0 - e * e));
  const double peak = 2.0 * viscosity * omega * e / std::sqrt(1.0 - e * e);
  const Cycle coarse = cycle(1000), fine = cycle(4000);
  report.compare("work of a cycle of a bar, e = 0.5, reactions, Pa", fine.work, work, 1e-4,
                 "4 pi mu omega (1 - sqrt(1 - e^2))");
  report.compare("dissipation of a cycle of a bar, e = 0.5, Pa", fine.dissipated, work, 1e-4, "the same");
  report.at_least("order in the time step of the work",
                  order(std::abs(coarse.work - work), std::abs(fine.work - work), 4.0), 1.9,
                  "second order over a cycle");
  report.compare("peak viscous stress of the bar, Pa", fine.peak, peak, 1e-3, "2 mu omega e / sqrt(1 - e^2)");
  report.at_least("order in the time step of the peak stress",
                  order(std::abs(coarse.peak - peak), std::abs(fine.peak - peak), 4.0), 0.95,
                  "first order: viscosity sees the velocity half a step late");
}

/// Stresses of a body at rest with h = (0.8, 0.1 + a X, 0.2 + b Y) or h = (0.8, 0.1, 0.2), computed by hand.
void study_director_stress(Report& report) {
  const double a = 2e4, b = -3e4, eta = 2e-8, zeta = -40.0, K = 500.0;
  const NematicGel<> gel{.density = density,
                         .viscosity = viscosity,
                         .bulk_modulus = K,
                         .reference_pressure = 5.0,
                         .director_elasticity = eta,
                         .activity = zeta};
  // F = (2 1; 0 1): J = 2, F⁻¹ = (½ −½; 0 1), cof F = (1 0; −1 2); 1 along z. p = 5 + K (1 − 2)/2.
  Tensor3 F1 = Tensor3::Identity();
  F1(0, 0) = 2.0, F1(0, 1) = 1.0;
  for (const bool deformed : {false, true}) {
    const Tensor3 F = deformed ? F1 : Tensor3(Tensor3::Identity());
    const double p = deformed ? 5.0 - 0.5 * K : 5.0;
    // ∇h has the rows (0 0), (a 0) F⁻¹ and (0 b) F⁻¹: deformed (a/2 −a/2), (0 b).
    Tensor3 gradients = Tensor3::Zero();  // (∇h)ᵀ∇h
    if (deformed) {
      gradients(0, 0) = 0.25 * a * a, gradients(0, 1) = gradients(1, 0) = -0.25 * a * a;
      gradients(1, 1) = 0.25 * a * a + b * b;
    } else {
      gradients(0, 0) = a * a, gradients(1, 1) = b * b;
    }
    const std::string state = deformed ? "deformed, J = 2" : "undeformed";
    const auto run = [&](const DirectorFunction& h) {
      PlaneGel<Corotational> plane = driven_square([=](double) { return F; }, gel);
      plane.director = h;
      return plane.simulation();
    };
    const DirectorFunction linear = [=](const Vector3& X) { return Vector3(0.8, 0.1 + a * X[0], 0.2 + b * X[1]); };
    auto simulation = run(linear);
    double worst = 0.0;
    auto& body = simulation.body<0>();
    const auto samples = body.sample_points();
    for (std::size_t q = 0; q < samples.size(); ++q) {
      const Vector3 h = linear(body.table().particle_position[body.table().owner[q]].head<3>());
      const Tensor3 exact = -p * Tensor3::Identity() - eta * gradients - zeta * h * h.transpose();
      worst = std::max(worst, (samples[q].cauchy - exact).norm() / (eta * gradients).norm());
    }
    report.at_most("stress of a linear director, " + state + ", error over eta (grad h)^2", worst, 1e-10,
                   "-p - eta (grad h)^T grad h - zeta h h, by hand");

    // Uniform director: traction P e_x of the right side, P = σ cof F.
    auto uniform = run([](const Vector3&) { return Vector3(0.8, 0.1, 0.2); });
    const double edge = 10e-6;
    uniform.run(1e-9);
    const Vector3 traction = reactions<0>(uniform).conditions[0] / edge;
    // −ζ h⊗h = 40 (0.64 0.08; 0.08 0.01); times cof F e_x = (1, −1) or (1, 0).
    const double xx = 25.6 - p, xy = 3.2, yy = 0.4 - p;
    const Vector3 exact = deformed ? Vector3(xx - xy, xy - yy, 0.0) : Vector3(xx, xy, 0.0);
    report.at_most("traction of a uniform director, " + state + ", error", (traction - exact).norm() / exact.norm(),
                   1e-8, "(-p - zeta h h) cof F e_x, by hand");
  }
}

}  // namespace
}  // namespace gel_flow_study

void gel_flow(Report& report, Level level) {
  using namespace gel_flow_study;
  study_start(report, level, Flow::couette);
  study_start(report, level, Flow::poiseuille);
  study_cycle(report);
  study_director_stress(report);
}

}  // namespace tactoid::verification
