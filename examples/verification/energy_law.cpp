// The energy law of the gel and its director when the director is carried by the plain material derivative:
//
//   d/dt ∫ [½ρv² + η(½|∇h|² + R)] + d/dt ∫ K (J − 1 − ln J) dV
//     = −∫ 2μ d:d − (ηγ/ρᵈ) ∫ |∇²h − r|² + ∫ η(½|∇h|² + R) div v + ∫ ζ h·d h
//
// F.-H. Lin, C. Liu, Commun. Pure Appl. Math. 1995, 48, 501, for ζ = 0 in an incompressible fluid; the third integral
// and K are what a compressible one adds, the last one is the power of the active stress. The density of the director
// per reference volume is constant: γ/ρᵈ = D J. Periodic squares: nothing enters through a boundary.
//
// First every term alone, for given fields, against its exact integral; then the law in motion.
#include "studies.hpp"

#include <cmath>
#include <numbers>

#include "driven.hpp"
#include "gel_strip.hpp"

namespace tactoid::verification {
namespace energy_law_study {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double length = 10e-6, K = 2.0 * pi / length;

/// Dh/Dt = relaxation: not objective, but the rate for which the energy law holds.
struct MaterialDerivative {
  template <class T>
  [[nodiscard]] static Tensor<T> rate_operator(const Tensor<T>&) {
    return Tensor<T>::Zero();
  }
};
static_assert(ObjectiveRate<MaterialDerivative>);

constexpr NematicGel<> gel{.density = 1000.0,
                           .viscosity = 0.003,
                           .bulk_modulus = 5e3,
                           .reference_pressure = 0.0,
                           .director_elasticity = 2e-10,
                           .activity = -60.0};
constexpr DirectorField<MaterialDerivative> field{.diffusivity = 1e-6, .core_size = 2e-6};

// ---- given fields -------------------------------------------------------------------------------------------------

/// Displacement, velocity and director as functions of X, with their gradients.
struct Given {
  Vector3 displacement = Vector3::Zero(), velocity = Vector3::Zero(), director = Vector3::Zero();
  PointState<double> state;
};
[[nodiscard]] Given given(const Vector3& X) {
  const double s = 0.3, V = 0.1;
  const double cx = std::cos(K * X[0]), sx = std::sin(K * X[0]), cy = std::cos(K * X[1]), sy = std::sin(K * X[1]);
  const double cxy = std::cos(K * (X[0] + X[1])), sxy = std::sin(K * (X[0] + X[1]));
  Given g;
  g.displacement = Vector3(sy + 0.5 * sx, 0.7 * sx + 0.5 * cy, 0.0) * (s / K);
  g.state.deformation_gradient << 1.0 + 0.5 * s * cx, s * cy, 0.0, 0.7 * s * cx, 1.0 - 0.5 * s * sy, 0.0, 0.0, 0.0, 1.0;
  g.velocity = Vector3(sy + 0.5 * cx, cx - 0.6 * sy + 0.3 * sxy, 0.0) * V;
  g.state.deformation_rate << -0.5 * sx, cy, 0.0, -sx + 0.3 * cxy, -0.6 * cy + 0.3 * cxy, 0.0, 0.0, 0.0, 0.0;
  g.state.deformation_rate *= V * K;
  const double angle = 0.8 * sx + 0.5 * cy, size = 1.0 + 0.2 * sy;
  const double angle_x = 0.8 * K * cx, angle_y = -0.5 * K * sy, size_y = 0.2 * K * cy;
  const double c = std::cos(angle), d = std::sin(angle);
  g.director = Vector3(size * c, size * d, 0.3 * cx);
  g.state.director = g.director;
  g.state.director_gradient << -size * d * angle_x, size_y * c - size * d * angle_y, 0.0, size * c * angle_x,
      size_y * d + size * c * angle_y, 0.0, -0.3 * K * sx, 0.0, 0.0;
  return g;
}

/// Everything that the law names at a point, per reference volume; written out here, apart from the library.
struct Densities {
  double J = 1.0, compression = 0.0, director = 0.0;  // J; J − 1 − ln J; J (½|∇h|² + R)
  // Powers that the stresses of unit K, 2μ, η and ζ give to the motion, −P : Ḟ; and ∫ (½|∇h|² + R) div v.
  double pressure = 0.0, viscous = 0.0, gradients = 0.0, active = 0.0, expansion = 0.0;
  Tensor3 flux = Tensor3::Zero();  // J ∇₀h C⁻¹
  Vector3 r = Vector3::Zero();     // (|h|² − 1) h/ε²
};
[[nodiscard]] Densities densities(const PointState<double>& state) {
  Densities e;
  const Tensor3 inverse = state.deformation_gradient.inverse();
  const Tensor3 L = state.deformation_rate * inverse, d = 0.5 * (L + L.transpose());
  const Tensor3 slope = state.director_gradient * inverse;
  const Vector3& h = state.director;
  const double excess = h.squaredNorm() - 1.0, core = field.core_size;
  const double density = 0.5 * slope.squaredNorm() + excess * excess / (4.0 * core * core);
  e.J = state.deformation_gradient.determinant();
  e.compression = e.J - 1.0 - std::log(e.J);
  e.director = e.J * density;
  e.pressure = (1.0 - e.J) * d.trace();  // J p div v of p = (1 − J)/J
  e.viscous = -e.J * d.squaredNorm();
  e.gradients = e.J * (slope.transpose() * slope * d).trace();
  e.active = e.J * h.dot(d * h);
  e.expansion = e.J * density * d.trace();
  e.flux =
      e.J * state.director_gradient * (state.deformation_gradient.transpose() * state.deformation_gradient).inverse();
  e.r = excess / (core * core) * h;
  return e;
}

/// J (∇²h − r) = Div(J ∇₀h C⁻¹) − J r at X, by differences of eighth order of the exact flux.
[[nodiscard]] Vector3 exact_relaxation(const Vector3& X) {
  constexpr std::array weights{4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
  const double step = 1e-3 * length;
  Vector3 divergence = Vector3::Zero();
  for (int k = 0; k < 2; ++k)
    for (int n = 1; n <= 4; ++n) {
      Vector3 ahead = X, behind = X;
      ahead[k] += n * step, behind[k] -= n * step;
      divergence += weights[static_cast<std::size_t>(n - 1)] / step *
                    (densities(given(ahead).state).flux.col(k) - densities(given(behind).state).flux.col(k));
    }
  const Densities here = densities(given(X).state);
  return divergence - here.J * here.r;
}

/// Mean of a function over the periodic square, exact but for round-off: the trapezoidal rule.
template <class Function>
[[nodiscard]] double mean(const Function& f) {
  constexpr int n = 64;
  double sum = 0.0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) sum += f(Vector3(length * i / n, length * j / n, 0.0));
  return sum / (n * n);
}

[[nodiscard]] PlaneGel<MaterialDerivative> square(int cells, const NematicGel<>& law) {
  return {.cloud = rectangle({.size = {length, length}, .cells = {cells, cells}, .periodic = {true, true}}),
          .gel = law,
          .field = field,
          .director = [](const Vector3& X) { return given(X).director; },
          .rule = unstabilised()};
}

/// Power per area that the internal forces of a law give to the given motion.
[[nodiscard]] double power(int cells, const NematicGel<>& law) {
  const auto plane = square(cells, law);
  Body body{"gel", plane.cloud, Rkpm<2>{}, plane.rule, Materials{Region{"body", law}}, field, plane.director};
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Given g = given(body.table().particle_position[i].head<3>());
    body.displacement[i] = pad(g.displacement);
    body.velocity[i] = pad(g.velocity);
  }
  body.add_internal_forces(0.0, false);
  double sum = 0.0;
  for (std::size_t i = 0; i < body.size(); ++i) sum += body.force[i].dot(body.velocity[i]);
  return sum / (length * length);
}

/// Rate of the director of a body that is held in the given state: rms error over the rms of the exact rate
/// D J (∇²h − r), and Σ V |Dh/Dt|²/D, which is ∫ D J² |∇²h − r|² dV.
struct Relaxation {
  double error = 0.0, dissipation = 0.0;
};
[[nodiscard]] Relaxation relaxation(int cells) {
  auto plane = square(cells, gel);
  plane.first = {everything(plane.cloud), [](const Vector3& X, double) { return given(X).displacement; }};
  const double step = 1e-12;
  plane.integrator.time_step = step;
  auto simulation = plane.simulation();
  simulation.run(step);
  const auto& body = simulation.body<0>();
  Relaxation result;
  double norm = 0.0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector3 X = body.table().particle_position[i].head<3>();
    const Vector3 rate = (body.director[i].head<3>() - given(X).director) / step;
    const Vector3 exact = field.diffusivity * exact_relaxation(X);
    result.error += (rate - exact).squaredNorm();
    norm += exact.squaredNorm();
    result.dissipation += body.nodal_volumes()[i] * rate.squaredNorm() / field.diffusivity / (length * length);
  }
  result.error = std::sqrt(result.error / norm);
  return result;
}

