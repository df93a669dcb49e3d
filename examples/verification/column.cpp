// The twisting column: C. H. Lee, A. J. Gil, J. Bonet, Comput. Struct. 2013, 118, 13; M. Aguirre, A. J. Gil, J. Bonet,
// A. Arranz Carreño, J. Comput. Phys. 2014, 259, 672. A column of 6 x 1 x 1 m stands on a fixed base and starts with
// the angular velocity Ω₀ sin(π X/12 m) about its axis, Ω₀ = 105 rad/s.
#include <numbers>
#include <optional>

#include <tactoid/geometry/box.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/rkpm.hpp>
#include <tactoid/material/neo_hookean.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/simulation/all.hpp>

#include "studies.hpp"

namespace tactoid::verification {
namespace column_study {
namespace {

constexpr double duration = 0.5, interval = 2.5e-3;  // s

struct Twist {
  std::vector<double> height, angle;  // of the top, every `interval`; m, rad
  double stabilization = 0.0;         // largest share of the energy
  double alternation =
      0.0;  // largest root mean square displacement that alternates from particle to particle, spacings
  double largest_defect = 0.0;  // of the energy balance, over the energy at the start
};

/// What alternates along the axis: the fourth difference over 16 of the displacement is a for ±a, and of fourth order
/// in the spacing for a smooth field.
double alternation(const Field& u, const std::vector<Index>& grid, int across) {
  const auto n = static_cast<std::size_t>(across + 1), layers = static_cast<std::size_t>(6 * across + 1),
             stride = n * n;
  double sum = 0.0;
  for (std::size_t k = 2; k + 2 < layers; ++k)
    for (std::size_t c = 0; c < stride; ++c) {
      const auto at = [&](std::size_t layer) { return u[grid[layer * stride + c]]; };
      sum += (0.0625 * (at(k - 2) - 4.0 * at(k - 1) + 6.0 * at(k) - 4.0 * at(k + 1) + at(k + 2))).squaredNorm();
    }
  return std::sqrt(sum / static_cast<double>((layers - 4) * stride));
}

Twist twist(Report& report, int across, bool frames) {
  const double spacing = 1.0 / across;
  PointCloud<3> cloud =
      box({.size = {1.0, 1.0, 6.0}, .cells = {across, across, 6 * across}, .origin = {-0.5, -0.5, 0.0}});
  const auto base = select(cloud, [](const Point<3>& X) { return X[2] < 1e-9; });
  const auto top = select(cloud, [](const Point<3>& X) { return X[2] > 6.0 - 1e-9; });
  const auto facets = cloud.facets;
  std::vector<Index> grid(cloud.size());  // particles by layer, row and column
  for (Index i = 0; i < cloud.size(); ++i) {
    const auto place = [&](double x) { return static_cast<std::size_t>(std::lround(x / spacing)); };
    const auto n = static_cast<std::size_t>(across + 1);
    const Point<3>& X = cloud.positions[i];
    grid[(place(X[2]) * n + place(X[1] + 0.5)) * n + place(X[0] + 0.5)] = i;
  }
  Body body{"column", std::move(cloud), Rkpm<3>{}, NodalCentroids{.solid_damping_time = 0.0},
            Materials{Region{"body", NeoHookean::from_young(17e6, 0.45, 1100.0)}}};
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector4& X = body.table().particle_position[i];
    const double omega = 105.0 * std::sin(std::numbers::pi * X[2] / 12.0);
    body.velocity[i] = Vector4(-omega * X[1], omega * X[0], 0.0, 0.0);
  }
  Simulation simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{on<0>(fixed(base))},
                        CentralDifference{.safety = 0.5}};
  Twist result;
  const double initial = simulation.ledger().total();
  double angle = 0.0;
  auto history = report.table(fmt::format("history_{}", across),
                              {"time_s", "height_m", "twist_rad", "kinetic_J", "strain_J", "stabilization_J"});
  std::vector<std::string> columns{"time_s"};
  for (int corner = 0; corner < 4; ++corner)
    for (const char axis : {'x', 'y', 'z'}) columns.push_back(fmt::format("{}{}_m", axis, corner));
  std::optional<HistoryWriter> shapes;
  if (frames) shapes = report.table("shapes", columns);
  simulation.run(duration, every(interval, [&](auto& s) {
                   const Field& u = s.template body<0>().displacement;
                   const auto& X = s.template body<0>().table().particle_position;
                   double height = 0.0, cosine = 0.0, sine = 0.0;
                   for (const Index i : top) {
                     const Vector4 x = X[i] + u[i];
                     height += x[2] / static_cast<double>(top.size());
                     cosine += X[i][0] * x[0] + X[i][1] * x[1];
                     sine += X[i][0] * x[1] - X[i][1] * x[0];
                   }
                   const double turned = std::atan2(sine, cosine);
                   angle += std::remainder(turned - angle, 2.0 * std::numbers::pi);
                   result.height.push_back(height);
                   result.angle.push_back(angle);
                   const EnergyLedger& e = s.ledger();
                   result.stabilization = std::max(result.stabilization, e.stabilization / initial);
                   result.alternation = std::max(result.alternation, alternation(u, grid, across) / spacing);
                   result.largest_defect = std::max(result.largest_defect, std::abs(e.defect()) / initial);
                   history.write(std::array{s.time(), height, angle, e.kinetic, e.strain, e.stabilization});
                   const auto frame = static_cast<long>(std::lround(s.time() / interval));
                   if (!shapes || frame % 10 != 0 || frame > 120) return;
                   for (const auto& facet : facets) {
                     std::vector<double> line{s.time()};
                     for (const Index i : facet)
                       for (int k = 0; k < 3; ++k) line.push_back((X[i] + u[i])[k]);
                     shapes->write(line);
                   }
                 }));
  return result;
}

/// Root mean square of the difference of two histories up to `until`, s.
double difference(const std::vector<double>& a, const std::vector<double>& b, double until) {
  const std::size_t n = std::min({a.size(), b.size(), static_cast<std::size_t>(std::lround(until / interval)) + 1});
  double sum = 0.0;
  for (std::size_t k = 0; k < n; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(sum / static_cast<double>(n));
}

}  // namespace
}  // namespace column_study

