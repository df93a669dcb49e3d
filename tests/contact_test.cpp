#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include <tactoid/contact/all.hpp>

#include "surface_bodies.hpp"

namespace contact_test {

using namespace tactoid;
using tactoid::test::Close;
using tactoid::test::hashed_uniform;
using tactoid::test::TestBody;

namespace {

static_assert(GapLaw<LigandReceptorLaw> && GapLaw<RepulsiveWall> && !GapLaw<VanDerWaals> && !GapLaw<double>);
static_assert(Contact<LigandReceptor, 2> && Contact<LigandReceptor, 3> && !Contact<LigandReceptor, 1>);
static_assert(Contact<VanDerWaals, 2> && Contact<VanDerWaals, 3> && !Contact<VanDerWaals, 1>);
static_assert(Contact<SurfaceContact<RepulsiveWall>, 3> && !Contact<RepulsiveWall, 3>);
static_assert(Contact<Combined<LigandReceptor, VanDerWaals>, 3>);
static_assert(RigidSurface<RigidPlane> && RigidSurface<Moving<RigidSphere>> && !RigidSurface<LigandReceptorLaw>);

constexpr double um = 1e-6, nm = 1e-9;

TestBody<3> small_ball(int core = 4, int shells = 2) {
  return TestBody<3>(ball({.radius = 1.0 * um, .core_radius = 0.5 * um, .core_cells = core, .shells = shells}));
}
TestBody<3> slab(int cells = 8) {
  return TestBody<3>(box({.size = Point<3>(4.0 * um, 4.0 * um, 0.8 * um),
                          .cells = {cells, cells, 2},
                          .origin = Point<3>(-2.0 * um, -2.0 * um, -0.8 * um)}));
}
TestBody<2> small_circle() {
  return TestBody<2>(circle({.radius = 1.0 * um, .core_cells = 4, .rings = 3}));
}
TestBody<2> strip() {
  return TestBody<2>(
      rectangle({.size = Point<2>(4.0 * um, 0.8 * um), .cells = {10, 2}, .origin = Point<2>(-2.0 * um, -0.8 * um)}));
}

/// Brute force: all facets, and on each a fine grid of starts refined by bisection of the grid (no Newton).
template <int D>
double brute_force_distance(const FacetSurface<D>& s, std::span<const Vector4> x, const Vector4& q) {
  double best = 1e300;
  for (Index f = 0; f < s.facets.size(); ++f) {
    double cs = 0.5, ct = 0.5, half = 0.5, here = 1e300;
    for (int level = 0; level < 26; ++level) {
      double bs = cs, bt = ct;
      for (int i = -4; i <= 4; ++i)
        for (int j = (D == 2 ? 0 : -4); j <= (D == 2 ? 0 : 4); ++j) {
          const double u = std::clamp(cs + half * i / 4.0, 0.0, 1.0), v = std::clamp(ct + half * j / 4.0, 0.0, 1.0);
          const double d = (s.interpolate(f, FacetSurface<D>::make_local(u, v), x) - q).norm();
          if (d < here) here = d, bs = u, bt = v;
        }
      cs = bs, ct = bt, half *= 0.5;
    }
    best = std::min(best, here);
  }
  return best;
}

/// Moves the two bodies along a random direction and compares the work of the forces with the difference of the
/// energy, by central differences of fourth order. Returns the relative error.
template <int D, class C>
double consistency(C& contact, TestBody<D>& a, TestBody<D>& b, std::uint64_t seed, double step) {
  auto fa = a.fields(), fb = b.fields();
  contact.initialize(a.cloud, fa, b.cloud, fb);
  (void)contact.apply(fa, fb, 0.0);
  const Field force_a = a.force, force_b = b.force, xa = a.position, xb = b.position;
  TestBody<D> da = a, db = b;
  da.random_velocities(1.0, seed);
  db.random_velocities(1.0, seed + 1);
  double work = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < xa.size(); ++i) work += force_a[i].dot(da.velocity[i]), scale += force_a[i].norm();
  for (std::size_t i = 0; i < xb.size(); ++i) work += force_b[i].dot(db.velocity[i]), scale += force_b[i].norm();
  const auto energy = [&](double s) {
    for (std::size_t i = 0; i < xa.size(); ++i) a.position[i] = xa[i] + s * da.velocity[i];
    for (std::size_t i = 0; i < xb.size(); ++i) b.position[i] = xb[i] + s * db.velocity[i];
    return contact.apply(a.fields(), b.fields(), 0.0).potential;
  };
  const double slope =
      (8.0 * (energy(step) - energy(-step)) - (energy(2.0 * step) - energy(-2.0 * step))) / (12.0 * step);
  a.position = xa;
  b.position = xb;
  CHECK(scale > 0.0);
  return std::abs(work + slope) / std::abs(work);
}

/// Moves the two bodies along a random direction and compares how the forces change, by central differences of fourth order, with what
/// add_stiffness says. Returns the error relative to the largest change; of A's forces alone where the motion of B is left out.
template <int D, class C>
double stiffness_error(C& contact, TestBody<D>& a, TestBody<D>& b, std::uint64_t seed, double step, bool both = true) {
  auto fa = a.fields(), fb = b.fields();
  contact.initialize(a.cloud, fa, b.cloud, fb);
  (void)contact.apply(fa, fb, 0.0);
  const std::array<std::size_t, 2> begin = {0, 3 * a.cloud.size()};
  Eigen::VectorXd direction(3 * (a.cloud.size() + b.cloud.size()));
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    const bool of_b = i >= static_cast<Eigen::Index>(begin[1]), out_of_plane = D == 2 && i % 3 == 2;
    direction[i] = out_of_plane || (of_b && !both) ? 0.0 : hashed_uniform(seed, static_cast<std::uint64_t>(i));
  }
  Eigen::VectorXd assembled = Eigen::VectorXd::Zero(direction.size());
  contact.add_stiffness(fa, fb, [&](bool of_b, Index i, bool by_b, Index j, const Tensor3& K) {
    Vector3 change = K * direction.segment<3>(static_cast<Eigen::Index>(begin[by_b] + 3 * j));
    if (D == 2) change[2] = 0.0;
    assembled.segment<3>(static_cast<Eigen::Index>(begin[of_b] + 3 * i)) += change;
  });
  const Field xa = a.position, xb = b.position;
  const auto forces = [&](double s) {
    const auto move = [&](Field& x, const Field& from, std::size_t at) {
      for (std::size_t i = 0; i < x.size(); ++i)
        x[i] = from[i] + s * pad(Vector3(direction.segment<3>(static_cast<Eigen::Index>(at + 3 * i))));
    };
    move(a.position, xa, begin[0]);
    move(b.position, xb, begin[1]);
    (void)contact.apply(a.fields(), b.fields(), 0.0);
    Eigen::VectorXd f(direction.size());
    for (std::size_t i = 0; i < xa.size(); ++i) f.segment<3>(static_cast<Eigen::Index>(3 * i)) = a.force[i].template head<3>();
    for (std::size_t i = 0; i < xb.size(); ++i) f.segment<3>(static_cast<Eigen::Index>(begin[1] + 3 * i)) = b.force[i].template head<3>();
    return f;
  };
  Eigen::VectorXd exact = -(8.0 * (forces(step) - forces(-step)) - (forces(2.0 * step) - forces(-2.0 * step))) / (12.0 * step);
  a.position = xa;
  b.position = xb;
  const Eigen::Index count = both ? direction.size() : static_cast<Eigen::Index>(begin[1]);
  CHECK(exact.head(count).norm() > 0.0);
  return (exact - assembled).head(count).cwiseAbs().maxCoeff() / exact.head(count).cwiseAbs().maxCoeff();
}