void study_terms(Report& report, Level level) {
  const int cells = level == Level::full ? 96 : 48;
  struct Term {
    std::string name;
    NematicGel<> with, without;  // their difference is the term
    double exact;
  };
  NematicGel<> bare = gel;
  bare.viscosity = 0.0, bare.director_elasticity = 0.0, bare.activity = 0.0;
  const auto plus = [&](double NematicGel<>::* parameter) {
    NematicGel<> law = bare;
    law.*parameter = gel.*parameter;
    return law;
  };
  NematicGel<> stiff = bare;
  stiff.bulk_modulus *= 2.0;
  const auto integral = [](double Densities::* density) {
    return mean([&](const Vector3& X) { return densities(given(X).state).*density; });
  };
  const std::array terms{
      Term{"pressure", stiff, bare, gel.bulk_modulus * integral(&Densities::pressure)},
      Term{"viscosity", plus(&NematicGel<>::viscosity), bare, 2.0 * gel.viscosity * integral(&Densities::viscous)},
      Term{"director gradients", plus(&NematicGel<>::director_elasticity), bare,
           gel.director_elasticity * integral(&Densities::gradients)},
      Term{"activity", plus(&NematicGel<>::activity), bare, gel.activity * integral(&Densities::active)}};
  for (const Term& term : terms) {
    const auto values = side_by_side<double>(2, [&](std::size_t i) {
      const int n = i == 0 ? cells : cells / 2;
      return power(n, term.with) - power(n, term.without);
    });
    report.compare(fmt::format("given fields, {} cells: power of {}, W/m^3", cells, term.name), values[0], term.exact,
                   level == Level::full ? 0.005 : 0.02, "exact integral of -P : dF/dt");
    report.at_least("order in the spacing, power of " + term.name,
                    order(std::abs(values[1] - term.exact), std::abs(values[0] - term.exact)), 1.9, "second order");
  }
  const auto rates = side_by_side<Relaxation>(2, [&](std::size_t i) { return relaxation(i == 0 ? cells : cells / 2); });
  const double exact = mean([](const Vector3& X) { return field.diffusivity * exact_relaxation(X).squaredNorm(); });
  report.at_most(fmt::format("given fields, {} cells: rms error of Dh/Dt", cells), rates[0].error,
                 level == Level::full ? 0.01 : 0.03, "D J (lap h - r) on the deformed state");
  report.at_least("order in the spacing, Dh/Dt", order(rates[1].error, rates[0].error), 1.9, "second order");
  report.compare(fmt::format("given fields, {} cells: dissipation of the director, 1/(m^2 s)", cells),
                 rates[0].dissipation, exact, level == Level::full ? 0.01 : 0.03,
                 "exact integral of D J |lap h - r|^2");
}

