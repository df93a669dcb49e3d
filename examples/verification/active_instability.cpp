// Spontaneous flow of a contractile gel between walls along which the director is anchored: R. Voituriez, J. F. Joanny,
// J. Prost, Europhys. Lett. 2005, 70, 404, for the equations of this gel.
//
// Let h = (1, θ(y, t)) and v = (u(y, t), 0), both small. The rates give θ' = −c u,y + D θ,yy with c = ½ (corotational:
// the spin) or 1 (convected), and the shear stress is μ u,y − ζ θ. Without inertia it does not depend on y.
//   One wall free of shear: it vanishes, u,y = ζ θ/μ, and θ = sin(πy/L) grows as
//     s = −c ζ/μ − D π²/L²;     threshold |ζ_c| = π² μ D/(c L²), ζ < 0.
//   Two no-slip walls: ∫ u,y dy = 0 admits θ = sin(2πy/L): four times that threshold, s = −c ζ/μ − 4 D π²/L². (The
//   other mode of this threshold, 1 − cos(2πy/L), grows more slowly above it.)
// Inertia does not move the threshold, where nothing moves. It slows the flow u = U (1 − cos ky) by forces ρ s u, whose
// shear stress has the part 3 ρ s U/k along sin ky (one free wall, k = π/L): (1 + s/Dk²)(1 + 3 s/νk²) = ζ/ζ_c to first
// order in s/νk². With D/ν = 1/500 the rate at twice the threshold is lower by 1.2 %.
#include "studies.hpp"

#include <cmath>
#include <numbers>

#include <tactoid/director/objective_rates.hpp>

#include "driven.hpp"
#include "gel_strip.hpp"

