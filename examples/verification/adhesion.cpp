// Adhesion and contact of a ball with a rigid plate: Derjaguin, Tabor's transition from DMT to JKR, Hertz.
#include <cmath>
#include <limits>
#include <numbers>

#include <tactoid/boundary/on_facets.hpp>
#include <tactoid/contact/ligand_receptor.hpp>
#include <tactoid/contact/repulsive_wall.hpp>
#include <tactoid/geometry/ball.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/rkpm.hpp>
#include <tactoid/material/neo_hookean.hpp>
#include <tactoid/material/regions.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/simulation/simulation.hpp>

#include "adhesive_half_space.hpp"
#include "fields_at_rest.hpp"
#include "pressed_body.hpp"
#include "studies.hpp"

namespace tactoid::verification {
namespace adhesion_study {
namespace {

constexpr double pi = std::numbers::pi;
const double unknown = std::numeric_limits<double>::quiet_NaN();

// --- a rigid sphere --------------------------------------------------------------------------------------------------
// A ring of a sphere has the area dA = 2πR dg, whatever its gap g to the plate (Archimedes): the law's traction per
// area of the sphere, along the plate's normal, sums up to F = 2πR [w(D) − w(D + 2R)] exactly, with the law's potential
// w. Derjaguin's approximation is the first part. w is N_b Φ shifted to zero at the cutoff, by 0.005 N_b σ_b at 20 ε.

/// Push of a rigid sphere on the plate in the gap D below it, N.
[[nodiscard]] double rigid_sphere_force(const PointCloud<3>& cloud, double top, double gap,
                                        const LigandReceptorLaw& law) {
  FieldsAtRest fields(cloud);
  OnRigid<LigandReceptorLaw, RigidPlane> plate{
      .law = law, .surface = {.point = Vector3(0.0, 0.0, top + gap), .normal = -Vector3::UnitZ()}};
  plate.initialize(cloud, fields.view());
  plate.apply(fields.view(), 0.0);
  return plate.force().z();
}

void derjaguin(Report& report, Level level) {
  const LigandReceptorLaw law;
  const double R = 400.0 * law.range;
  HistoryWriter table = report.table("derjaguin", {"gap_over_range", "force", "exact", "derjaguin"});
  const int fine = level == Level::full ? 16 : 12;
  std::vector<double> worst;
  for (const int cells : {fine / 2, fine}) {
    const PointCloud<3> octant =
        on_sphere(graded_octant(R, 0.75 * std::sqrt(R * law.range), cells, 1.0 + 0.8 / cells), R);
    double error = 0.0, scale = 0.0;
    for (double d = 0.2; d < 6.0; d *= 1.25) {
      const double D = d * law.range, force = 4.0 * rigid_sphere_force(octant, R, D, law);
      const double exact = 2.0 * pi * R * (law.potential(D) - law.potential(D + 2.0 * R));
      // Against the larger of this force and the strongest pull: the force changes sign near ε/√2.
      scale = std::max(std::abs(exact), 2.0 * pi * R * law.bond_density * law.binding_energy);
      error = std::max(error, std::abs(force - exact) / scale);
      const double bare = law.bond_density * law.binding_energy * (std::pow(1.0 / d, 4) - 2.0 * std::pow(1.0 / d, 2));
      if (cells == fine) table.write(std::array{d, force, exact, d < law.floor ? unknown : 2.0 * pi * R * bare});
    }
    worst.push_back(error);
  }
  report.at_most("rigid sphere, R = 400 eps: largest error over the gaps 0.2 to 6 eps", worst[1], 1e-2,
                 "2 pi R [w(D) - w(D + 2R)], exact for a traction per area of the sphere");
  report.at_least("rigid sphere: order of the error in the spacing", std::log2(worst[0] / worst[1]), 1.8,
                  "bilinear facets: 2");
  const PointCloud<3> octant = on_sphere(graded_octant(R, 0.75 * std::sqrt(R * law.range), fine, 1.0 + 0.8 / fine), R);
  report.compare("rigid sphere, R = 400 eps: pull at D = eps, N", -4.0 * rigid_sphere_force(octant, R, law.range, law),
                 2.0 * pi * R * law.bond_density * law.binding_energy, 0.01, "2 pi R N_b sigma_b (Derjaguin 1934)");
  // Towards Derjaguin's limit: with a cutoff beyond the whole sphere only its far side is left, w(D + 2R).
  for (const double ratio : {2.0, 5.0, 10.0}) {
    const LigandReceptorLaw whole{.cutoff = 1000.0};
    const double radius = ratio * whole.range;
    const PointCloud<3> sphere = ball({.radius = radius, .core_cells = 24, .shells = 0});
    const double force = -rigid_sphere_force(sphere, radius, whole.range, whole);
    const double limit = 2.0 * pi * radius * whole.bond_density * whole.binding_energy;
    const double exact =
        2.0 * pi * radius * (whole.potential(whole.range + 2.0 * radius) - whole.potential(whole.range));
    report.compare(fmt::format("rigid sphere, R = {:g} eps, all of it in reach: pull at eps over Derjaguin's", ratio),
                   force / limit, exact / limit, 1e-3, "1 - 2 (1 + 2R/eps)^-2 + (1 + 2R/eps)^-4");
  }
}

// --- elastic balls ---------------------------------------------------------------------------------------------------

constexpr double young = 10e3, poisson = 0.3, radius = 1.0;  // the statics know no scale of length

[[nodiscard]] auto octant_body(double core, int cells, double growth) {
  return Body{"ball", graded_octant(radius, core, cells, growth), Rkpm<3>{}, NodalCentroids{},
              Materials{Region{"body", NeoHookean::from_young(young, poisson)}}};
}

void tabor(Report& report, Level level) {
  const double plane_strain = young / (1.0 - poisson * poisson);
  const double range = radius / 400.0, zone = std::sqrt(radius * range);
  const int cells = level == Level::full ? 6 : 4;
  auto body = octant_body(1.5 * zone, cells, 1.0 + 0.8 / cells);
  const auto law_of = [&](double number, double part = 1.0) {
    const double work = part * std::pow(number, 1.5) * plane_strain * std::sqrt(range * range * range / radius);
    return LigandReceptorLaw{.bond_density = 1.0, .binding_energy = work, .range = range};
  };
  PressedBody pressed{body, radius, 7.5 * zone, law_of(1.0)};
  pressed.factorize();
  report.note("Tabor: unknowns of an eighth of the ball", static_cast<double>(pressed.unknowns()), unknown, "");
  HistoryWriter curve = report.table("pull_off", {"tabor", "pull_over_pi_R_W", "half_space"});
  HistoryWriter pulls = report.table("pull", {"tabor", "separation_over_range", "pull_over_pi_R_W"});
  const std::vector<double> numbers =
      level == Level::full ? std::vector{0.02, 0.1, 0.3, 0.5, 0.7, 1.0} : std::vector{0.02, 0.3, 0.7};
  double before = 2.0;
  bool falls = true;
  for (const double number : numbers) {
    const LigandReceptorLaw law = law_of(number);
    const double work = law.bond_density * law.binding_energy;
    const double start = 0.8 - 1.3 * number, step = 0.02 + 0.04 * number;
    const LigandReceptorLaw unit{.bond_density = 1.0, .binding_energy = 1.0, .range = 1.0};
    AdhesiveHalfSpace half_space([&](double H) { return unit.traction(H); }, number, 6.5 + 0.3 * number, 150);
    half_space.settle(start);
    const double reference =
        2.0 * pull_off_force([&](double H0) { return half_space.pull(H0); }, start, step, [](double, double) {});

    // The same for the ball; its bulk gives way too, which changes the separations, not the pull.
    pressed.reset();
    for (double part = 1e-3; part < 1.0; part *= part < 0.1 ? 3.0 : 1.25) {
      pressed.set_law(law_of(number, part));
      (void)pressed.solve(radius + start * range, 0.3 * range);
    }
    pressed.set_law(law);
    const double pull = pull_off_force(
        [&](double s) {
          if (!pressed.solve(radius + s * range, 0.3 * range)) return unknown;
          return -pressed.force() / (pi * radius * work);
        },
        start, step, [&](double s, double f) { pulls.write(std::array{number, s, f}); });
    const std::string what = fmt::format("pull-off over pi R W, Tabor's number {:g}", number);
    report.compare(what, pull, reference, 0.02, "paraboloid on a half-space, same law (method of Greenwood 1997)");
    if (number == numbers.front())
      report.compare("pull-off over pi R W, Tabor's number near 0", pull, 2.0, 0.02, "2 (Bradley, DMT)");
    curve.write(std::array{number, pull, reference});
    falls = falls && pull < before;
    before = pull;
  }
  report.at_least("pull-off falls from DMT (2) towards JKR (1.5) as the ball softens", falls ? 1.0 : 0.0, 1.0,
                  "Tabor 1977");
  // Beyond a number of 1 the rim of the contact is narrower than the cells of these clouds. The theory goes on to JKR.
  const LigandReceptorLaw unit{.bond_density = 1.0, .binding_energy = 1.0, .range = 1.0};
  AdhesiveHalfSpace half_space([&](double H) { return unit.traction(H); }, 3.0, 7.4, 150);
  half_space.settle(-3.1);
  report.note("pull-off over pi R W on the half-space, Tabor's number 3",
              2.0 * pull_off_force([&](double H0) { return half_space.pull(H0); }, -3.1, 0.1, [](double, double) {}),
              1.5, "JKR, for an infinite number");
}

// --- repulsion -------------------------------------------------------------------------------------------------------

/// Slows all motion down, f = −r m v, to find what is at rest.
struct Drag {
  double rate = 0.0;  ///< r, 1/s
  template <int D>
  void initialize(const PointCloud<D>&, const ParticleFields&) {}
  TermEnergy apply(const ParticleFields& body, double) {
    TermEnergy total;
    for (std::size_t i = 0; i < body.force.size(); ++i) {
      body.force[i] -= rate * body.mass[i] * body.velocity[i];
      total.dissipated_power += rate * body.mass[i] * body.velocity[i].squaredNorm();
    }
    return total;
  }
  [[nodiscard]] double stiffness_rate(const ParticleFields&) const { return 0.0; }
};

struct Press {
  double force = 0.0;     ///< on the plate, of the whole ball, N
  double depth = 0.0;     ///< of the plate, less the wall's own compliance, m
  double restless = 0.0;  ///< kinetic energy over strain energy at the end
  std::size_t particles = 0;
};

/// Presses a plate into the pole by `depth` in the dynamics of the library, with drag, and waits until all is at rest.
/// The octant's cut planes are held by symmetry: a ball between two plates. A wall of the penalty k is an elastic
/// layer: it adds dU/dF to the depth, with its energy U ~ F^{4/3} under Hertz's pressure, so (4/3) U/F.
[[nodiscard]] Press press(double depth, double core, int cells, double penalty) {
  auto body = octant_body(core, cells, 1.0 + 0.8 / cells);
  const auto is_on_sphere = [](const Point<3>& X) { return std::abs(X.norm() - radius) < 1e-9 * radius; };
  const auto plane = [&](int k) { return select(body.cloud(), [k](const Point<3>& X) { return X[k] == 0.0; }); };
  const auto x = plane(0), y = plane(1), z = plane(2);
  const double transit = radius / std::sqrt(young / 1000.0), ramp = 3.0 * transit, end = 8.0 * transit;
  // The library asks the wall for its stiffness every 20 steps only: first touches in between need a cap of the step.
  const FacetSurface<3> surface(on_sphere(body.cloud(), radius));
  double rate = 0.0;
  for (const Index i : surface.nodes) rate = std::max(rate, penalty * surface.nodal_area[i] / body.masses()[i]);
  const auto path = [=](double t) {
    const double s = std::min(1.0, t / ramp);
    return Vector3(0.0, 0.0, -depth * s * s * (3.0 - 2.0 * s));
  };
  const auto speed = [=](double t) {
    const double s = std::min(1.0, t / ramp);
    return Vector3(0.0, 0.0, -depth * 6.0 * s * (1.0 - s) / ramp);
  };
  const RigidPlane plate{.point = Vector3(0.0, 0.0, radius), .normal = -Vector3::UnitZ()};
  OnRigid<RepulsiveWall, Moving<RigidPlane>> wall{
      .law = {.penalty = penalty}, .surface = {plate, path, speed}, .points_per_direction = 3};
  Simulation simulation{Bodies{std::move(body)}, Contacts{},
                        Boundaries{on<0>(OnFacets{std::move(wall), is_on_sphere}),
                                   on<0>(Drag{.rate = 2.0 / transit}), on<0>(fixed(x, {true, false, false})),
                                   on<0>(fixed(y, {false, true, false})), on<0>(fixed(z, {false, false, true}))},
                        CentralDifference{.max_time_step = 1.0 / std::sqrt(rate)}};
  simulation.run(end);
  const double force = simulation.template boundary<0>().term.force().z();
  return {4.0 * force, depth - 4.0 / 3.0 * simulation.ledger().surface / force,
          simulation.ledger().kinetic / simulation.ledger().strain, simulation.template body<0>().size()};
}

/// Hertz: F = (4/3) E* √R δ^{3/2}. A ball between two plates, of a contact radius of 0.022 R, is 0.52 % stiffer than
/// that: its linear elasticity in Legendre polynomials under Hertz's pressure (ν = 0.3) gives δ/δ_Hertz = 0.9965.
void hertz(Report& report, Level level) {
  const double plane_strain = young / (1.0 - poisson * poisson);
  const double depth = 5e-4 * radius, a = std::sqrt(radius * depth);
  const double peak = 2.0 * plane_strain * a / (pi * radius);
  HistoryWriter table = report.table("hertz", {"spacing_over_contact_radius", "force_over_hertz"});
  const std::vector<int> resolutions = level == Level::full ? std::vector{3, 6, 12} : std::vector{3, 5};
  std::vector<double> ratios;
  for (const int cells : resolutions) {
    const Press p = press(depth, 1.4 * a, cells, peak / (0.05 * depth));
    const double theory = 4.0 / 3.0 * plane_strain * std::sqrt(radius) * std::pow(p.depth, 1.5);
    const double spacing = 1.4 * 0.85 / cells;
    ratios.push_back(p.force / theory);
    table.write(std::array{spacing, ratios.back()});
    const std::string what =
        fmt::format("force over Hertz's at 0.05 % indentation, spacing {:.2f} a, {} particles", spacing, p.particles);
    if (cells == 12)
      report.compare(what, ratios.back(), 1.0, 0.02, "(4/3) E* R^1/2 delta^3/2 (Hertz 1882)");
    else
      report.note(what, ratios.back(), 1.0, "Hertz 1882");
    report.at_most("kinetic over strain energy when the force is read", p.restless, 1e-5, "at rest");
  }
  constexpr double whole_ball = 1.0052;
  const std::size_t last = ratios.size() - 1;
  report.at_least("order of the error of the force in the spacing",
                  std::log((whole_ball - ratios[last - 1]) / (whole_ball - ratios[last])) /
                      std::log(static_cast<double>(resolutions[last]) / resolutions[last - 1]),
                  1.0, "against the whole ball, 1.0052");
}

/// A ball compressed by 30 %: each resolution against the finest.
void compression(Report& report, Level level) {
  const double plane_strain = young / (1.0 - poisson * poisson), depth = 0.3 * radius;
  const double hertz_force = 4.0 / 3.0 * plane_strain * std::sqrt(radius) * std::pow(depth, 1.5);
  HistoryWriter table = report.table("compression", {"cells", "particles", "force_over_hertz"});
  std::vector<double> ratios;
  for (const int cells : level == Level::full ? std::vector{3, 6, 12} : std::vector{2, 4, 7}) {
    const Press p = press(depth, 0.9 * radius, cells, 10.0 * young / (0.05 * radius));
    ratios.push_back(p.force / hertz_force);
    table.write(std::array{static_cast<double>(cells), static_cast<double>(p.particles), ratios.back()});
    report.note(fmt::format("force over Hertz's at 30 % compression, {} particles in the octant", p.particles),
                ratios.back(), unknown, "Hertz is for small indentations");
  }
  const double coarse = std::abs(ratios[1] / ratios[0] - 1.0), fine = std::abs(ratios[2] / ratios[1] - 1.0);
  report.at_most("30 % compression: change of the force from the middle to the finest spacing", fine, 0.04,
                 "convergence");
  report.at_most("30 % compression: that change over the one before", fine / coarse, 0.6,
                 "convergence: 1/2 for order 1");
}

}  // namespace
}  // namespace adhesion_study

void adhesion(Report& report, Level level) {
  using namespace adhesion_study;
  derjaguin(report, level);
  tabor(report, level);
  hertz(report, level);
  compression(report, level);
}

}  // namespace tactoid::verification