/// Bodies A and B in space, in a plane and around an axis, with gaps from a penetration outwards; both surfaces rough, so that edges and corners are
/// closest too.
struct RoughPairs {
  TestBody<3> a = small_ball(3, 2), b = slab(7);
  TestBody<2> flat_a = small_circle(), flat_b = strip();
  TestBody<2> round_a{meridian(Ball{.radius = um, .core_radius = 0.4 * um, .core_cells = 4, .shells = 2})};
  TestBody<2> round_b{meridian(Disc{.radius = 2.0 * um, .height = 0.8 * um, .core_cells = 4, .rings = 3, .layers = 3})};

  explicit RoughPairs(std::uint64_t seed) {
    a.place({0.1 * um, 0.07 * um, 0.9 * um}, 0.03 * um, seed, 0.3, Vector3(1, 0.3, 0.5));
    b.place({0, 0, 0}, 0.03 * um, seed + 10);
    flat_a.place({0.1 * um, 0.99 * um, 0.0}, 0.03 * um, seed, 0.3);
    flat_b.place({0, 0, 0}, 0.03 * um, seed + 20);
    round_a.place({0.0, 1.02 * um, 0.0}, 0.02 * um, seed);
    round_b.place({0.0, 0.0, 0.0}, 0.02 * um, seed + 30);
  }
};

}  // namespace

TEST_CASE("ligand-receptor law: peak, work of adhesion, floor, cutoff, derivative") {
  const LigandReceptorLaw law{};
  const double peak = std::sqrt(5.0 / 3.0) * 100.0 * nm;
  CHECK(law.peak_gap() == Close{peak, 1e-14});
  // N_b 4 σ_b/ε (0.6^{3/2} − 0.6^{5/2}) = 480 Pa × 0.4 × 0.6^{3/2}
  CHECK(law.peak_attraction() == Close{480.0 * 0.4 * std::pow(0.6, 1.5), 1e-13});
  CHECK(law.peak_attraction() == Close{89.232, 1e-4});
  for (double g = 40.0 * nm; g < 1900.0 * nm; g *= 1.01)
    CHECK(law.traction(g) >= -law.peak_attraction() * (1.0 + 1e-15));
  CHECK(std::abs(law.traction(100.0 * nm)) < 1e-12 * law.peak_attraction());
  // From the bottom of the well to infinity: N_b σ_b. The cutoff takes its own depth away.
  const double far = 1.0 / 400.0;
  CHECK(-law.potential(100.0 * nm) == Close{500e12 * 0.024e-18 * (1.0 + far * far - 2.0 * far), 1e-13});
  CHECK(-LigandReceptorLaw{.cutoff = 1e6}.potential(100.0 * nm) == Close{500e12 * 0.024e-18, 1e-11});
  CHECK(std::abs(law.potential(law.reach() * (1.0 - 1e-12))) < 1e-12 * 1.2e-5);
  CHECK(law.potential(law.reach()) == 0.0);
  CHECK(std::abs(law.traction(law.reach() * (1.0 - 1e-12))) < 1.5e-3 * law.peak_attraction());
  for (const double g : {-500.0 * nm, -20.0 * nm, 5.0 * nm, 29.0 * nm, 31.0 * nm, 80.0 * nm, 129.0 * nm, 700.0 * nm}) {
    const double h = 0.01 * nm;
    CHECK((law.potential(g - h) - law.potential(g + h)) / (2.0 * h) == Close{law.traction(g), 1e-6});
    CHECK(std::abs(law.traction(g - h) - law.traction(g + h)) / (2.0 * h) == Close{law.stiffness(g), 1e-4});
  }
  const double floor = 30.0 * nm, d = 1e-6 * nm;
  CHECK(law.potential(floor - d) == Close{law.potential(floor + d), 1e-6});
  CHECK(law.traction(floor - d) == Close{law.traction(floor + d), 1e-6});
  CHECK(law.traction(-1000.0 * nm) > law.traction(-900.0 * nm));
  CHECK(std::isfinite(law.traction(-1.0)));
}

