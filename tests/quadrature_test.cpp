// The tables of the quadrature rules: row and column conditions, volumes, colours, errors, and the concept.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactoid/geometry/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/quadrature/coarse_space.hpp>

#include "relative.hpp"

namespace quadrature_test {

using namespace tactoid;

namespace {

struct WithoutStabilization {
  PointTable build(const PointCloud<3>&, const Rkpm<3>&) const { return {}; }
};
struct BuildsNothing {
  void build(const PointCloud<3>&, const Rkpm<3>&) const {}
  Stabilization stabilization(double) const { return {}; }
};
struct ForPlanesOnly {
  PointTable build(const PointCloud<2>&, const Rkpm<2>&) const { return {}; }
  Stabilization stabilization(double) const { return {}; }
};
struct NumberForStabilization {
  PointTable build(const PointCloud<3>&, const Rkpm<3>&) const { return {}; }
  double stabilization(double) const { return 0.0; }
};
static_assert(Quadrature<NodalCentroids, Rkpm<1>> && Quadrature<NodalCentroids, Rkpm<2>> &&
              Quadrature<NodalCentroids, Mls<3>>);
static_assert(Quadrature<GaussCells<1>, Rkpm<3>> && Quadrature<GaussCells<2>, Rkpm<2>>);
static_assert(!Quadrature<WithoutStabilization, Rkpm<3>>);
static_assert(!Quadrature<BuildsNothing, Rkpm<3>>);
static_assert(Quadrature<ForPlanesOnly, Rkpm<2>> && !Quadrature<ForPlanesOnly, Rkpm<3>>);
static_assert(!Quadrature<NumberForStabilization, Rkpm<3>>);
static_assert(!Quadrature<NodalCentroids, int>);

Vector3 shortest(const PointTable& table, Vector3 d) {
  for (int k = 0; k < 3; ++k)
    if (table.period[k] > 0.0) d[k] -= table.period[k] * std::round(d[k] / table.period[k]);
  return d;
}

/// What every table must keep, and its volume.
template <int D>
void check_table(const PointCloud<D>& cloud, const PointTable& table, const std::string& name) {
  CAPTURE(name);
  REQUIRE(table.points() > 0);
  CHECK(table.particles == cloud.size());
  CHECK(table.dimension == D);
  double sum = 0.0, row_error = 0.0;
  bool sorted = true, even = true, owned = true;
  for (std::size_t q = 0; q < table.points(); ++q) {
    CHECK(table.volume[q] > 0.0);
    sum += table.volume[q];
    if (q > 0) sorted = sorted && table.region[q - 1] <= table.region[q];
    const auto row = table.row(q);
    even = even && row.size() % 2 == 0;
    Vector3 total = Vector3::Zero();
    Tensor3 linear = Tensor3::Zero();
    double size = 0.0;
    bool has_owner = false;
    for (std::size_t k = 0; k < row.size(); ++k) {
      const bool padding = is_padding(table, q, table.offsets[q] + k);
      const Vector3 G(row[k].gradient[0], row[k].gradient[1], row[k].gradient[2]);
      if (padding) {
        CHECK(k + 1 == row.size());
        CHECK(G.isZero(0.0));
        continue;
      }
      const Vector3 d =
          shortest(table, table.particle_position[row[k].particle].template head<3>() - table.position[q]);
      total += G;
      linear += d * G.transpose();
      size += G.norm() * d.norm();
      has_owner = has_owner || row[k].particle == table.owner[q];
    }
    owned = owned && has_owner;
    Tensor3 expected = Tensor3::Zero();
    expected.topLeftCorner(D, D).setIdentity();
    row_error = std::max(row_error, (linear - expected).norm() / size);
    row_error = std::max(row_error, total.norm() * std::pow(table.volume[q], 1.0 / D) / size);
  }
  CHECK(sorted);
  CHECK(even);
  CHECK(owned);
  CHECK(row_error < 1e-12);
  CHECK(sum == test::relative(volume(cloud)).epsilon(1e-12));

  // Colours: every point once; no particle twice in a colour.
  std::vector<int> seen(table.points(), 0);
  REQUIRE(table.color_offsets.back() == table.chunks.size());
  for (std::size_t c = 0; c + 1 < table.color_offsets.size(); ++c) {
    std::set<Index> taken;
    for (std::size_t k = table.color_offsets[c]; k < table.color_offsets[c + 1]; ++k) {
      std::set<Index> own;
      for (std::size_t q = table.chunks[k].begin; q < table.chunks[k].end; ++q) {
        ++seen[q];
        CHECK(table.region[q] == table.chunks[k].region);
        for (const TableEntry& entry : table.row(q)) own.insert(entry.particle);
      }
      for (Index i : own) CHECK(taken.insert(i).second);
    }
  }
  CHECK(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
}

/// Largest |Σ_q V_q G_qI − b_I| over the largest Σ_q V_q |G_qI|.
template <int D>
double column_error(const PointCloud<D>& cloud, const PointTable& table) {
  std::vector<Vector3> sum(cloud.size(), Vector3::Zero());
  std::vector<double> size(cloud.size(), 0.0);
  for (std::size_t q = 0; q < table.points(); ++q)
    for (const TableEntry& entry : table.row(q)) {
      const Vector3 G(entry.gradient[0], entry.gradient[1], entry.gradient[2]);
      sum[entry.particle] += table.volume[q] * G;
      size[entry.particle] += table.volume[q] * G.norm();
    }
  const auto b = boundary_normal_integrals(cloud);
  double error = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    error = std::max(error, (sum[i] - pad(b[i]).template head<3>()).norm());
  return error / *std::max_element(size.begin(), size.end());
}

template <int D>
void check_nodal(const PointCloud<D>& cloud, const std::string& name) {
  NodalCentroids rule;
  rule.points_per_chunk = 16;
  const PointTable table = rule.build(cloud, Rkpm<D>{});
  check_table(cloud, table, name);
  const double error = column_error(cloud, table);
  MESSAGE(name << ": " << table.points() << " points, "
               << static_cast<double>(table.pairs()) / static_cast<double>(table.points())
               << " particles per point, column error " << error << ", " << table.color_offsets.size() - 1
               << " colours");
  CHECK(error < 1e-12);
  CHECK(table.value_based());
}

/// A table that is not corrected yet, its weights, and the integrals over the boundary that it must meet.
struct Uncorrected {
  PointTable table;
  std::vector<double> weights;
  Field boundary;
};
Uncorrected uncorrected(const PointCloud<3>& cloud, double support) {
  Uncorrected u{NodalCentroids{.consistency_tolerance = 0.0}.build(cloud, Rkpm<3>{.support = support}), {}, {}};
  std::vector<double> reach(cloud.size(), 0.0);  // any weights that vanish at the rim of a row do
  for (std::size_t q = 0; q < u.table.points(); ++q)
    for (const TableEntry& entry : u.table.row(q))
      reach[q] = std::max(reach[q], 1.05 * shortest(u.table, u.table.particle_position[entry.particle].head<3>() - u.table.position[q]).norm());
  for (std::size_t q = 0; q < u.table.points(); ++q)
    for (std::size_t e = u.table.offsets[q]; e < u.table.offsets[q + 1]; ++e) {
      const Vector3 d = shortest(u.table, u.table.particle_position[u.table.entries[e].particle].head<3>() - u.table.position[q]);
      u.weights.push_back(is_padding(u.table, q, e) ? 0.0 : CubicBSpline::value(d.norm() / reach[q]));
    }
  for (const Point<3>& b : boundary_normal_integrals(cloud)) u.boundary.push_back(pad(b));
  return u;
}
double column_error(const Uncorrected& u) {
  Field sum = u.boundary;
  double largest = 0.0, size = 0.0;
  for (std::size_t q = 0; q < u.table.points(); ++q)
    for (const TableEntry& entry : u.table.row(q)) sum[entry.particle] -= u.table.volume[q] * Vector4(entry.gradient[0], entry.gradient[1], entry.gradient[2], 0.0);
  for (std::size_t i = 0; i < sum.size(); ++i) {
    largest = std::max(largest, sum[i].norm());
    size = std::max(size, u.boundary[i].norm());
  }
  return largest / size;
}

}  // namespace

TEST_CASE("NodalCentroids keeps rows, columns, volumes and colours: 3D") {
  check_nodal(jitter(box({.size = {3e-6, 2e-6, 2e-6}, .cells = {6, 5, 4}}), 0.2), "jittered box");
  check_nodal(ball({.radius = 5e-6, .core_radius = 2e-6, .core_cells = 4, .shells = 2}), "ball with two regions");
  check_nodal(disc({.radius = 5e-6, .height = 2e-6, .core_cells = 4, .rings = 3, .layers = 4}), "disc");
}

TEST_CASE("NodalCentroids keeps rows, columns, volumes and colours: periodic boxes") {
  const std::array<bool, 3> all = {true, true, true}, one = {true, false, false};
  check_nodal(box({.size = {1e-6, 1e-6, 1e-6}, .cells = {5, 5, 5}, .periodic = all}), "periodic box");
  check_nodal(jitter(box({.size = {1e-6, 1e-6, 1e-6}, .cells = {5, 5, 5}, .periodic = all}), 0.15),
              "jittered periodic box");
  check_nodal(jitter(box({.size = {1e-6, 1e-6, 1e-6}, .cells = {6, 5, 5}, .periodic = one}), 0.15),
              "box periodic along x");
  check_nodal(rectangle({.size = {1e-6, 1e-6}, .cells = {8, 6}, .periodic = {true, true}}), "periodic rectangle");
  check_nodal(bar({.length = 1e-6, .cells = 12, .periodic = true}), "periodic bar");
}

TEST_CASE("NodalCentroids keeps rows, columns, volumes and colours: 2D and 1D") {
  check_nodal(jitter(rectangle({.size = {2e-6, 1e-6}, .cells = {12, 7}}), 0.2), "jittered rectangle");
  check_nodal(circle({.radius = 5e-6, .core_cells = 6, .rings = 4}), "circle");
  check_nodal(jitter(bar({.length = 1e-6, .cells = 20}), 0.2), "jittered bar");
}

TEST_CASE("A ball with two regions gives particles on the interface one point of each material") {
  const PointCloud<3> cloud = ball({.radius = 5e-6, .core_radius = 2e-6, .core_cells = 4, .shells = 2});
  const PointTable table = NodalCentroids{}.build(cloud, Rkpm<3>{});
  double core = 0.0, exact = 0.0;
  for (std::size_t q = 0; q < table.points(); ++q)
    if (cloud.regions[table.region[q]] == "nucleus") core += table.volume[q];
  for (const auto& point : gauss_points<2>(cloud))
    if (cloud.regions[point.region] == "nucleus") exact += point.weight;
  CHECK(core == test::relative(exact).epsilon(1e-12));
  CHECK(table.points() == cloud.size() + 98);  // 6 n² + 2 nodes on the surface of the core, n = 4
}

TEST_CASE("The stabilisation: none for affine fields, and none in the table of the Gauss cells") {
  const PointCloud<2> cloud = jitter(rectangle({.size = {1e-6, 1e-6}, .cells = {6, 6}}), 0.2);
  const PointTable table = NodalCentroids{}.build(cloud, Rkpm<2>{});
  const std::vector<double> spacing = longest_edges(cloud);
  std::size_t bonds = 0;
  for (std::size_t q = 0; q < table.points(); ++q) {
    const auto weights = table.bonds(q);
    CHECK(weights.size() % 2 == 0);
    REQUIRE(weights.size() <= table.row(q).size());
    double moment = 0.0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const Index J = table.row(q)[k].particle;
      const double distance = (table.particle_position[J] - table.particle_position[table.owner[q]]).norm();
      const double x = distance / (1.25 * spacing[J]);
      CHECK(weights[k] == doctest::Approx(J == table.owner[q] || x >= 1.0 ? 0.0 : 1.0 - x * x).epsilon(1e-6));
      moment += static_cast<double>(weights[k]) * distance * distance;
      bonds += weights[k] > 0.0F;
    }
    CHECK(table.stabilization_scale[q] * moment == test::relative(2.0 * table.volume[q]).epsilon(1e-12));
  }
  std::size_t expected = 0;  // every pair within reach, from both its ends
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (std::size_t j = 0; j < cloud.size(); ++j)
      expected += i != j && (cloud.positions[i] - cloud.positions[j]).norm() < 1.25 * spacing[j];
  CHECK(bonds == expected);
  CHECK(NodalCentroids{.solid_ratio = 0.2}.stabilization(100.0).modulus == 20.0);
  CHECK(NodalCentroids{.fluid_modulus = 7.0}.stabilization(0.0).modulus == 7.0);
  CHECK(NodalCentroids{.fluid_modulus = 4.0, .fluid_viscosity = 2e-5}.stabilization(0.0).damping_time == 5e-6);
  CHECK(NodalCentroids{.fluid_modulus = 0.0}.stabilization(0.0).damping_time == 0.0);
  CHECK(GaussCells<2>{}.stabilization(100.0).modulus == 0.0);
  CHECK(GaussCells<2>{}.build(cloud, Rkpm<2>{}).stabilization_scale.empty());
}

TEST_CASE("GaussCells samples true shape functions") {
  const PointCloud<2> cloud = jitter(rectangle({.size = {2e-6, 1e-6}, .cells = {8, 5}}), 0.2);
  const PointTable table = GaussCells<2>{.points_per_chunk = 16}.build(cloud, Rkpm<2>{});
  check_table(cloud, table, "GaussCells<2>");
  CHECK(table.points() == 4 * cloud.cells.size());
  REQUIRE_FALSE(table.value_based());
  const auto reproduces = [&](auto value, auto particle, std::size_t begin, std::size_t end, const Vector3& X) {
    double one = 0.0;
    Vector3 x = Vector3::Zero();
    for (std::size_t e = begin; e < end; ++e) {
      one += value(e);
      x += value(e) * table.particle_position[particle(e)].template head<3>();
    }
    CHECK(one == test::relative(1.0).epsilon(1e-12));
    CHECK((x - X).norm() < 1e-17);
  };
  for (std::size_t q = 0; q < table.points(); ++q)
    reproduces([&](std::size_t e) { return table.point_values[e]; },
               [&](std::size_t e) { return table.entries[e].particle; }, table.offsets[q], table.offsets[q + 1],
               table.position[q]);
  const ValueRows& rows = table.particle_values;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    reproduces([&](std::size_t e) { return rows.values[e]; }, [&](std::size_t e) { return rows.particles[e]; },
               rows.offsets[i], rows.offsets[i + 1], pad(cloud.positions[i]).head<3>());

  // Interpolation and its transpose: the power of forces at particles is that of the forces of the unknowns.
  const ParticleValues map(rows);
  CHECK_FALSE(map.identity());
  Field u(cloud.size()), f(cloud.size()), g(cloud.size(), Vector4::Zero());
  for (std::size_t i = 0; i < u.size(); ++i) {
    u[i] = Vector4(std::sin(3.0 * double(i)), std::cos(2.0 * double(i)), 0.0, 0.0);
    f[i] = Vector4(std::cos(5.0 * double(i)), std::sin(7.0 * double(i)), 0.0, 0.0);
  }
  map.distribute(f, g);
  const Field at_particles = map.evaluate(u);
  double a = 0.0, b = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) a += f[i].dot(at_particles[i]), b += g[i].dot(u[i]);
  CHECK(a == test::relative(b).epsilon(1e-12));
}