void column(Report& report, Level level) {
  using namespace column_study;
  const std::vector<int> resolutions = level == Level::full ? std::vector{3, 6, 12} : std::vector{3, 5, 9};
  std::vector<Twist> runs;
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (const int across : resolutions) {
    const Twist& t = runs.emplace_back(twist(report, across, across == resolutions.back()));
    const std::string at = fmt::format(", {} cells across", across);
    report.at_least("end of the run, s" + at, interval * static_cast<double>(t.height.size() - 1), duration - 1e-9,
                    "it does not break down");
    if (across >= 4)
      report.at_most("largest share of the stabilisation in the energy" + at, t.stabilization, 0.05,
                     "no zero-energy pattern");
    else
      report.note("largest share of the stabilisation in the energy" + at, t.stabilization, none,
                  "falls with the spacing");
    report.at_most("largest displacement that alternates between particles, spacings" + at, t.alternation, 0.1,
                   "no zero-energy pattern");
    report.at_most("largest change of the total energy" + at, t.largest_defect, 1e-2,
                   "conserved; over the energy at the start");
    report.note("largest twist of the top, rad" + at, *std::max_element(t.angle.begin(), t.angle.end()), none,
                "no exact solution");
    report.note("least height of the top, m" + at, *std::min_element(t.height.begin(), t.height.end()), none,
                "no exact solution");
  }
  for (const double until : {0.1, duration}) {
    const double angle[2] = {difference(runs[0].angle, runs[1].angle, until),
                             difference(runs[1].angle, runs[2].angle, until)};
    const double height[2] = {difference(runs[0].height, runs[1].height, until),
                              difference(runs[1].height, runs[2].height, until)};
    const std::string span = fmt::format(" up to {} s", until);
    report.note("twist: difference of the two finest" + span + ", rms, rad", angle[1], none, "between resolutions");
    report.note("height: difference of the two finest" + span + ", rms, m", height[1], none, "between resolutions");
    report.at_most("twist: that over the difference of the two coarsest" + span, angle[1] / angle[0], 0.7,
                   "converging");
    report.at_most("height: that over the difference of the two coarsest" + span, height[1] / height[0], 0.7,
                   "converging");
  }
}

}  // namespace tactoid::verification