TEST_CASE("parameters out of range are named") {
  const auto message = [](auto&& term) {
    try {
      term.validate();
    } catch (const ParameterError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK(message(LigandReceptor{.bond_density = -1.0}).find("LigandReceptor.bond_density = -1") == 0);
  CHECK(message(LigandReceptor{.range = 0.0}).find("LigandReceptor.range") == 0);
  CHECK(message(LigandReceptor{.floor = 1.5}).find("LigandReceptor.floor = 1.5") == 0);
  CHECK(message(LigandReceptor{.cutoff = 1.0}).find("LigandReceptor.cutoff") == 0);
  CHECK(message(VanDerWaals{.range = -2.0}).find("VanDerWaals.range = -2 m") == 0);
  CHECK(message(RepulsiveWall{.penalty = 0.0}).find("RepulsiveWall.penalty") == 0);
  CHECK(message(OnRigid{.surface = RigidSphere{.radius = -1.0}}).find("RigidSphere.radius") == 0);
  CHECK(message(LigandReceptor{}).empty());
  auto a = small_ball(2, 1), b = slab(3);
  b.place({0, 0, -1.0 * um});
  LigandReceptor wrong{.points_per_direction = 7};
  CHECK_THROWS_AS(wrong.initialize(a.cloud, a.fields(), b.cloud, b.fields()), ParameterError);
  LigandReceptor unused{};
  CHECK_THROWS_AS(unused.apply(a.fields(), b.fields(), 0.0), Error);
  PointCloud<3> bare;
  bare.positions.resize(3);
  CHECK_THROWS_AS(FacetSurface<3>{bare}, GeometryError);
  CHECK_THROWS_AS(
      FacetSurface<3>{box({.size = Point<3>(1, 1, 1), .cells = {3, 3, 3}, .periodic = {true, false, false}})},
      GeometryError);
}

TEST_CASE("surface: closed, areas, normals, rings") {
  const auto b = slab(4);
  const FacetSurface<3> s(b.cloud);
  CHECK(s.closed);
  double area = 0.0;
  for (const double a : s.nodal_area) area += a;
  CHECK(area == Close{(2 * 16.0 + 4 * 3.2) * um * um, 1e-13});
  for (Index f = 0; f < s.facets.size(); ++f) {
    const Vector3 x = s.interpolate(f, {0.5, 0.5}, b.reference).head<3>() + Vector3(0, 0, 0.4 * um);
    CHECK(s.normal(f, {0.3, 0.6}, b.reference).dot(x) > 0.0);
  }
  CHECK(s.facets_of(s.nodes[0]).size() == 3);  // a corner of the box
  const FacetSurface<2> line(strip().cloud);
  CHECK(line.closed);
  PointCloud<3> open = b.cloud;
  open.facets.pop_back();
  CHECK(!FacetSurface<3>(open).closed);
  for (int n = 1; n <= 4; ++n) {
    const FacetQuadrature<3> quadrature(s, b.reference, n);
    double sum = 0.0, moment = 0.0;
    for (std::size_t q = 0; q < quadrature.size(); ++q) sum += quadrature.area[q];
    for (const auto& p : quadrature.points) moment += p.weight * std::pow(p.local[0], 2 * n - 1);
    CHECK(sum == Close{area, 1e-13});
    CHECK(moment == Close{1.0 / (2.0 * n), 1e-13});
  }
}

TEST_CASE_TEMPLATE("closest points: search, and tracking through large motions, against brute force", T,
                   std::integral_constant<int, 2>, std::integral_constant<int, 3>) {
  constexpr int D = T::value;
  auto master = [] {
    if constexpr (D == 2)
      return small_circle();
    else
      return small_ball(3, 2);
  }();
  const FacetSurface<D> surface(master.cloud);
  Field queries(60);
  ClosestPointTracker<D> tracker;
  double worst = 0.0;
  int rims = 0, interiors = 0, inside = 0;
  const int steps = 60;
  for (int step = 0; step <= steps; ++step) {
    // Rolls by a full turn, slides by two diameters, and wobbles; the queries stand still around its path.
    const double at = double(step) / steps;
    master.place({(4.0 * at - 2.0) * um, 0.0, 0.0}, 0.01 * um, 7, 2.0 * std::numbers::pi * at,
                 D == 2 ? Vector3(0, 0, 1) : Vector3(0.2, 1.0, 0.1));
    for (std::size_t i = 0; i < queries.size(); ++i) {
      queries[i].setZero();
      const double angle = 0.7 * double(i), away = i % 3 == 0 ? 0.75 : 1.3;  // a third of them are passed through
      queries[i].head<3>() =
          Vector3(3.0 * hashed_uniform(1, i), away * std::cos(angle), D == 2 ? 0.0 : away * std::sin(angle)) * um;
    }
    if (step == 0)
      tracker.search(surface, queries, master.position);
    else
      tracker.update(surface, queries, master.position);
    if (step % 6) continue;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const auto& c = tracker.closest()[i];
      worst = std::max(worst, std::abs(std::abs(c.gap) - brute_force_distance(surface, master.position, queries[i])));
      CHECK((surface.interpolate(c.facet, c.local, master.position).template head<3>() - c.point).norm() < 1e-12 * um);
      CHECK(c.normal.norm() == Close{1.0, 1e-12});
      CHECK((queries[i].head<3>() - c.point - c.gap * c.normal).norm() < 1e-7 * std::abs(c.gap) + 1e-15 * um);
      const Vector3 center = Vector3((4.0 * at - 2.0) * um, 0.0, 0.0);
      const double radius = (queries[i].head<3>() - center).norm();
      if (std::abs(radius - 1.0 * um) > 0.1 * um) CHECK((c.gap > 0.0) == (radius > 1.0 * um));
      (c.on_rim ? rims : interiors) += 1;
      inside += c.gap < 0.0;
    }
  }
  CHECK(worst < 1e-9 * um);
  CHECK(rims > 50);
  CHECK(interiors > 50);
  CHECK(inside > 10);
}

TEST_CASE("closest point: warped facet, on facet, edge, corner; also where the distance is not convex") {
  PointCloud<3> cloud;
  cloud.positions = {{0, 0, 0}, {1, 0.1, 0.2}, {-0.1, 1.1, -0.1}, {1.2, 0.9, 0.9}};
  cloud.facets = {{0, 1, 2, 3}};
  const FacetSurface<3> s(cloud);
  Field x;
  for (const auto& p : cloud.positions) x.push_back(pad(p));
  int inside = 0, edge = 0, corner = 0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    const Vector3 q =
        Vector3(0.5 + 1.5 * hashed_uniform(1, i), 0.5 + 1.5 * hashed_uniform(2, i), 3.0 * hashed_uniform(3, i));
    const auto p = project_on_facet(s, 0, x, q);
    const double brute = brute_force_distance(s, x, pad(q));
    CHECK(std::sqrt(p.squared_distance) <= brute * (1.0 + 1e-9));
    CHECK(std::sqrt(p.squared_distance) >=
          brute * (1.0 - 1e-4));  // brute force may stop at a local minimum, never below
    (p.interior() ? inside : p.side >= 0 ? edge : corner) += 1;
  }
  CHECK(inside > 30);
  CHECK(edge > 50);
  CHECK(corner > 20);
}