TEST_CASE("the correction of a large body takes about as many iterations as that of a small one: the coarse space does the smooth part") {
  const auto iterations = [](const PointCloud<3>& cloud) {
    Uncorrected u = uncorrected(cloud, 2.0);
    CHECK(column_error(u) > 1e-4);
    const ConsistencyReport report = make_consistent(u.table, u.weights, u.boundary);
    CHECK(column_error(u) < 1e-11);
    CHECK(report.residual < 1e-12);
    return report.iterations;
  };
  const auto jittered = [](int cells) { return jitter(box({.size = {1.0, 1.0, 1.0}, .cells = {cells, cells, cells}}), 0.2); };
  const int small = iterations(jittered(11));  // 1728 particles: Jacobi's preconditioner alone
  CHECK(iterations(jittered(18)) < small);     // 6859; without a coarse space twice as many
  CHECK(iterations(disc({.radius = 1.0, .height = 0.4, .core_cells = 14, .rings = 7, .layers = 8})) < 200);
}

TEST_CASE("the correction of a body in two pieces, each with affine functions of its own") {
  PointCloud<3> two = box({.size = {1.0, 1.0, 1.0}, .cells = {13, 13, 13}});
  const PointCloud<3> one = two;
  const auto n = static_cast<Index>(one.size());
  for (Point<3> X : one.positions) two.positions.push_back(X + Point<3>(3.0, 0.0, 0.0));
  for (auto cell : one.cells) {
    for (Index& i : cell) i += n;
    two.cells.push_back(cell);
  }
  for (auto facet : one.facets) {
    for (Index& i : facet) i += n;
    two.facets.push_back(facet);
  }
  two.cell_regions.insert(two.cell_regions.end(), one.cell_regions.begin(), one.cell_regions.end());
  Uncorrected u = uncorrected(two, 2.0);
  REQUIRE(u.table.particles >= 5000);
  make_consistent(u.table, u.weights, u.boundary);
  CHECK(column_error(u) < 1e-11);
}