// ---- the law in motion --------------------------------------------------------------------------------------------

/// Energies and powers of a whole body at an instant, from its fields and the rows of its table alone.
struct Balance {
  double kinetic = 0.0, compression = 0.0, director = 0.0;                                 // J
  double viscous = 0.0, relaxation = 0.0, expansion = 0.0, active = 0.0, gradients = 0.0;  // W, as in the law
};
template <class Body>
[[nodiscard]] Balance balance(const Body& body, const Field& velocity, const NematicGel<>& law) {
  Balance b;
  const PointTable& table = body.table();
  Field rate(body.size(), Vector4::Zero());  // V (J ∇²h − J r)
  for (std::size_t q = 0; q < table.points(); ++q) {
    PointState<double> state;
    state.director = body.director[table.owner[q]].template head<3>();
    for (const TableEntry& entry : table.row(q)) {
      const Eigen::RowVector3d G(entry.gradient[0], entry.gradient[1], entry.gradient[2]);
      state.deformation_gradient += body.displacement[entry.particle].template head<3>() * G;
      state.deformation_rate += velocity[entry.particle].template head<3>() * G;
      state.director_gradient += body.director[entry.particle].template head<3>() * G;
    }
    const Densities e = densities(state);
    const double V = table.volume[q];
    b.compression += law.bulk_modulus * V * e.compression;
    b.director += law.director_elasticity * V * e.director;
    b.viscous += 2.0 * law.viscosity * V * e.viscous;
    b.expansion += law.director_elasticity * V * e.expansion;
    b.active += law.activity * V * e.active;
    for (const TableEntry& entry : table.row(q))
      rate[entry.particle].template head<3>() -=
          V * e.flux * Vector3(entry.gradient[0], entry.gradient[1], entry.gradient[2]);
    rate[table.owner[q]].template head<3>() -= V * e.J * e.r;
  }
  for (std::size_t i = 0; i < body.size(); ++i) {
    b.kinetic += 0.5 * body.masses()[i] * velocity[i].squaredNorm();
    b.relaxation -= law.director_elasticity * field.diffusivity * rate[i].squaredNorm() / body.nodal_volumes()[i];
  }
  return b;
}