TEST_CASE("tracking alone, without global searches, finds the nearest facet over a dented surface") {
  auto b = slab(16);
  for (Vector4& x : b.position)
    x[2] -= 0.25 * um * std::exp(-x.head<2>().squaredNorm() / (1.0 * um * um)) * (x[2] > -0.1 * um ? 1.0 : 0.5);
  const FacetSurface<3> s(b.cloud);
  ClosestPointTracker<3> tracked;
  tracked.search_after = 1e9;
  double worst = 0.0;
  for (int step = 0; step <= 40; ++step) {
    Field q;  // 0.1 to 0.6 µm above the undented surface: a range in which the nearest point is unique
    for (std::uint64_t i = 0; i < 200; ++i)
      q.push_back(pad(
          Vector3(hashed_uniform(1, i) - 0.5 + 0.025 * step, hashed_uniform(2, i), 0.35 + 0.25 * hashed_uniform(3, i)) *
          um));
    tracked.update(s, q, b.position);
    ClosestPointTracker<3> fresh;
    fresh.search(s, q, b.position);
    for (std::size_t i = 0; i < q.size(); ++i)
      worst = std::max(worst, std::abs(tracked.closest()[i].gap - fresh.closest()[i].gap));
  }
  CHECK(worst < 1e-12 * um);
}

TEST_CASE("gap sign across edges and corners of a box, and continuity of gap and normal through a facet") {
  auto b = slab(2);
  const FacetSurface<3> s(b.cloud);
  ClosestPointTracker<3> tracker;
  Field q;
  for (std::uint64_t i = 0; i < 300; ++i)
    q.push_back(
        pad(Vector3(3.0 * hashed_uniform(1, i), 3.0 * hashed_uniform(2, i), -0.4 + 1.5 * hashed_uniform(3, i)) * um));
  q.push_back(Vector4(0.3 * um, 0.2 * um, 1e-15 * um, 0.0));
  q.push_back(Vector4(0.3 * um, 0.2 * um, -1e-15 * um, 0.0));
  q.push_back(Vector4(2.0 * um, 2.0 * um, 0.0, 0.0));  // exactly the corner of the box
  tracker.search(s, q, b.position);
  for (std::size_t i = 0; i < 300; ++i) {
    const Vector3 d = q[i].head<3>() / um;
    const Vector3 outside = Vector3(std::abs(d.x()) - 2.0, std::abs(d.y()) - 2.0, std::abs(d.z() + 0.4) - 0.4);
    const double exact = outside.maxCoeff() < 0.0 ? outside.maxCoeff() : outside.cwiseMax(0.0).norm();
    CHECK(tracker.closest()[i].gap / um == Close{exact, 1e-12});
  }
  CHECK(tracker.closest()[300].normal.z() == Close{1.0, 1e-12});
  CHECK(tracker.closest()[301].normal.z() == Close{1.0, 1e-12});
  CHECK(tracker.closest()[301].gap <= 0.0);
  CHECK((tracker.closest()[302].normal - Vector3(1, 1, 1).normalized()).norm() < 1e-12);
}

