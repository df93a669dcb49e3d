// A cantilever 10 × 1 × 1 of the nucleus material (K/G = 148) is bent by a dead load on its end until the tip is
// deflected by half its length. A formulation that locks is too stiff, the more so the coarser it is.
#include <algorithm>
#include <string>

#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/static_newton.hpp>
#include <tactoid/kernel/rkpm.hpp>
#include <tactoid/material/modified_mooney_rivlin.hpp>
#include <tactoid/quadrature/gauss_cells.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/simulation/static_problem.hpp>

#include "studies.hpp"

namespace tactoid::verification {
namespace locking_study {
namespace {

constexpr double length = 10.0, width = 1.0;  // m; the equations have no length scale

/// A dead traction (Pa per reference area) on the facets of a regular box whose centre is at x = length.
struct EndTraction {
  Vector3 traction = Vector3::Zero();
  std::vector<double> area = {};  ///< ∮ N_I dA of every particle, m²

  void initialize(const PointCloud<3>& cloud, const ParticleFields&) {
    area.assign(cloud.size(), 0.0);
    for (const auto& facet : cloud.facets) {
      const auto corners = facet_corners<3>(cloud, facet);
      Point<3> centre = Point<3>::Zero();
      for (const Point<3>& X : corners) centre += 0.25 * X;
      if (centre[0] < length - 1e-9) continue;
      const double quarter = 0.25 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
      for (const Index i : facet) area[i] += quarter;  // rectangles
    }
  }
  TermEnergy apply(const ParticleFields& body, double) {
    TermEnergy total;
    for (std::size_t i = 0; i < area.size(); ++i) {
      body.force[i].head<3>() += area[i] * traction;
      total.potential -= area[i] * traction.dot((body.position[i] - body.reference[i]).head<3>());
    }
    return total;
  }
  [[nodiscard]] double stiffness_rate(const ParticleFields&) const { return 0.0; }
};

struct Bent {
  double deflection = 0.0;   ///< of the centre of the end face, m
  double shortening = 0.0;   ///< of the same point along the bar, m
  double oscillation = 0.0;  ///< rms deviation of the pressure from its local affine fit over the rms axial stress
  int iterations = 0;
};

/// Root mean square of the deviation of the pressure at each point from the affine least-squares fit over the points
/// within 1.5 spacings, away from the ends, over that of the largest principal part of the stress.
template <class Body>
double pressure_oscillation(Body& body, double spacing) {
  const auto samples = body.sample_points();
  const PointTable& table = body.table();
  double rough = 0.0, size = 0.0;
  for (std::size_t q = 0; q < table.points(); ++q) {
    const Vector3& X = table.position[q];
    if (X[0] < 2.0 || X[0] > 8.0) continue;
    Eigen::Matrix4d moment = Eigen::Matrix4d::Zero();
    Vector4 right = Vector4::Zero();
    for (std::size_t r = 0; r < table.points(); ++r) {
      const Vector3 offset = table.position[r] - X;
      if (offset.norm() > 1.8 * spacing) continue;
      const Vector4 p(1.0, offset[0], offset[1], offset[2]);
      moment += p * p.transpose();
      right += -samples[r].cauchy.trace() / 3.0 * p;
    }
    const double fit = moment.ldlt().solve(right)[0];
    rough += table.volume[q] * std::pow(-samples[q].cauchy.trace() / 3.0 - fit, 2);
    size += table.volume[q] * samples[q].cauchy.squaredNorm();
  }
  return std::sqrt(rough / size);
}

template <class Quadrature>
Bent bend(const Quadrature& quadrature, int across, double force) {
  Body body{"cantilever",
            box({.size = {length, width, width}, .cells = {10 * across, across, across}, .origin = {0.0, -0.5, -0.5}}),
            Rkpm<3>{}, quadrature, Materials{Region{"body", ModifiedMooneyRivlin{}}}};
  const auto clamped = select(body.cloud(), [](const Point<3>& X) { return X[0] < 1e-9; });
  const auto end = select(body.cloud(), [](const Point<3>& X) { return X[0] > length - 1e-9; });
  StaticProblem problem(body, {fixed(clamped)}, EndTraction{.traction = {0.0, 0.0, force / (width * width)}});
  Bent bent;
  // A slender bar turns more than it stretches: the residual rises before it falls, so steps are not cut, and loads are
  // applied in as many parts as it takes.
  for (int steps = 8;; steps *= 2) {
    try {
      bent.iterations = StaticNewton{.tolerance = 1e-9, .load_steps = steps, .max_cuts = 0}.solve(problem).iterations;
      break;
    } catch (const ComputationError&) {
      if (steps >= 64) throw;
      std::fill(body.displacement.begin(), body.displacement.end(), Vector4::Zero());
    }
  }
  const Field u = body.at_particles(body.displacement);
  // With an odd number of cells no particle is at the centre: the mean of those nearest to it.
  double least = width;
  for (const Index i : end) least = std::min(least, body.cloud().positions[i].template tail<2>().norm());
  int nearest = 0;
  for (const Index i : end)
    if (body.cloud().positions[i].template tail<2>().norm() < least + 1e-9) {
      ++nearest;
      bent.deflection += u[i][2];
      bent.shortening -= u[i][0];
    }
  bent.deflection /= nearest;
  bent.shortening /= nearest;
  bent.oscillation = pressure_oscillation(body, width / across);
  return bent;
}

}  // namespace
}  // namespace locking_study

void locking(Report& report, Level level) {
  using namespace locking_study;
  // The elastica gives w/L = ½ for F L²/(E I) = 2.04, E = 9 K G/(3 K + G) (Bisshopp and Drucker, Q. Appl. Math. 1945,
  // 3, 272). The tip of the three-dimensional bar: an independent finite-element solution of the same equations
  // (27-node hexahedra, volumetric term at 2³ points, symmetric half) gives 4.9660, 4.9681 and 4.9739 m on 20 × 2 × 2,
  // 20 × 4 × 3 and 40 × 4 × 3 elements.
  constexpr double force = 23.3666, reference = 4.974;  // N, m
  constexpr const char* source = "27-node mixed finite elements, 40 x 4 x 3, tip load 2.04 E I/L^2";
  // The core of the paper's cell (nucleus of 3.8 to 6.2 µm, 10 cells) resolves its smallest parts by about this many.
  constexpr int paper = 4;
  const std::vector<int> resolutions = level == Level::full ? std::vector{2, 3, 4, 6} : std::vector{2, 3, 4};
  HistoryWriter table = report.table(
      "deflection", {"cells across", "deflection [m]", "shortening [m]", "pressure oscillation", "reference [m]"});
  std::vector<double> deflections;
  double at_paper = 0.0;
  for (const int across : resolutions) {
    const Bent bent = bend(NodalCentroids{}, across, force);
    deflections.push_back(bent.deflection);
    table.write(std::array{static_cast<double>(across), bent.deflection, bent.shortening, bent.oscillation, reference});
    report.note(fmt::format("tip deflection, {} cells across, m", across), bent.deflection, reference, source);
    report.note(fmt::format("pressure oscillation, {} cells across", across), bent.oscillation, std::nan(""),
                "rms distance from the local affine fit over the rms stress");
    if (across == paper) at_paper = bent.deflection;
  }
  report.compare("tip deflection at 4 cells across, m", at_paper, reference, 0.02, source);
  report.compare("tip deflection at the finest, m", deflections.back(), reference, 0.02, source);
  report.compare("tip deflection at 4 cells across over the finest", at_paper, deflections.back(), 0.02,
                 "no locking: within 2 % of the finest at the paper's spacing");
  if (level == Level::fast) return;
  HistoryWriter other = report.table("gauss", {"cells across", "deflection [m]"});
  for (const int across : {2, 3}) {
    const Bent bent = bend(GaussCells<2>{}, across, force);
    other.write(std::array{static_cast<double>(across), bent.deflection});
    report.note(fmt::format("GaussCells<2>: tip deflection, {} cells across, m", across), bent.deflection, reference,
                "true shape functions, for comparison");
  }
}

}  // namespace tactoid::verification