/// The law over a run, at every step: energy now less that at the start less the powers in between.
struct Run {
  struct Instant {
    double time, kinetic, compression, director, dissipated;
    double defect;          // of the whole law, J/m
    double incompressible;  // of the law without K and without the term of div v
  };
  std::vector<Instant> history;
  double dilatation = 0.0;  // largest |J − 1|

  [[nodiscard]] double dissipated() const { return history.back().dissipated; }
  /// Largest value of one of the defects over the run, over what was dissipated in all.
  [[nodiscard]] double largest(double Instant::* defect) const {
    double value = 0.0;
    for (const Instant& now : history) value = std::max(value, std::abs(now.*defect));
    return value / dissipated();
  }
};
[[nodiscard]] Run motion(int cells, const NematicGel<>& law, int steps, double squeeze) {
  auto plane = square(cells, law);
  const double end = 4e-6;
  plane.integrator.time_step = end / steps;
  auto simulation = plane.simulation();
  auto& body = simulation.body<0>();
  for (std::size_t i = 0; i < body.size(); ++i) {  // `squeeze`, m/s: the part that has a divergence
    const Point<2>& X = plane.cloud.positions[i];
    body.velocity[i] =
        Vector4(0.2 * std::sin(K * X[1]) + squeeze * std::sin(K * X[0]), -0.1 * std::sin(K * X[0]), 0.0, 0.0);
  }
  simulation.evaluate();  // the viscous forces of these velocities
  Run run;
  double work = 0.0, expansion = 0.0, dissipated = 0.0, start = 0.0, start_fluid = 0.0;
  Balance last;
  simulation.run(end, every_steps(1, [&](auto& s) {
                   const Balance now = balance(body, s.template velocity<0>(), law);
                   const double fluid = now.kinetic + now.director, total = fluid + now.compression;
                   if (s.steps() == 0) {
                     start = total, start_fluid = fluid;
                   } else {
                     const double half = 0.5 * s.last_time_step();
                     const double taken = half * (last.viscous + now.viscous + last.relaxation + now.relaxation);
                     dissipated -= taken;
                     work += taken + half * (last.active + now.active);
                     expansion += half * (last.expansion + now.expansion);
                   }
                   last = now;
                   run.history.push_back({s.time(), now.kinetic, now.compression, now.director, dissipated,
                                          total - start - work - expansion, fluid - start_fluid - work});
                   if (s.steps() % 50 == 0)
                     for (const PointSample& sample : body.sample_points())
                       run.dilatation = std::max(run.dilatation, std::abs(sample.J - 1.0));
                 }));
  return run;
}