TEST_CASE("ligand-receptor: forces are the gradient of the energy in the positions of both bodies") {
  double worst = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    RoughPairs pairs(seed);
    auto& [a, b, flat_a, flat_b, round_a, round_b] = pairs;
    LigandReceptor one{}, two{.sampled = ContactSide::both, .points_per_direction = 3};
    worst = std::max(worst, consistency<3>(one, a, b, 100 * seed, 3e-7 * um));
    const auto& closest = one.engine.visit([](const auto& pass) {
      int below = 0, rim = 0;
      for (const auto& c : pass.closest()) below += c.gap < 0.0, rim += c.on_rim && c.gap < 2.0 * um;
      return std::pair(below, rim);
    });
    CHECK(closest.first > 0);
    CHECK(closest.second > 0);
    worst = std::max(worst, consistency<3>(two, a, b, 200 * seed, 3e-7 * um));
    // Sampled on the second body it is the contact of the bodies in the other order.
    LigandReceptor second{.sampled = ContactSide::second}, exchanged{};
    worst = std::max(worst, consistency<3>(second, a, b, 250 * seed, 3e-7 * um));
    auto fa = a.fields(), fb = b.fields();
    const TermEnergy energy = second.apply(fa, fb, 0.0);
    const Field on_a = a.force, on_b = b.force;
    CHECK(second.engine.visit([](const auto& pass) { return pass.quadrature().size(); }) == 4 * b.cloud.facets.size());
    fa = a.fields(), fb = b.fields();
    exchanged.initialize(b.cloud, fb, a.cloud, fa);
    CHECK(exchanged.apply(fb, fa, 0.0).potential == energy.potential);
    CHECK(a.force == on_a);
    CHECK(b.force == on_b);
    CHECK(second.stiffness_rate(fa, fb) == exchanged.stiffness_rate(fb, fa));
    LigandReceptor flat{};
    worst = std::max(worst, consistency<2>(flat, flat_a, flat_b, 300 * seed, 3e-7 * um));
    // Of mobile bonds the area of A's facets counts too: in 3D, in a plane, around an axis.
    LigandReceptor mobile{.area = ContactArea::mobile}, flat_mobile = mobile, round = mobile;
    worst = std::max(worst, consistency<3>(mobile, a, b, 400 * seed, 3e-7 * um));
    worst = std::max(worst, consistency<2>(flat_mobile, flat_a, flat_b, 500 * seed, 3e-7 * um));
    worst = std::max(worst, consistency<2>(round, round_a, round_b, 600 * seed, 3e-7 * um));
  }
  MESSAGE("largest relative error of the work: ", worst);
  CHECK(worst < 1e-6);
}

TEST_CASE("the stiffness of a contact is how its forces change: gaps, normals that turn, areas; sampled on one or both bodies, in 3D, in a plane, around an axis") {
  double worst = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    RoughPairs pairs(seed);
    auto& [a, b, flat_a, flat_b, round_a, round_b] = pairs;
    // Without the jump at the cutoff, over which a difference reaches.
    for (const ContactArea area : {ContactArea::reference, ContactArea::current, ContactArea::mobile})
      for (const ContactSide sampled : {ContactSide::first, ContactSide::second, ContactSide::both}) {
        LigandReceptor in_space{.cutoff = 40.0, .area = area, .sampled = sampled}, in_plane = in_space, around_axis = in_space;
        worst = std::max(worst, stiffness_error<3>(in_space, a, b, 100 * seed, 3e-7 * um));
        worst = std::max(worst, stiffness_error<2>(in_plane, flat_a, flat_b, 200 * seed, 3e-7 * um));
        worst = std::max(worst, stiffness_error<2>(around_axis, round_a, round_b, 300 * seed, 3e-7 * um));
      }
    VanDerWaals in_space{.range = um}, in_plane = in_space;
    worst = std::max(worst, stiffness_error<3>(in_space, a, b, 400 * seed, 1e-6 * um, false));
    worst = std::max(worst, stiffness_error<2>(in_plane, flat_a, flat_b, 500 * seed, 1e-6 * um, false));
  }
  MESSAGE("largest relative error of the change: ", worst);
  CHECK(worst < 1e-6);
}

TEST_CASE("van der Waals with reaction: forces are the gradient; without: the same on A, and its power is external") {
  double worst = 0.0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    auto a = small_ball(3, 2), b = slab(7);
    a.place({0.1 * um, 0.07 * um, 0.97 * um}, 0.03 * um, seed, 0.3, Vector3(1, 0.3, 0.5));
    b.place({0, 0, 0}, 0.02 * um, seed + 10);
    VanDerWaals with{.range = 1.0 * um, .reaction = true}, without{.range = 1.0 * um};
    worst = std::max(worst, consistency<3>(with, a, b, seed, 1e-6 * um));
    a.random_velocities(1.0, 5);
    auto fa = a.fields(), fb = b.fields();
    with.apply(fa, fb, 0.0);
    const Field expected = a.force;
    CHECK(a.total_force().z() < 0.0);
    fa = a.fields(), fb = b.fields();
    without.initialize(a.cloud, fa, b.cloud, fb);
    const TermEnergy e = without.apply(fa, fb, 0.0);
    CHECK(e.potential == 0.0);
    CHECK(e.external_power == Close{a.power(), 1e-13});
    CHECK(b.force_scale() == 0.0);
    CHECK(std::memcmp(expected.data(), a.force.data(), expected.size() * sizeof(Vector4)) == 0);
    CHECK(without.gaps().size() == a.cloud.size());
  }
  MESSAGE("largest relative error of the work: ", worst);
  CHECK(worst < 1e-6);
}

