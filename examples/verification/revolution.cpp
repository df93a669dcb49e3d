// Bodies of revolution in their meridian section: a thick sphere under pressure against Lamé, spheroidal modes of a ball
// against Lamb, and a ball between plates against the same ball in three dimensions.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <tactoid/boundary/on_facets.hpp>
#include <tactoid/boundary/pressure.hpp>
#include <tactoid/contact/on_rigid.hpp>
#include <tactoid/geometry/meridian.hpp>
#include <tactoid/kernel/rkpm.hpp>
#include <tactoid/material/modified_mooney_rivlin.hpp>
#include <tactoid/material/neo_hookean.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/simulation/all.hpp>

#include "common/octant.hpp"
#include "elastic_modes.hpp"
#include "studies.hpp"

namespace tactoid::verification {
namespace revolution_study {
namespace {

constexpr double pi = std::numbers::pi, radius = 5e-6;

// --- Lamé -------------------------------------------------------------------------------------------------------

/// A shell between the radii a and b (m), from pole to pole.
PointCloud<2> thick_sphere(double a, double b, int through) {
  PointCloud<2> cloud = rectangle({.size = {b - a, pi}, .cells = {through, 4 * through}, .origin = {a, 0.0}});
  for (Point<2>& X : cloud.positions) {
    const double latitude = X[1] - 0.5 * pi;
    X = X[0] * Point<2>(std::cos(latitude), std::sin(latitude));
    if (X[0] < 1e-9 * b) X[0] = 0.0;
  }
  cloud.axisymmetric = true;
  return cloud;
}

/// Relative error in L2 of the displacement u = (A + B/ρ³) X, σ_ρρ = (3λ + 2μ) A − 4μ B/ρ³, under a small pressure inside.
double lame_error(int through) {
  const double a = 2e-6, b = 4e-6, pressure = 1e-3;
  const NeoHookean law{.mu = 1e3, .lambda = 2e3};
  const double B = pressure * std::pow(a * b, 3) / (4.0 * law.mu * (b * b * b - a * a * a));
  const double A = 4.0 * law.mu * B / (b * b * b) / (3.0 * law.lambda + 2.0 * law.mu);
  Body body{"shell", thick_sphere(a, b, through), Rkpm<2>{}, NodalCentroids{}, Materials{Region{"body", law}}};
  const auto equator = select(body.cloud(), [](const Point<2>& X) { return std::abs(X[1]) < 1e-12; });
  StaticProblem problem(body, {fixed(equator, {false, true, false})},
                        OnFacets{AmbientPressure{.pressure = pressure}, [&](const Point<2>& X) { return X.norm() < a * (1.0 + 1e-9); }});
  StaticNewton{.tolerance = 1e-9}.solve(problem);
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector3 X = body.table().particle_position[i].head<3>();
    const Vector3 exact = (A + B / std::pow(X.norm(), 3)) * X;
    error += body.nodal_volumes()[i] * (body.displacement[i].head<3>() - exact).squaredNorm();
    size += body.nodal_volumes()[i] * exact.squaredNorm();
  }
  return std::sqrt(error / size);
}

// --- Lamb -------------------------------------------------------------------------------------------------------

/// Frequencies of the free ball in its section, η = ω R/c_T, ascending: K u = ω² M u with the axis held.
std::vector<double> section_frequencies(int core_cells, const ModifiedMooneyRivlin& law) {
  const Body body{"ball",
                  meridian(Ball{.radius = radius, .core_radius = 0.382 * radius, .core_cells = core_cells, .shells = core_cells / 2,
                                .core_region = "body", .shell_region = "body"}),
                  Rkpm<2>{}, NodalCentroids{.solid_damping_time = 0.0}, Materials{Region{"body", law}}};
  const Eigen::MatrixXd all(assemble_stiffness(body));
  std::vector<Eigen::Index> free;
  for (std::size_t i = 0; i < body.size(); ++i)
    for (int c = 0; c < 2; ++c)
      if (c == 1 || !body.cloud().on_axis(body.cloud().positions[i])) free.push_back(static_cast<Eigen::Index>(2 * i) + c);
  const auto n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd scaled(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      scaled(i, j) = all(free[static_cast<std::size_t>(i)], free[static_cast<std::size_t>(j)]) /
                     std::sqrt(body.masses()[static_cast<std::size_t>(free[static_cast<std::size_t>(i)] / 2)] *
                               body.masses()[static_cast<std::size_t>(free[static_cast<std::size_t>(j)] / 2)]);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(Eigen::MatrixXd(0.5 * (scaled + scaled.transpose())), Eigen::EigenvaluesOnly);
  std::vector<double> eta;
  for (Eigen::Index k = 0; k < std::min<Eigen::Index>(n, 8); ++k)
    eta.push_back(std::sqrt(std::max(0.0, modes.eigenvalues()[k])) * radius / std::sqrt(law.shear_modulus() / law.density));
  return eta;
}

// --- between plates ---------------------------------------------------------------------------------------------

/// Force (N) on each of two plates that press a ball to 80 % of its height; the section or the octant is the upper half.
template <int D>
double plate_force(double resolution) {
  const int core = 2 * static_cast<int>(std::lround(5.0 * resolution)), shells = static_cast<int>(std::lround(5.0 * resolution));
  const Ball shape{.radius = radius, .core_radius = 0.382 * radius, .core_cells = core, .shells = shells, .core_region = "body", .shell_region = "body"};
  PointCloud<D> cloud = [&] {
    if constexpr (D == 3) return octant(ball(shape), radius);
    else return part_where(meridian(shape), [](const Point<2>& X) { return X[1] > -1e-12 * radius; });
  }();
  for (Point<D>& X : cloud.positions)
    if (std::abs(X[D - 1]) < 1e-9 * radius) X[D - 1] = 0.0;
  Body body{"ball", std::move(cloud), Rkpm<D>{}, NodalCentroids{}, Materials{Region{"body", ModifiedMooneyRivlin{}}}};
  std::vector<PrescribedMotion> symmetry;
  for (int k = D == 3 ? 0 : 1; k < D; ++k) {  // the axis of the section holds itself
    std::array<bool, 3> normal{};
    normal[static_cast<std::size_t>(k)] = true;
    symmetry.push_back(fixed(select(body.cloud(), [k](const Point<D>& X) { return X[k] == 0.0; }), normal));
  }
  const auto is_surface = [](const Point<D>& X) { return X.norm() > radius * (1.0 - 1e-9); };
  double force = 0.0;
  for (int step = 1; step <= 8; ++step) {
    Vector3 point = Vector3::Zero();
    point[D - 1] = radius * (1.0 - 0.2 * step / 8.0);
    StaticProblem problem(body, symmetry,
                          OnFacets{OnRigid<>{.law = {.penalty = 5e12}, .surface = {.point = point, .normal = -Vector3::Unit(D - 1)}}, is_surface});
    StaticNewton{.tolerance = 1e-9, .max_iterations = 60}.solve(problem);
    force = problem.reaction(symmetry.size() - 1)[D - 1];
  }
  return D == 3 ? 4.0 * force : force;
}

}  // namespace
}  // namespace revolution_study

void revolution(Report& report, Level level) {
  using namespace revolution_study;
  const bool full = level == Level::full;
  {
    auto table = report.table("sphere", {"cells_through", "error"});
    std::vector<double> errors;
    for (const int through : full ? std::vector{6, 12, 24, 48} : std::vector{6, 12}) {
      errors.push_back(lame_error(through));
      table.write(std::array{static_cast<double>(through), errors.back()});
    }
    report.at_least("thick sphere under pressure inside, order of the displacement in L2", std::log2(errors[errors.size() - 2] / errors.back()),
                    1.7, "Lame's solution");
    report.at_most("thick sphere, relative error of the displacement in L2", errors.back(), full ? 2e-3 : 1e-2, "Lame's solution");
  }
  {
    const ModifiedMooneyRivlin law{};
    const double bulk = law.bulk_modulus(), shear = law.shear_modulus();
    const double poisson = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear);
    auto table = report.table("ball", {"core_cells", "eta_2", "eta_3", "exact_2", "exact_3"});
    std::vector<double> errors;
    for (const int core : full ? std::vector{10, 20, 30} : std::vector{10, 20}) {
      const std::vector<double> eta = section_frequencies(core, law);
      const double two = lamb_root(2, poisson), three = lamb_root(3, poisson);
      const auto nearest = [&](double exact) {
        return *std::min_element(eta.begin(), eta.end(), [&](double a, double b) { return std::abs(a - exact) < std::abs(b - exact); });
      };
      table.write(std::array{static_cast<double>(core), nearest(two), nearest(three), two, three});
      errors.push_back(nearest(two) / two - 1.0);
      if (core == 10) {
        report.at_most("free ball, frequency of the rigid motion along the axis over that of l = 2", eta[0] / two, 1e-4, "exactly 0");
        report.compare("free ball, section of the paper's resolution, l = 2: the lowest frequency, omega R/c_t", eta[1], two, 0.015, "Lamb 1882");
        report.note("the same, l = 3", nearest(three), three, "Lamb 1882");
      }
      if (core == 20) {
        report.compare("twice the resolution, l = 2", nearest(two), two, 0.005, "Lamb 1882");
        report.compare("twice the resolution, l = 3", nearest(three), three, 0.02, "Lamb 1882");
      }
    }
    report.at_least("order of the frequency, l = 2", std::log2(errors[0] / errors[1]), 1.5, "second order");
  }
  {
    // The facets of a body meet the plates one by one, those of a section are whole rings: the body comes to its force from below.
    auto table = report.table("plates", {"resolution", "section [N]", "body [N]"});
    const std::vector<double> resolutions = full ? std::vector{0.6, 1.0} : std::vector{0.6};
    const double fine = plate_force<2>(full ? 3.0 : 2.0), section = plate_force<2>(1.0);
    report.compare("ball pressed to 80 % of its height, force on a plate, section of the paper's resolution, N", section, fine, 0.02, "a finer section");
    std::vector<double> errors;
    for (const double r : resolutions) {
      const double body = plate_force<3>(r);
      table.write(std::array{r, plate_force<2>(r), body});
      errors.push_back(std::abs(body / fine - 1.0));
      report.compare(fmt::format("the same in three dimensions, resolution {}, N", r), body, fine, r < 1.0 ? 0.12 : 0.04, "the section");
    }
    if (full) report.at_least("order in which the body comes to the section", std::log(errors[0] / errors.back()) / std::log(1.0 / 0.6), 1.5, "second order");
  }
}

}  // namespace tactoid::verification