void study_motion(Report& report, Level level) {
  const int cells = level == Level::full ? 24 : 12, steps = level == Level::full ? 2000 : 1000;
  NematicGel<> soft = gel;
  soft.bulk_modulus = 1e3;
  const auto runs =
      side_by_side<Run>(2, [&](std::size_t i) { return motion(cells, soft, i == 0 ? 2 * steps : steps, 0.6); });
  const Run &fine = runs[0], &coarse = runs[1];
  auto table = report.table("history", {"time_s", "kinetic_J_per_m", "compression_J_per_m", "director_J_per_m",
                                        "dissipated_J_per_m", "defect_J_per_m"});
  double extrapolated = 0.0;  // of the two to a vanishing step
  for (std::size_t k = 0; k < coarse.history.size(); ++k) {
    const Run::Instant& now = fine.history[2 * k];
    table.write(std::array{now.time, now.kinetic, now.compression, now.director, now.dissipated, now.defect});
    extrapolated = std::max(extrapolated, std::abs(2.0 * now.defect - coarse.history[k].defect) / fine.dissipated());
  }
  const double at_fine = fine.largest(&Run::Instant::defect);
  report.at_least("compressible gel in motion: largest |J - 1|", fine.dilatation, 0.05, "K and div v must matter");
  report.at_least("the same: defect of the law without K and div v over the dissipated",
                  fine.largest(&Run::Instant::incompressible), 0.02, "K and div v must matter");
  report.at_most(fmt::format("energy law, {} steps: defect over the dissipated", 2 * steps), at_fine, 0.01,
                 "d/dt of the energy = powers (Lin, Liu 1995, and K, div v, zeta)");
  report.at_least("energy law: order in the time step", order(coarse.largest(&Run::Instant::defect), at_fine), 0.95,
                  "first order: forces see the director and the velocity of the step before");
  report.at_most("energy law, extrapolated to a vanishing step: defect over the dissipated", extrapolated, 1e-4,
                 "the same");

  // The incompressible limit: K and div v drop out of the law.
  NematicGel<> stiff = gel;
  stiff.bulk_modulus = 5e5;
  const auto limit = side_by_side<Run>(2, [&](std::size_t i) { return motion(12, stiff, i == 0 ? 4000 : 2000, 0.0); });
  const double limit_fine = limit[0].largest(&Run::Instant::incompressible);
  report.at_most("energy law without K and div v, K = 5e5 Pa, 4000 steps: defect", limit_fine, 1e-3,
                 "incompressible limit (Lin, Liu 1995), over the dissipated");
  report.at_least("the same: order in the time step",
                  order(limit[1].largest(&Run::Instant::incompressible), limit_fine), 0.95, "first order");
}

}  // namespace
}  // namespace energy_law_study

void energy_law(Report& report, Level level) {
  using namespace energy_law_study;
  study_terms(report, level);
  study_motion(report, level);
}

}  // namespace tactoid::verification