TEST_CASE("van der Waals: the force of eqn (12) above, and no flip below, a plane") {
  auto a = small_ball(2, 1), b = slab(4);
  a.place({0, 0, 0.4 * um});
  VanDerWaals law{.strength = 100.0, .range = 2.0 * um};
  auto fa = a.fields(), fb = b.fields();
  law.initialize(a.cloud, fa, b.cloud, fb);
  law.apply(fa, fb, 0.0);
  for (std::size_t i = 0; i < a.cloud.size(); ++i) {
    const double z = a.position[i].z();
    if (z < -0.35 * um) continue;  // below, the bottom of the slab is nearer
    CHECK(law.gaps()[i] / um == Close{z / um, 1e-12});
    CHECK((a.force[i] - Vector4(0, 0, -a.mass[i] * 100.0 * std::exp(-std::max(z, 0.0) / (2.0 * um)), 0)).norm() <
          1e-12 * a.mass[i] * 100.0);
  }
  CHECK(law.stiffness_rate(fa, fb) == Close{100.0 / (2.0 * um), 1e-12});
}

TEST_CASE("momentum and angular momentum of a pair are conserved to round-off") {
  for (const ContactSide sampled : {ContactSide::first, ContactSide::second, ContactSide::both})
    for (const ContactArea area : {ContactArea::reference, ContactArea::current, ContactArea::mobile}) {
      auto a = small_ball(3, 2), b = slab(7);
      a.place({0.1 * um, 0.07 * um, 0.99 * um}, 0.03 * um, 5, 0.3, Vector3(1, 0.3, 0.5));
      b.place({0, 0, 0}, 0.03 * um, 6);
      Combined both{LigandReceptor{.area = area, .sampled = sampled}, VanDerWaals{.reaction = true}};
      auto fa = a.fields(), fb = b.fields();
      both.initialize(a.cloud, fa, b.cloud, fb);
      both.apply(fa, fb, 0.0);
      const double scale = a.force_scale() + b.force_scale();
      CHECK(scale > 0.0);
      CHECK((a.total_force() + b.total_force()).norm() < 1e-12 * scale);
      CHECK((a.total_torque() + b.total_torque()).norm() < 1e-12 * scale * 2.0 * um);
      CHECK(both.stiffness_rate(fa, fb) > 0.0);
    }
}

TEST_CASE("flat facets parallel to a plane: exact forces, reference and current area") {
  // Two boxes: the upper one hangs a gap above the lower, and is stretched in x by 1.5.
  auto a = TestBody<3>(box({.size = Point<3>(um, um, um), .cells = {2, 2, 2}}));
  auto b = slab(5);
  for (const double gap : {-20.0 * nm, 20.0 * nm, 60.0 * nm, 129.1 * nm, 400.0 * nm}) {
    for (std::size_t i = 0; i < a.cloud.size(); ++i) {
      const Vector4 X = a.reference[i];
      a.position[i] = Vector4(1.5 * (X[0] - 0.5 * um), X[1] - 0.5 * um, 1e3 * X[2] + gap, 0.0);  // sides far away
    }
    const LigandReceptorLaw law{};
    for (const ContactArea area : {ContactArea::reference, ContactArea::current}) {
      LigandReceptor contact{.cutoff = 20.0, .area = area};
      auto fa = a.fields(), fb = b.fields();
      contact.initialize(a.cloud, fa, b.cloud, fb);
      // Only the bottom facets count: the side facets' quadrature points are > 100 µm above.
      const TermEnergy e = contact.apply(fa, fb, 0.0);
      const double exact = (area == ContactArea::current ? 1.5 : 1.0) * um * um;
      CHECK(a.total_force().z() == Close{exact * law.traction(gap), 1e-11});
      CHECK(e.potential == Close{exact * law.potential(gap), 1e-11});
      if (area == ContactArea::reference) {
        OnRigid rigid{.law = law, .surface = RigidPlane{}};
        fa = a.fields();
        rigid.initialize(a.cloud, fa);
        CHECK(rigid.apply(fa, 0.0).potential == Close{exact * law.potential(gap), 1e-11});
        CHECK(rigid.force().z() == Close{-exact * law.traction(gap), 1e-11});
        CHECK(a.total_force().z() == Close{exact * law.traction(gap), 1e-11});
        // Stiffness: the row sum of a node of the bottom over its mass.
        CHECK(rigid.stiffness_rate(fa) > 0.0);
      }
    }
  }
}

TEST_CASE("current area: power of the changing area closes the balance") {
  auto a = small_ball(3, 2), b = slab(7);
  a.place({0.1 * um, 0.07 * um, 1.05 * um}, 0.02 * um, 5);
  b.place({0, 0, 0}, 0.02 * um, 6);
  a.random_velocities(1.0, 1);
  b.random_velocities(1.0, 2);
  LigandReceptor contact{.area = ContactArea::current};
  auto fa = a.fields(), fb = b.fields();
  contact.initialize(a.cloud, fa, b.cloud, fb);
  const TermEnergy e = contact.apply(fa, fb, 0.0);
  const double power = a.power() + b.power();
  const Field xa = a.position, xb = b.position;
  const auto energy = [&](double s) {
    for (std::size_t i = 0; i < xa.size(); ++i) a.position[i] = xa[i] + s * a.velocity[i];
    for (std::size_t i = 0; i < xb.size(); ++i) b.position[i] = xb[i] + s * b.velocity[i];
    return contact.apply(a.fields(), b.fields(), 0.0).potential;
  };
  const double h = 1e-6 * um, slope = (8.0 * (energy(h) - energy(-h)) - energy(2 * h) + energy(-2 * h)) / (12.0 * h);
  CHECK(e.external_power != 0.0);
  CHECK(power - e.external_power == Close{-slope, 1e-7});
}

