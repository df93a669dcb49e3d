// Manufactured equilibria at finite strain: the body force that holds a chosen motion, and the chosen displacements on
// the whole boundary, must give the motion back. Orders of convergence in space, and of Newton's iteration.
#include <algorithm>
#include <numbers>
#include <string>

#include <tactoid/boundary/body_force.hpp>
#include <tactoid/boundary/prescribed_motion.hpp>
#include <tactoid/integrator/static_newton.hpp>
#include <tactoid/kernel/rkpm.hpp>
#include <tactoid/material/modified_mooney_rivlin.hpp>
#include <tactoid/material/neo_hookean.hpp>
#include <tactoid/quadrature/gauss_cells.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/simulation/static_problem.hpp>
#include <tactoid/verify/convergence.hpp>

#include "manufactured.hpp"
#include "studies.hpp"

namespace tactoid::verification {
namespace statics_study {
namespace {

constexpr double pi = std::numbers::pi;

/// Stretch, compression and shear of the unit square or cube with J far from 1.
template <int D>
struct Compressible {
  template <class T>
  Vector<T> operator()(const Vector<T>& X) const {
    using std::cos;
    using std::sin;
    const T a = T(pi) * X(0), b = T(pi) * X(1), c = T(pi) * X(2);
    Vector<T> x = X;
    x(0) += T(0.08) * sin(a) * cos(b) + T(0.15) * X(0) * X(1);
    x(1) += T(0.06) * cos(a) * sin(b) - T(0.10) * X(0) * X(0);
    if constexpr (D == 3) {
      x(0) += T(0.05) * sin(c);
      x(1) += T(0.04) * cos(b) * cos(c);
      x(2) += T(0.07) * sin(c) * cos(a) + T(0.08) * X(1) * X(2);
    }
    return x;
  }
};

/// Shears one after the other, each of which keeps the volume, after a dilation of ±0.7 %: J = 1 + 0.007 cos(π X₁).
/// With K/G = 148 its pressure is of the size of the shear modulus, as in a nearly incompressible solid under load.
template <int D>
struct NearlyIsochoric {
  template <class T>
  Vector<T> operator()(const Vector<T>& X) const {
    using std::cos;
    using std::sin;
    Vector<T> x = X;
    x(0) += T(0.007 / pi) * sin(T(pi) * X(0));
    x(0) += T(0.08) * sin(T(pi) * x(1));
    x(1) += T(0.07) * cos(T(pi) * x(0));
    if constexpr (D == 3) {
      x(2) += T(0.06) * sin(T(pi) * x(1)) * cos(T(pi) * x(0));
      x(0) += T(0.04) * cos(T(pi) * x(2));
    }
    return x;
  }
};

template <int D>
PointCloud<D> unit_cloud(int cells, double jittered) {
  PointCloud<D> cloud;
  if constexpr (D == 2)
    cloud = rectangle({.size = {1.0, 1.0}, .cells = {cells, cells}});
  else
    cloud = box({.size = {1.0, 1.0, 1.0}, .cells = {cells, cells, cells}});
  return jittered > 0.0 ? jitter(cloud, jittered) : cloud;
}

struct Solution {
  SolutionErrors errors;
  StaticReport report;
};

template <int D, class Map, class Law, class Quadrature>
Solution solve(const ManufacturedMotion<Map>& motion, const Law& law, const Quadrature& quadrature, int cells,
               double jittered) {
  Body body{"block", unit_cloud<D>(cells, jittered), Rkpm<D>{}, quadrature, Materials{Region{"body", law}}};
  PrescribedMotion boundary{{}, [&](const Vector3& X, double) { return motion.displacement(X); }, {true, true, true}};
  const std::vector<bool> outside = on_boundary(body.cloud());
  for (Index i = 0; i < body.size(); ++i)
    if (outside[i]) boundary.particles.push_back(i);
  StaticProblem problem(body, {boundary},
                        BodyForce{.acceleration = [&](const Vector3& X, double) { return motion.body_force(law, X); }});
  // Factorisation fills in too much in three dimensions.
  const LinearSolver solver = D == 3 ? LinearSolver::conjugate_gradients : LinearSolver::direct;
  Solution solution;
  solution.report = StaticNewton{.tolerance = 1e-10, .load_steps = 2, .solver = solver}.solve(problem);
  solution.errors = errors_of(motion, law, body);
  return solution;
}

/// log(r₃/r₂) / log(r₂/r₁) of the last three residuals above the round-off.
double newton_order(const std::vector<double>& residuals) {
  std::size_t last = residuals.size();
  while (last > 0 && residuals[last - 1] < 1e-12) --last;
  if (last < 3) return 0.0;
  const double r1 = residuals[last - 3], r2 = residuals[last - 2], r3 = residuals[last - 1];
  return std::log(r3 / r2) / std::log(r2 / r1);
}

/// Which rate is required. On jittered clouds the error of the randomness, of order h and small only on fine clouds,
/// sets in late: there the rate of the two finest is asked.
enum class Required { fitted, finest, none };

template <int D, class Map, class Law, class Quadrature>
void converge(Report& report, const std::string& name, const ManufacturedMotion<Map>& motion, const Law& law,
              const Quadrature& quadrature, const std::vector<int>& cells, double jittered, Required required) {
  HistoryWriter table = report.table(name, {"spacing [m]", "displacement", "gradient", "field", "field gradient",
                                            "pressure", "Newton iterations", "linear iterations"});
  std::vector<double> h, u, F, f, g, p;
  std::string title = name;
  std::replace(title.begin(), title.end(), '_', ' ');
  for (const int n : cells) {
    const auto [errors, solved] = solve<D>(motion, law, quadrature, n, jittered);
    h.push_back(1.0 / n);
    u.push_back(errors.displacement);
    F.push_back(errors.gradient);
    f.push_back(errors.field);
    g.push_back(errors.field_gradient);
    p.push_back(errors.pressure);
    table.write(std::array{1.0 / n, u.back(), F.back(), f.back(), g.back(), p.back(),
                           static_cast<double>(solved.iterations), static_cast<double>(solved.linear_iterations)});
  }
  const std::string source =
      fmt::format("order of the linear basis; {} to {} cells",
                  required == Required::fitted ? cells.front() : cells[cells.size() - 2], cells.back());
  const auto rate = [&](const char* what, const std::vector<double>& errors, double least) {
    const ConvergenceRates rates = convergence_rates(h, errors);
    const double value = required == Required::fitted ? rates.fitted : rates.last();
    if (required != Required::none && least > 0.0)
      report.at_least(title + ": " + what, value, least, source);
    else
      report.note(title + ": " + what, value, std::nan(""), source);
  };
  rate("rate of u, L2", u, 1.9);
  rate("rate of grad u, L2 (H1)", F, 0.95);
  rate("rate of u between particles, L2", f, 1.9);
  rate("rate of grad u between particles, L2 (H1)", g, 0.95);
  rate("rate of the pressure, L2", p, 0.0);
  report.note(title + ": error of u at the finest", u.back(), std::nan(""), "over the norm of u");
  report.note(title + ": error of grad u at the finest", F.back(), std::nan(""), "over the norm of grad u");
  report.note(title + ": error of the pressure at the finest", p.back(), std::nan(""), "over the norm of the pressure");
}

}  // namespace
}  // namespace statics_study

void statics(Report& report, Level level) {
  using namespace statics_study;
  const NeoHookean neo_hookean = NeoHookean::from_young(1e4, 0.3);
  const ModifiedMooneyRivlin nucleus{};
  const ManufacturedMotion<Compressible<2>> stretch2;
  const ManufacturedMotion<Compressible<3>> stretch3;
  const ManufacturedMotion<NearlyIsochoric<2>> shear2;
  const ManufacturedMotion<NearlyIsochoric<3>> shear3;

  std::vector<Vector3> places;
  for (int i = 0; i < 8000; ++i)
    places.emplace_back(0.05 * (i % 20 + 0.5), 0.05 * (i / 20 % 20 + 0.5), 0.05 * (i / 400 + 0.5));
  const auto strain = [&](const char* name, double value) {
    report.at_least(fmt::format("largest strain of the motion: {}", name), value, 0.2, "finite strain, 20 to 50 %");
    report.at_most(fmt::format("largest strain of the motion: {}", name), value, 0.5, "finite strain, 20 to 50 %");
  };
  strain("2D, compressible", stretch2.largest_strain(places));
  strain("3D, compressible", stretch3.largest_strain(places));
  strain("2D, nearly isochoric", shear2.largest_strain(places));
  strain("3D, nearly isochoric", shear3.largest_strain(places));

  const bool full = level == Level::full;
  const std::vector<int> plane = full ? std::vector{8, 16, 32, 64} : std::vector{8, 16, 32};
  const std::vector<int> jittered_plane = full ? std::vector{16, 32, 64, 128} : std::vector{8, 16, 32};
  const std::vector<int> space = full ? std::vector{6, 9, 13, 18} : std::vector{6, 8, 10};
  const Required on_jittered = full ? Required::finest : Required::none;
  const NodalCentroids nodal{};
  converge<2>(report, "neo-Hooke_2D_regular", stretch2, neo_hookean, nodal, plane, 0.0, Required::fitted);
  converge<2>(report, "neo-Hooke_2D_jittered", stretch2, neo_hookean, nodal, jittered_plane, 0.2, on_jittered);
  converge<2>(report, "Mooney_2D_regular", shear2, nucleus, nodal, plane, 0.0, Required::fitted);
  converge<2>(report, "Mooney_2D_jittered", shear2, nucleus, nodal, jittered_plane, 0.2, on_jittered);
  converge<3>(report, "neo-Hooke_3D_regular", stretch3, neo_hookean, nodal, space, 0.0, Required::fitted);
  // Nearly incompressible motions in space are resolved on finer clouds: the order is asked for from 26 to 36 cells.
  converge<3>(report, "Mooney_3D_regular", shear3, nucleus, nodal, full ? std::vector{13, 18, 26, 36} : space, 0.0,
              full ? Required::finest : Required::none);
  // In three dimensions the clouds that can be solved are too coarse for the order to show: reported.
  if (full) {
    converge<3>(report, "neo-Hooke_3D_jittered", stretch3, neo_hookean, nodal, space, 0.2, Required::none);
    converge<3>(report, "Mooney_3D_jittered", shear3, nucleus, nodal, space, 0.2, Required::none);
    // Gauss points of the cells with true shape functions: for comparison, see quadrature/README.md.
    const std::vector<int> fewer{8, 16, 32};
    converge<2>(report, "neo-Hooke_2D_jittered_Gauss", stretch2, neo_hookean, GaussCells<2>{}, fewer, 0.2,
                Required::none);
    converge<2>(report, "Mooney_2D_jittered_Gauss", shear2, nucleus, GaussCells<2>{}, fewer, 0.2, Required::none);
  }

  const std::vector<double> residuals = solve<2>(shear2, nucleus, nodal, 16, 0.2).report.residuals;
  HistoryWriter table = report.table("newton", {"iteration", "residual"});
  for (std::size_t i = 0; i < residuals.size(); ++i) table.write(std::array{static_cast<double>(i), residuals[i]});
  report.at_least("order of Newton's iteration", newton_order(residuals), 1.8,
                  "2 with a consistent tangent; residuals of the last iterations");
}

}  // namespace tactoid::verification