TEST_CASE("quadratic splines of a coarse space hold affine functions, and wrap around a periodic box") {
  for (const bool periodic : {false, true}) {
    CAPTURE(periodic);
    const PointCloud<3> cloud = box({.size = {2.0, 1.0, 1.0}, .cells = {10, 5, 5}, .periodic = {periodic, false, false}});
    const PointTable table = NodalCentroids{}.build(cloud, Rkpm<3>{});
    const detail::CoarseSpace space(table, 8.0, 1000, nullptr);
    const Eigen::MatrixXd affine = space.affine(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(space.size())));
    REQUIRE(affine.cols() == (periodic ? 3 : 4));
    CHECK((affine.transpose() * affine - Eigen::MatrixXd::Identity(affine.cols(), affine.cols())).norm() < 1e-12);
    const auto value = [&](const Vector3& X, Eigen::Index column) {
      double sum = 0.0, ones = 0.0;
      space.for_each(space.at(X), [&](std::size_t node, double w) { sum += w * affine(static_cast<Eigen::Index>(node), column), ones += w; });
      CHECK(ones == doctest::Approx(1.0).epsilon(1e-13));
      return sum;
    };
    const Vector3 a(0.1, 0.9, 0.3), b(1.7, 0.2, 0.8);
    for (Eigen::Index column = 0; column < affine.cols(); ++column) {
      CHECK(std::abs(value(0.5 * (a + b), column) - 0.5 * (value(a, column) + value(b, column))) < 1e-13);
      if (periodic) CHECK(std::abs(value(a, column) - value(a + Vector3(2.0, 0.0, 0.0), column)) < 1e-13);
    }
  }
}