TEST_CASE("a fine sphere near a plane feels 2 pi R times the energy per area (Derjaguin)") {
  // Exact for the sphere: F = −dU/dD of U = ∫ 2πR Φ(D + h) dh over heights h in [0, 2R] (areas of zones of a sphere).
  const double R = 10.0 * um;
  double last = 1.0;
  for (const int refine : {1, 2}) {
    TestBody<3> a(ball({.radius = R, .core_radius = 5.0 * um, .core_cells = 24 * refine, .shells = 2}));
    const LigandReceptorLaw law{.range = 0.8 * um, .cutoff = 10.0};
    const double D = 0.9 * um;
    a.place({0, 0, R + D});
    OnRigid plate{.law = law};
    auto fa = a.fields();
    plate.initialize(a.cloud, fa);
    plate.apply(fa, 0.0);
    const double exact = 2.0 * std::numbers::pi * R * law.potential(D);  // Φ(D + 2R) = 0: beyond the cutoff
    const double error = std::abs(a.total_force().z() / exact - 1.0);
    MESSAGE("relative error with ", 24 * refine, " cells: ", error);
    CHECK(a.total_force().z() < 0.0);
    if (refine == 2) CHECK(error < 0.4 * last);
    last = error;
  }
  CHECK(last < 0.01);
}

TEST_CASE("rigid surfaces: gradient, moving plate's power, recorded force") {
  auto a = small_ball(3, 2);
  a.place({0, 0, 0.85 * um}, 0.02 * um, 4);
  a.random_velocities(1.0, 8);
  const auto check = [&](auto term, double t0) {
    auto fa = a.fields();
    term.initialize(a.cloud, fa);
    const TermEnergy e = term.apply(fa, t0);
    CHECK((a.total_force() + term.force()).norm() < 1e-13 * a.force_scale());
    const double power = a.power();
    const Field x = a.position;
    const auto energy = [&](double s) {
      for (std::size_t i = 0; i < x.size(); ++i) a.position[i] = x[i] + s * a.velocity[i];
      return term.apply(a.fields(), t0 + s).potential;
    };
    const double h = 1e-6 * um, slope = (8.0 * (energy(h) - energy(-h)) - energy(2 * h) + energy(-2 * h)) / (12.0 * h);
    a.position = x;
    CHECK(power != 0.0);
    // What the body gains is what the energy loses and the moving surface gives.
    CHECK(power == Close{-slope + e.external_power, 1e-6});
  };
  check(RigidPlate{.point = Vector3(0, 0, 0),
                   .normal = Vector3(0.1, 0, 1),
                   .velocity = Vector3(0.2, 0.1, 0.5),
                   .law = LigandReceptorLaw{}},
        0.0);
  check(RigidPlate{.velocity = Vector3(0, 0, 0.3)}, 0.0);
  check(
      OnRigid{.law = LigandReceptorLaw{},
              .surface =
                  RigidSphere{.center = Vector3(0, 0, -2.0 * um), .radius = 2.0 * um, .velocity = Vector3(0, 0, -0.7)}},
      0.0);
  check(OnRigid{.law = LigandReceptorLaw{},
                .surface = Moving<RigidPlane>{
                    .displacement = [](double t) { return Vector3(0, 0, 0.01 * um * std::sin(1e6 * t)); },
                    .velocity = [](double t) { return Vector3(0, 0, 1e4 * um * std::cos(1e6 * t)); }}},
        0.4e-6);
  OnRigid incomplete{.surface = Moving<RigidPlane>{}};
  CHECK_THROWS_AS(incomplete.validate(), ParameterError);
}

TEST_CASE("the stiffness rate bounds the largest eigenvalue of the pair") {
  auto a =
      TestBody<3>(box({.size = Point<3>(um, um, um), .cells = {1, 1, 1}, .origin = Point<3>(-0.5 * um, -0.5 * um, 0)}));
  auto b = TestBody<3>(
      box({.size = Point<3>(4 * um, 4 * um, um), .cells = {1, 1, 1}, .origin = Point<3>(-2 * um, -2 * um, -um)}));
  a.place({0, 0, 40.0 * nm});
  LigandReceptor contact{};
  auto fa = a.fields(), fb = b.fields();
  contact.initialize(a.cloud, fa, b.cloud, fb);
  contact.apply(fa, fb, 0.0);
  const double bound = contact.stiffness_rate(fa, fb);
  const std::size_t n = a.cloud.size() + b.cloud.size();
  const auto rows = static_cast<Eigen::Index>(n);
  Eigen::MatrixXd K(rows, rows), M = Eigen::MatrixXd::Zero(rows, rows);  // z components
  const auto z_forces = [&](Eigen::Index column, double h) {
    const std::size_t c = static_cast<std::size_t>(column);
    double& z = c < a.cloud.size() ? a.position[c][2] : b.position[c - a.cloud.size()][2];
    z += h;
    contact.apply(a.fields(), b.fields(), 0.0);
    z -= h;
    Eigen::VectorXd f(rows);
    for (std::size_t i = 0; i < n; ++i)
      f[static_cast<Eigen::Index>(i)] = i < a.cloud.size() ? a.force[i][2] : b.force[i - a.cloud.size()][2];
    return f;
  };
  const double h = 1e-5 * um;
  for (Eigen::Index c = 0; c < Eigen::Index(n); ++c) {
    K.col(c) = -(z_forces(c, h) - z_forces(c, -h)) / (2.0 * h);
    const std::size_t i = static_cast<std::size_t>(c);
    M(c, c) = i < a.cloud.size() ? a.mass[i] : b.mass[i - a.cloud.size()];
  }
  double omega2 = 0.0;  // power iteration of M⁻¹K
  Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(Eigen::Index(n), 1.0, 2.0);
  for (int i = 0; i < 500; ++i) {
    v = M.diagonal().cwiseInverse().cwiseProduct(K * v);
    omega2 = v.norm();
    v /= omega2;
  }
  CHECK(bound >= omega2 * (1.0 - 1e-6));
  CHECK(bound < 4.0 * omega2);
}