namespace tactoid::verification {
namespace active_instability_study {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double height = 10e-6, density = 1000.0, diffusivity = 1e-7;
constexpr double viscosity = 500.0 * density * diffusivity;

enum class Walls { one_free, no_slip };

/// Threshold |ζ_c| of the Stokes limit, Pa.
[[nodiscard]] double threshold(Walls walls, double c) {
  return (walls == Walls::no_slip ? 4.0 : 1.0) * pi * pi * viscosity * diffusivity / (c * height * height);
}
/// Growth rate of the Stokes limit, 1/s.
[[nodiscard]] double stokes_rate(Walls walls, double c, double zeta) {
  return -c * zeta / viscosity - (walls == Walls::no_slip ? 4.0 : 1.0) * pi * pi * diffusivity / (height * height);
}

struct Case {
  Walls walls;
  double activity;  // −ζ over the threshold
  int cells;
  NodalCentroids rule;
};

/// Growth rate of the mode, from its amplitude at two times after the flow has set in.
template <class Rate>
[[nodiscard]] double growth_rate(const Case& c, double coefficient) {
  const double k = (c.walls == Walls::no_slip ? 2.0 : 1.0) * pi / height;
  PlaneGel<Rate> plane{.cloud = strip(height, c.cells),
                       .gel = {.density = density,
                               .viscosity = viscosity,
                               .bulk_modulus = 2e4,
                               .reference_pressure = 0.0,
                               .director_elasticity = 0.0,
                               .activity = -c.activity * threshold(c.walls, coefficient)},
                       .field = {.diffusivity = diffusivity, .core_size = 0.5e-6},
                       .director =
                           [=](const Vector3& X) {
                             const double angle = 1e-5 * std::sin(k * X[1]);
                             return Vector3(std::cos(angle), std::sin(angle), 0.0);
                           },
                       .rule = c.rule};
  const auto lower = lower_wall(plane.cloud), upper = upper_wall(plane.cloud, height);
  plane.first = fixed(lower);
  plane.second = fixed(upper, {c.walls == Walls::no_slip, true, true});  // the free wall slips
  auto simulation = plane.simulation();
  auto& body = simulation.template body<0>();
  body.anchored.assign(body.size(), 0);
  for (const auto& wall : {lower, upper})
    for (const Index i : wall) body.anchored[i] = 1;
  const auto amplitude = [&] {
    double sum = 0.0;
    for (std::size_t i = 0; i < body.size(); ++i)
      sum += body.nodal_volumes()[i] * body.director[i][1] * std::sin(k * plane.cloud.positions[i][1]);
    return sum;
  };
  const double diffusion = 1.0 / (diffusivity * k * k);  // the flow sets in 500 times faster
  simulation.run(0.1 * diffusion);
  const double early = amplitude();
  simulation.run(0.4 * diffusion);
  return std::log(amplitude() / early) / (0.3 * diffusion);
}

/// −ζ over the expected threshold at which the growth rate changes sign: of the line through the two rates around it.
[[nodiscard]] double zero(double a, double rate_a, double b, double rate_b) {
  return a - rate_a * (b - a) / (rate_b - rate_a);
}

template <class Rate>
void study_rate(Report& report, Level level, const std::string& name, double c) {
  for (const Walls walls : {Walls::one_free, Walls::no_slip}) {
    const std::string label = name + (walls == Walls::one_free ? ", one free wall" : ", no-slip walls");
    // Around the threshold, and twice it; the rule without stabilisation, then the default one.
    const int fine = (walls == Walls::no_slip ? 24 : 16) * (level == Level::full ? 2 : 1);
    std::vector<Case> cases;
    for (const int n : {fine, fine / 2})
      for (const double activity : {0.9, 1.1, 2.0}) cases.push_back({walls, activity, n, unstabilised()});
    for (const double activity : {0.9, 1.1, 2.0}) cases.push_back({walls, activity, fine, NodalCentroids{}});
    const auto rates =
        side_by_side<double>(cases.size(), [&](std::size_t i) { return growth_rate<Rate>(cases[i], c); });
    auto table = report.table(name + (walls == Walls::one_free ? "_free" : "_no_slip"),
                              {"cells", "stabilised", "activity", "rate_per_s", "stokes_rate_per_s"});
    for (std::size_t i = 0; i < cases.size(); ++i)
      table.write(std::array{double(cases[i].cells), cases[i].rule.fluid_modulus > 0.0 ? 1.0 : 0.0, cases[i].activity,
                             rates[i], stokes_rate(walls, c, -cases[i].activity * threshold(walls, c))});
    const double expected = threshold(walls, c);
    const std::string source =
        fmt::format("(1/c) {}pi^2 mu D/L^2, Stokes limit (D/nu = 1/500)", walls == Walls::no_slip ? "4 " : "");
    const std::string rate_source = "-k^2 D - c zeta/mu, Stokes limit (D/nu = 1/500)";
    const double at = zero(0.9, rates[0], 1.1, rates[1]);
    report.compare(label + fmt::format(", {} cells: threshold, Pa", fine), at * expected, expected, 0.03, source);
    report.compare(label + fmt::format(", {} cells: growth rate at twice the threshold, 1/s", fine), rates[2],
                   stokes_rate(walls, c, -2.0 * expected), 0.05, "-k^2 D - c zeta/mu, Stokes limit (D/nu = 1/500)");
    const double coarse = zero(0.9, rates[3], 1.1, rates[4]);
    report.at_least(label + ": order of the threshold in the spacing",
                    order(std::abs(coarse - 1.0), std::abs(at - 1.0)), 1.9, "second order");
    report.compare(label + fmt::format(", {} cells, default stabilisation: threshold, Pa", fine),
                   zero(0.9, rates[6], 1.1, rates[7]) * expected, expected, 0.03, source);
    report.compare(label + fmt::format(", {} cells, default stabilisation: rate at twice it, 1/s", fine), rates[8],
                   stokes_rate(walls, c, -2.0 * expected), 0.05, rate_source);
  }
}

}  // namespace
}  // namespace active_instability_study

void active_instability(Report& report, Level level) {
  using namespace active_instability_study;
  study_rate<Corotational>(report, level, "corotational", 0.5);
  study_rate<Convected>(report, level, "convected", 1.0);
}

}  // namespace tactoid::verification