TEST_CASE("A support that is too small is an error that names the point, the neighbours and the condition number") {
  const PointCloud<3> cloud = box({.size = {1e-6, 1e-6, 1e-6}, .cells = {4, 4, 4}});
  const Rkpm<3> kernel{.support = 0.9};
  for (int rule = 0; rule < 2; ++rule) {
    std::string message;
    try {
      if (rule == 0)
        (void)NodalCentroids{}.build(cloud, kernel);
      else
        (void)GaussCells<2>{}.build(cloud, kernel);
    } catch (const GeometryError& error) {
      message = error.what();
    }
    CAPTURE(message);
    CHECK(message.find("particles in reach") != std::string::npos);
    CHECK(message.find("uadrature point ") != std::string::npos);
    CHECK(message.find("condition number ") != std::string::npos);
    CHECK(message.find("enlarge the support") != std::string::npos);
  }
  CHECK_THROWS_WITH_AS((void)NodalCentroids{.condition_limit = 1.5}.build(cloud, Rkpm<3>{}),
                       doctest::Contains("(allowed: 1.5)"), GeometryError);
}

TEST_CASE("Parameters out of range are rejected by name") {
  CHECK_THROWS_WITH_AS(NodalCentroids{.stabilization_reach = 1.0}.validate(),
                       "NodalCentroids.stabilization_reach = 1 is not allowed: it must be above 1.", ParameterError);
  CHECK_THROWS_WITH_AS(NodalCentroids{.solid_ratio = -0.1}.validate(),
                       "NodalCentroids.solid_ratio = -0.1 is not allowed: it must be zero or positive, and finite.",
                       ParameterError);
  CHECK_THROWS_AS(NodalCentroids{.fluid_modulus = -1.0}.validate(), ParameterError);
  CHECK_THROWS_AS(NodalCentroids{.solid_damping_time = -1.0}.validate(), ParameterError);
  CHECK_THROWS_AS(NodalCentroids{.condition_limit = 0.0}.validate(), ParameterError);
  CHECK_THROWS_AS(GaussCells<2>{.condition_limit = -1.0}.validate(), ParameterError);
}

}  // namespace quadrature_test