TEST_CASE("gaps at surface particles, and first touch") {
  auto a = small_ball(3, 2), b = slab(4);
  a.place({0, 0, 1.2 * um});
  SurfaceGaps<3> gaps;
  gaps.initialize(a.cloud, a.fields(), b.cloud, b.fields());
  FirstTouch touch{.capture_distance = 100.0 * nm};
  CHECK(touch.update(gaps.gaps()).empty());
  a.place({0, 0, 1.0 * um});
  const auto first = touch.update(gaps.measure(a.fields(), b.fields()));
  CHECK(!first.empty());
  std::size_t on_surface = 0;
  for (std::size_t i = 0; i < a.cloud.size(); ++i) {
    const bool surface = std::abs(a.reference[i].norm() - 1.0 * um) < 1e-9 * um;
    on_surface += surface;
    if (!surface) {
      CHECK(std::isinf(gaps.gaps()[i]));
      continue;
    }
    CHECK(gaps.gaps()[i] == Close{a.position[i].z(), 1e-11});
    CHECK((gaps.normals()[i] - Vector4::UnitZ()).norm() < 1e-12);
    CHECK((std::find(first.begin(), first.end(), i) != first.end()) == (a.position[i].z() <= 100.0 * nm));
  }
  CHECK(on_surface == gaps.surface().nodes.size());
  CHECK(touch.update(gaps.gaps()).empty());
}

TEST_CASE(
    "same bits for one and two threads, for a fresh and a tracked contact, and without motion that is not finite") {
  const int threads = thread_count();
  const auto run = [](int count, bool fresh) {
    set_thread_count(count);
    auto a = small_ball(4, 2), b = slab(9);
    Combined contact{LigandReceptor{}, VanDerWaals{.reaction = true}};
    contact.initialize(a.cloud, a.fields(), b.cloud, b.fields());
    for (int step = 0; step < 40; ++step) {
      a.place({0.02 * um * step, 0.0, (1.4 - 0.012 * step) * um}, 0.02 * um, 3, 0.03 * step, Vector3(0, 1, 0));
      b.place({0, 0, 0}, 0.005 * um, 4);
      if (fresh && step < 39) continue;
      auto fa = a.fields(), fb = b.fields();
      if (fresh) contact.initialize(a.cloud, fa, b.cloud, fb);
      contact.apply(fa, fb, 0.0);
    }
    Field all = a.force;
    all.insert(all.end(), b.force.begin(), b.force.end());
    return all;
  };
  const Field one = run(1, false), two = run(2, false), fresh = run(2, true);
  set_thread_count(threads);
  CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(Vector4)) == 0);
  CHECK(one == fresh);
  auto a = small_ball(2, 1), b = slab(3);
  a.place({0, 0, 1.05 * um});
  LigandReceptor contact{};
  contact.initialize(a.cloud, a.fields(), b.cloud, b.fields());
  a.position[a.cloud.facets[0][0]][0] = std::nan("");
  CHECK_NOTHROW(contact.apply(a.fields(), b.fields(), 0.0));
  b.position[b.cloud.facets[0][0]][0] = std::nan("");
  CHECK_NOTHROW(contact.apply(a.fields(), b.fields(), 0.0));
}

namespace {
/// A user's own law in the documentation's length: a spring of finite reach.
struct Spring {
  double stiffness_per_area = 1e9;
  double length = 2e-7;
  void validate() const { require_positive("Spring.length", length, "m"); }
  [[nodiscard]] double reach() const { return length; }
  [[nodiscard]] double potential(double g) const {
    return g < length ? 0.5 * stiffness_per_area * (length - g) * (length - g) : 0.0;
  }
  [[nodiscard]] double traction(double g) const { return g < length ? stiffness_per_area * (length - g) : 0.0; }
  [[nodiscard]] double stiffness(double g) const { return g < length ? stiffness_per_area : 0.0; }
};
}  // namespace

TEST_CASE("a user's own gap law") {
  auto a = small_ball(3, 2), b = slab(6);
  a.place({0.1 * um, 0.07 * um, 1.0 * um}, 0.02 * um, 1);
  b.place({0, 0, 0}, 0.01 * um, 2);
  SurfaceContact contact{.law = Spring{}};
  static_assert(Contact<decltype(contact), 3>);
  CHECK(consistency<3>(contact, a, b, 9, 1e-6 * um) < 1e-7);
}

}  // namespace contact_test
