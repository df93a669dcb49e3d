// Simulations divided among ranks against the same ones in one process: the same bits of everything that a checkpoint keeps; in the
// order of the ranks the same but for round-off.
//
//   mpirun -np 4 --oversubscribe same_bits [options of doctest]
//
// All ranks run all cases, in the same order. Rank 0 computes alone, too, and compares.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <unistd.h>

#include <tactoid/boundary/all.hpp>
#include <tactoid/contact/all.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/director/all.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/integrator/subcycled_central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/mpi.hpp>
#include <tactoid/observe/motion.hpp>
#include <tactoid/observe/stress.hpp>
#include <tactoid/output/body_frame.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/body.hpp>
#include <tactoid/simulation/contact_anchoring.hpp>
#include <tactoid/simulation/implicit_problem.hpp>
#include <tactoid/simulation/observer.hpp>
#include <tactoid/simulation/simulation.hpp>
#include <tactoid/simulation/static_problem.hpp>

using namespace tactoid;

namespace {

constexpr double um = 1e-6;

mpi::Session* session = nullptr;
mpi::Partitioner partitioner = mpi::partition_by_metis;

/// Every chunk to a rank that has nothing to do with its place.
std::vector<int> scattered(const mpi::ChunkGraph& graph, int ranks) {
  std::vector<int> owner(graph.size());
  for (std::size_t c = 0; c < owner.size(); ++c) owner[c] = static_cast<int>((c * 7 + c / 3) % static_cast<std::size_t>(ranks));
  return owner;
}

/// What `compute(simulation)` returns in one process, on rank 0; nothing on the others.
template <class Compose, class Compute>
SavedState computed_alone(const Compose& compose, const Compute& compute) {
  if (session->rank() != 0) return {};
  Ranks::current = nullptr;
  auto simulation = compose();
  CHECK(simulation.decomposition() == nullptr);
  SavedState alone = compute(simulation);
  Ranks::current = session;
  return alone;
}

void check_same(const SavedState& alone, const SavedState& divided) {
  if (session->rank() != 0) return;
  REQUIRE(alone.size() == divided.size());
  for (const auto& [name, array] : alone) {
    const auto found = divided.find(name);
    INFO("state: ", name);
    REQUIRE(found != divided.end());
    CHECK(array == found->second);
  }
}

/// Bodies that are composed while it lives are set up in parts.
struct DividedSetUp {
  DividedSetUp() { session->set_up = SetUp::divided; }
  ~DividedSetUp() { session->set_up = SetUp::whole; }
};

/// Runs `compute(simulation)`, on what `compose()` gives, divided, set up whole and in parts; and on rank 0 alone. What it returns must be the same, to the bit.
template <class Compose, class Compute>
void compare(const Compose& compose, const Compute& compute, const mpi::Partitioner& by = mpi::partition_by_metis) {
  partitioner = by;
  const SavedState alone = computed_alone(compose, compute);
  {
    auto simulation = compose();
    CHECK((simulation.decomposition() != nullptr) == (session->size() > 1));
    check_same(alone, compute(simulation));
  }
  const DividedSetUp set_up;
  if constexpr (decltype(compose())::velocity_lag > 0.0) {
    auto simulation = compose();
    check_same(alone, compute(simulation));
  } else if (session->size() > 1) {
    CHECK_THROWS_AS((void)compose(), ParameterError);
  }
}

/// Largest difference of two arrays, over the largest number in them.
double difference(const StateArray& a, const StateArray& b) {
  if (a == b) return 0.0;
  if (a.shape != b.shape) return 1.0;
  double off = 0.0, size = 0.0;
  for (std::size_t k = 0; k < a.values.size(); ++k) {
    off = std::max(off, std::abs(a.values[k] - b.values[k]));
    size = std::max(size, std::abs(a.values[k]));
  }
  return off / size;
}

/// The same in the order of the ranks, where each row is evaluated once: what it returns must be the same but for `tolerance`, and to the bit in a second run. Set up in parts, bodies
/// are divided each for itself, and numbers are the same but for `tolerance`, too.
template <class Compose, class Compute>
void compare_by_rank(const Compose& compose, const Compute& compute, double tolerance, const mpi::Partitioner& by = mpi::partition_by_metis) {
  partitioner = by;
  const SavedState alone = computed_alone(compose, compute);
  session->sum_order = SumOrder::of_ranks;
  const auto divided = [&] {
    auto simulation = compose();
    if (const auto* parts = dynamic_cast<const mpi::DividedBodies*>(simulation.decomposition())) {
      double pairs = static_cast<double>(parts->evaluated_pairs());
      mpi::reduce(MPI_COMM_WORLD, {&pairs, 1}, {});
      CHECK(pairs == static_cast<double>(simulation.pairs()));
    }
    return compute(simulation);
  };
  const SavedState first = divided(), second = divided();
  SavedState in_parts = first;
  if constexpr (decltype(compose())::velocity_lag > 0.0) {
    const DividedSetUp set_up;
    in_parts = divided();
  }
  session->sum_order = SumOrder::of_one_process;
  if (session->rank() != 0) return;
  for (const SavedState* state : std::initializer_list<const SavedState*>{&first, &second, &in_parts}) {
    REQUIRE(alone.size() == state->size());
    for (const auto& [name, array] : alone) {
      INFO("state: ", name);
      REQUIRE(state->contains(name));
      CHECK(difference(array, state->at(name)) <= (session->size() == 1 ? 0.0 : tolerance));
    }
  }
  for (const auto& [name, array] : first) {
    INFO("state: ", name);
    CHECK(array == second.at(name));
  }
}

/// Everything of a simulation, and what its observers measure.
template <class S>
SavedState whole(S& simulation) {
  SavedState state = save_state(simulation);
  StateWriter more(state);
  const StressFields stress = stress_fields(simulation.template body<0>());
  more("measured/stress", stress.effective_stress);
  more("measured/position", std::vector<Vector4>(simulation.template particles<0>().position.begin(), simulation.template particles<0>().position.end()));
  more("measured/velocity", simulation.template velocity<0>());
  more("measured/momentum", motion<0>(simulation).momentum);
  more("measured/step", simulation.largest_stable_time_step());
  more("measured/pairs", simulation.pairs());
  return state;
}

/// Steps as the integrator chooses them.
template <class S>
void take(S& simulation, std::size_t steps) {
  for (const std::size_t end = simulation.steps() + steps; simulation.steps() < end;)
    simulation.run(simulation.time() + 0.4 * simulation.largest_stable_time_step());
}

template <class Body>
void shake(Body& body, double speed) {
  for (std::size_t i = 0; i < body.size(); ++i)
    for (int k = 0; k < Body::dimension; ++k) body.velocity[i][k] = speed * detail::hashed_uniform(7, 3 * i + static_cast<std::size_t>(k));
}

auto slab(PointCloud<3> cloud, std::size_t points_per_chunk, double stiffness = 1.0) {
  YangVisco<> law;
  law.elastic = law.elastic.scaled(stiffness);
  return Body{"slab", std::move(cloud), Rkpm<3>{}, NodalCentroids{.points_per_chunk = points_per_chunk}, Materials{Region{"body", law}}};
}

/// So large that a coarse space helps to make it consistent.
auto large_slab() { return slab(jitter(box({.size = Point<3>(1.9 * um, 1.0 * um, 1.0 * um), .cells = {29, 14, 14}}), 0.1), 0); }

/// A free body under surface tension.
template <class Body>
auto simulation_of(Body body) {
  return Simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{on<0>(SurfaceTension{})}, CentralDifference{.safety = 0.5}};
}
auto block() {
  Body body = slab(jitter(box({.size = Point<3>(1.0 * um, 1.0 * um, 1.0 * um), .cells = {7, 7, 7}}), 0.1), 24);
  shake(body, 20.0);
  return simulation_of(std::move(body));
}

/// A cell with everything on, near enough to its substrate to stick to it; so large that METIS cuts it, and no rank needs all of it.
template <class Integrator>
auto cell(const Integrator& integrator, double stiffness = 1.0) {
  Body body{"cell",
            ball({.radius = 5.0 * um, .core_radius = 2.0 * um, .core_cells = 4, .shells = 4, .center = {0.0, 0.0, 5.15 * um}}),
            Rkpm<3>{},
            NodalCentroids{.points_per_chunk = 16},
            Materials{Region{"nucleus", ModifiedMooneyRivlin{}}, Region{"cytoplasm", NematicGel<>{}}},
            DirectorField<>{},
            RandomDirector{{.correlation_length = 2.0 * um, .seed = 2}}};
  Body ground = slab(disc({.radius = 8.0 * um, .height = 3.0 * um, .core_cells = 4, .rings = 2, .layers = 4}), 16, stiffness);
  const auto bottom = select(ground.cloud(), [](const Point<3>& X) { return X[2] < -2.99 * um; });
  return Simulation{Bodies{std::move(body), std::move(ground)},
                    Contacts{between<0, 1>(LigandReceptor{}), between<0, 1>(VanDerWaals{}), between<0, 1>(ContactAnchoring{})},
                    Boundaries{on<0>(SurfaceTension{}), on<1>(fixed(bottom))}, integrator};
}

/// A graded plate in the plane that is pulled, by a quadrature whose unknowns are values, or coefficients.
template <class Quadrature>
auto plate(const Quadrature& quadrature) {
  PointCloud<2> cloud = rectangle({.size = {2.0 * um, 1.0 * um}, .cells = {16, 8}});
  const auto left = select(cloud, [](const Point<2>& X) { return X[0] < 1e-9; });
  const auto right = select(cloud, [](const Point<2>& X) { return X[0] > 1.999 * um; });
  Body body{"plate", std::move(cloud), Rkpm<2>{}, quadrature,
            Materials{Region{"body", Graded{[](const Vector3& X) { return NeoHookean::from_young(1e4 * (1.0 + X[0] / um), 0.3); }}}}};
  shake(body, 0.1);
  return Simulation{Bodies{std::move(body)}, Contacts{},
                    Boundaries{on<0>(fixed(left)),
                               on<0>(PrescribedMotion{right, [](const Vector3&, double t) { return Vector3(0.1 * t, 0.0, 0.0); }, {true, false, false}}),
                               on<0>(BodyForce<>{.acceleration = Vector3(0.0, 1e5, 0.0)})},
                    CentralDifference{.safety = 0.5}};
}

/// Leaves the state to who sets it: to look at residuals.
struct NoSteps {
  static constexpr bool synchronous = true;
  template <class System>
  void initialize(System&) const {}
  template <class System>
  void step(System& system, double until) const { system.accept_state(until - system.time(), {}); }
};

}  // namespace

TEST_CASE("A free block") {
  const auto compute = [](auto& simulation) {
    const Vector3 before = motion<0>(simulation).momentum;
    double scale = 0.0;
    for (std::size_t i = 0; i < simulation.template body<0>().size(); ++i)
      scale += simulation.template body<0>().masses()[i] * simulation.template body<0>().velocity[i].norm();
    take(simulation, 300);
    CHECK(simulation.steps() == 300);
    CHECK((motion<0>(simulation).momentum - before).norm() < 1e-11 * scale);
    return whole(simulation);
  };
  compare(block, compute);
  compare(block, compute, scattered);
  compare_by_rank(block, compute, 1e-11);
}

TEST_CASE("A free block whose gradients are stored in single precision") {
  const auto compose = [] {
    Body body{"block", jitter(box({.size = Point<3>(1.0 * um, 1.0 * um, 1.0 * um), .cells = {7, 7, 7}}), 0.1), Rkpm<3>{},
              stored_as<float>(NodalCentroids{.points_per_chunk = 24}), Materials{Region{"body", YangVisco<>{}}}};
    shake(body, 20.0);
    return simulation_of(std::move(body));
  };
  const auto compute = [](auto& simulation) {
    take(simulation, 60);
    return whole(simulation);
  };
  compare(compose, compute);
  compare_by_rank(compose, compute, 1e-11);
}

TEST_CASE("Memory of the table falls with the number of ranks, and all rows are somewhere") {
  auto simulation = block();
  const auto& body = simulation.body<0>();
  const long here = static_cast<long>(body.table().entries.size()), all = static_cast<long>(body.table().pairs());
  if (session->size() == 1) CHECK(here == all);
  else CHECK(session->largest(here) < all);
  CHECK(simulation.pairs() == body.table().pairs());
}

TEST_CASE("A body so large that its gradients are made consistent with the help of smooth fields") {
  const auto compose = [] {
    Body body = large_slab();
    shake(body, 20.0);
    CHECK(body.size() >= detail::particles_for_coarse_space);
    return simulation_of(std::move(body));
  };
  const auto compute = [](auto& simulation) {
    take(simulation, 3);
    return whole(simulation);
  };
  compare(compose, compute);
  compare(compose, compute, scattered);
}

TEST_CASE("Each rank makes the rows that it needs, with the bits of one process") {
  partitioner = mpi::partition_by_metis;
  Ranks::current = nullptr;
  const Body alone = large_slab();
  Ranks::current = session;
  const DividedSetUp set_up;
  const Body parts = large_slab();
  const PointTable &all = alone.table(), &here = parts.table();
  CHECK(here.pairs() == all.pairs());
  CHECK((here.size() < all.size()) == (session->size() > 1));
  CHECK(parts.masses() == alone.masses());
  CHECK(parts.nodal_volumes() == alone.nodal_volumes());
  CHECK(here.color_offsets == all.color_offsets);
  std::size_t different = 0, rows = 0;
  for (std::size_t q = 0; q < all.points(); ++q) {
    const bool evaluated = parts.share() == nullptr || parts.share()->evaluated[q] != 0;
    CHECK(here.row(q).empty() == !evaluated);
    if (!evaluated) continue;
    ++rows;
    for (std::size_t e = 0; e < all.row(q).size(); ++e) {
      const TableEntry a = all.row(q)[e], b = here.row(q)[e];
      if (a.particle != b.particle || a.vector() != b.vector()) ++different;
    }
    for (std::size_t e = 0; e < all.bonds(q).size(); ++e) different += all.bonds(q)[e] != here.bonds(q)[e] ? 1 : 0;
    different += all.stabilization_scale[q] != here.stabilization_scale[q] ? 1 : 0;
  }
  CHECK(different == 0);
  CHECK(rows >= all.points() / static_cast<std::size_t>(session->size()));
}

TEST_CASE("A cloud that cannot be sampled is refused on all ranks, whichever finds it") {
  const DividedSetUp set_up;
  for (const int cells : {7, 17}) {  // the second one large enough for a coarse space
    CAPTURE(cells);
    PointCloud<3> cloud = box({.size = Point<3>(1.0 * um, 1.0 * um, 1.0 * um), .cells = {cells, cells, cells}});
    cloud.positions.back() += Point<3>::Constant(0.42 * um / cells);  // a corner
    const auto told = [&] {
      try {
        Body body{"slab", cloud, Rkpm<3>{}, NodalCentroids{.condition_limit = 35.0, .points_per_chunk = 24}, Materials{Region{"body", NeoHookean::from_young(1e4, 0.3)}}};
      } catch (const GeometryError& error) {
        return std::string(error.what());
      }
      return std::string();
    };
    const std::string divided = told();
    CHECK(divided.find("condition number") != std::string::npos);
    CHECK_NOTHROW(session->require_same("message", divided));
    Ranks::current = nullptr;
    const std::string alone = told();
    Ranks::current = session;
    const auto point = [](const std::string& text) { return std::stoul(text.substr(text.find("point ") + 6)); };
    CHECK(point(alone) > cloud.size() / 2);  // near the corner
    CHECK(point(divided) > cloud.size() / 2);
  }
}

TEST_CASE("Supports beyond half a period are refused on all ranks, as in one process") {
  const DividedSetUp set_up;
  const auto body = [] {
    return Body{"slab", box({.size = Point<3>(1.0 * um, 1.0 * um, 1.0 * um), .cells = {7, 7, 7}, .periodic = {true, false, false}}), Rkpm<3>{.support = 4.0}, NodalCentroids{.points_per_chunk = 24},
                Materials{Region{"body", NeoHookean::from_young(1e4, 0.3)}}};
  };
  CHECK_THROWS_AS((void)body(), ParameterError);
}

TEST_CASE("A periodic bar, a ring and a body of one chunk") {
  const auto steps = [](auto& simulation) {
    take(simulation, 40);
    return whole(simulation);
  };
  const auto shaken = [](auto body) {
    shake(body, 1.0);
    return Simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{}, CentralDifference{.safety = 0.5}};
  };
  const Materials rubber{Region{"body", NeoHookean::from_young(1e4, 0.3)}};
  const auto bar = [&] {
    return shaken(Body{"bar", jitter(box({.size = Point<3>(2.0 * um, 0.5 * um, 0.5 * um), .cells = {14, 4, 4}, .periodic = {true, false, false}}), 0.1), Rkpm<3>{},
                       NodalCentroids{.points_per_chunk = 24}, rubber});
  };
  const auto ring = [&] {
    return shaken(Body{"ring", meridian(Disc{.radius = 1.0 * um, .height = 0.5 * um, .core_cells = 8, .rings = 4, .layers = 6}), Rkpm<2>{}, NodalCentroids{.points_per_chunk = 16}, rubber});
  };
  const auto small = [&] { return shaken(Body{"small", box({.size = Point<3>(1.0 * um, 1.0 * um, 1.0 * um), .cells = {3, 3, 3}}), Rkpm<3>{}, NodalCentroids{}, rubber}); };
  compare(bar, steps, scattered);
  compare(ring, steps, scattered);
  compare(small, steps);
  compare_by_rank(small, steps, 1e-11);
}

TEST_CASE("A cell on a substrate") {
  const auto compose = [] { return cell(CentralDifference{}); };
  const auto compute = [](auto& simulation) {
    take(simulation, 80);
    const auto gaps = simulation.template contact<1>().gaps();
    CHECK(*std::min_element(gaps.begin(), gaps.end()) < 0.1 * um);  // they touch
    return whole(simulation);
  };
  compare(compose, compute);
  compare(compose, compute, scattered);
  compare_by_rank(compose, compute, 1e-11);
  compare_by_rank(compose, compute, 1e-11, scattered);
}

TEST_CASE("Contacts on either side, by each measure of the area, and several in one") {
  const auto compose = [] {
    Body upper = slab(jitter(box({.size = Point<3>(2.0 * um, 2.0 * um, 1.0 * um), .cells = {8, 7, 4}, .origin = {-0.9 * um, -1.1 * um, 0.08 * um}}), 0.1), 16);
    Body lower = slab(jitter(box({.size = Point<3>(2.4 * um, 2.2 * um, 1.0 * um), .cells = {7, 8, 4}, .origin = {-1.2 * um, -1.1 * um, -1.0 * um}}), 0.1), 16);
    shake(upper, 2.0);
    return Simulation{Bodies{std::move(upper), std::move(lower)},
                      Contacts{between<0, 1>(LigandReceptor{.area = ContactArea::current, .sampled = ContactSide::both}), between<1, 0>(LigandReceptor{.area = ContactArea::mobile}),
                               between<0, 1>(Combined{VanDerWaals{}, SurfaceContact<RepulsiveWall>{.sampled = ContactSide::second}}), between<1, 0>(VanDerWaals{.reaction = true})},
                      Boundaries{}, CentralDifference{}};
  };
  const auto compute = [](auto& simulation) {
    take(simulation, 40);
    return whole(simulation);
  };
  compare(compose, compute);
  compare_by_rank(compose, compute, 1e-11);
  compare_by_rank(compose, compute, 1e-11, scattered);
}

TEST_CASE("A cell and a substrate in steps of their own") {
  const auto compose = [] { return cell(SubcycledCentralDifference{CentralDifference{}, 8}, 1000.0); };
  const auto compute = [](auto& simulation) {
    simulation.run(60.0 * simulation.largest_stable_time_step());
    const auto& report = simulation.integrator().report;
    CHECK(2 * *std::min_element(report.body_steps.begin(), report.body_steps.end()) <= report.steps);
    return whole(simulation);
  };
  compare(compose, compute);
  compare(compose, compute, scattered);
  compare_by_rank(compose, compute, 1e-11);
}

TEST_CASE("A state goes from several ranks to one process and back") {
  const auto compose = [] { return cell(CentralDifference{}); };
  auto simulation = compose();
  take(simulation, 20);
  const SavedState saved = save_state(simulation);
  compare(compose, [&](auto& continued) {
    restore_state(continued, saved);
    SavedState state = whole(continued);
    take(continued, 30);
    for (auto& [name, array] : whole(continued)) state["later/" + name] = array;
    return state;
  }, scattered);
}

TEST_CASE("A graded plate with prescribed motion and body force") {
  const auto compute = [](auto& simulation) {
    take(simulation, 200);
    return whole(simulation);
  };
  compare([] { return plate(NodalCentroids{.points_per_chunk = 16}); }, compute);
  compare([] { return plate(NodalCentroids{.points_per_chunk = 16}); }, compute, scattered);
  compare([] { return plate(GaussCells<2>{}); }, compute, scattered);
  compare_by_rank([] { return plate(NodalCentroids{.points_per_chunk = 16}); }, compute, 1e-11, scattered);
  compare_by_rank([] { return plate(GaussCells<2>{}); }, compute, 1e-11);
}

TEST_CASE("The residual of an implicit step") {
  const auto compute = [](auto& simulation) {
    auto problem = simulation.implicit_problem();
    Eigen::VectorXd z, rate, R;
    problem.state(z, rate);
    const Eigen::VectorXd start = z, scale = problem.scale();
    SavedState state;
    StateWriter writer(state);
    for (int step = 0; step < 2; ++step) {
      for (Eigen::Index k = 0; k < z.size(); ++k)
        z[k] += 1e-3 * scale[k] * detail::hashed_uniform(11, static_cast<std::uint64_t>(k) + 1000000 * static_cast<std::uint64_t>(step));
      const double dt = 1e-8;
      problem.prescribe(dt, z);
      rate = (z - start) / dt;
      CHECK(problem.residual(z, rate, rate / dt, dt, R));
      writer("residual_" + std::to_string(step), std::vector<double>(R.data(), R.data() + R.size()));
      problem.accept(z, rate, rate, dt);
    }
    for (auto& [name, array] : save_state(simulation)) state[name] = array;
    return state;
  };
  compare([] { return cell(NoSteps{}); }, compute);
  compare_by_rank([] { return cell(NoSteps{}); }, compute, 1e-14);
}

TEST_CASE("In the order of the ranks a step differs from that of one process by round-off") {
  const auto compute = [](auto& simulation) {
    simulation.run(simulation.time() + 0.4 * simulation.largest_stable_time_step());
    return save_state(simulation);
  };
  compare_by_rank(block, compute, 1e-14, scattered);
  compare_by_rank([] { return cell(CentralDifference{}); }, compute, 1e-14, scattered);
}

TEST_CASE("A step that breaks down ends on all ranks alike, and tells whose point it was") {
  const auto compose = [] {
    Body body = slab(box({.size = Point<3>(1.0 * um, 1.0 * um, 1.0 * um), .cells = {7, 7, 7}}), 24);
    body.velocity[100] = Vector4(3e4, 0.0, 0.0, 0.0);  // through its neighbours
    return simulation_of(std::move(body));
  };
  std::string told;
  const auto compute = [&](auto& simulation) {
    told.clear();
    try {
      take(simulation, 50);
    } catch (const ComputationError& error) {
      told = error.what();
    }
    CHECK(told.find("inverted") != std::string::npos);
    CHECK((told.starts_with("rank ") == (simulation.decomposition() != nullptr)));
    return whole(simulation);
  };
  compare(compose, compute);
  CHECK_NOTHROW(session->require_same("message", told));
  compare_by_rank(compose, compute, 1e-9);  // a hard blow
  CHECK_NOTHROW(session->require_same("message", told));
}

TEST_CASE("Frames in pieces: every particle and every cell is in one of them") {
  auto simulation = block();
  take(simulation, 3);
  auto& body = simulation.body<0>();
  const std::vector<int> here(body.size(), 0), &owners = simulation.decomposition() ? simulation.decomposition()->owners(0) : here;
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("tactoid_pieces_" + session->text_of(0, std::to_string(::getpid())));
  prepare_folder(folder);
  (void)session->largest(0);  // the folder is there
  write_body_pieces(folder / "frame.pvtu", body, simulation.particles<0>(), stress_fields(body), simulation.time(), owners);
  (void)session->largest(0);  // all pieces are there
  if (session->rank() == 0) {
    const std::string whole = read_file(folder / "frame.pvtu");
    CHECK(whole.find("Name=\"effective_stress\"") != std::string::npos);
    std::size_t vertices = 0, cells = 0;
    for (int r = 0; r < session->size(); ++r) {
      const std::string name = "frame_" + std::to_string(r) + ".vtu";
      CHECK(whole.find("<Piece Source=\"" + name + "\"/>") != std::string::npos);
      const std::string piece = read_file(folder / name), mark = "NumberOfCells=\"";
      const std::size_t count = std::stoul(piece.substr(piece.find(mark) + mark.size(), 12));
      const auto own = static_cast<std::size_t>(std::count(owners.begin(), owners.end(), r));
      CHECK(count >= own);
      vertices += own;
      cells += count - own;
    }
    CHECK(vertices == body.size());
    CHECK(cells == body.cloud().cells.size());
    std::filesystem::remove_all(folder);
  }
}

TEST_CASE("Ranks that compose different simulations are told so") {
  if (session->size() == 1) return;
  const auto different = [] {
    Body body = slab(box({.size = Point<3>(1.0 * um, 1.0 * um, 1.0 * um), .cells = {4, 4, 4}}), 24);
    body.velocity[3][0] = session->rank() == 1 ? 1.0 : 0.0;
    simulation_of(std::move(body));
  };
  CHECK_THROWS_WITH_AS(different(), "Rank 1 has another simulation than rank 0: all ranks must run the same program with the same options.", ParameterError);
  session->sum_order = session->rank() == 1 ? SumOrder::of_ranks : SumOrder::of_one_process;
  CHECK_THROWS_WITH_AS(block(), "Rank 1 has another order of sums than rank 0: all ranks must run the same program with the same options.", ParameterError);
  session->sum_order = SumOrder::of_one_process;
  session->set_up = session->rank() == 1 ? SetUp::divided : SetUp::whole;
  CHECK_THROWS_WITH_AS(block(), "Rank 1 has another set-up of bodies than rank 0: all ranks must run the same program with the same options.", ParameterError);
  session->set_up = SetUp::divided;
  const auto supports = [] { return Body{"slab", box({.size = Point<3>(1.0 * um, 1.0 * um, 1.0 * um), .cells = {4, 4, 4}}), Rkpm<3>{.support = session->rank() == 1 ? 2.0 : 2.1}, NodalCentroids{}, Materials{Region{"body", YangVisco<>{}}}}; };
  CHECK_THROWS_WITH_AS((void)supports(), "Rank 1 has another body than rank 0: all ranks must run the same program with the same options.", ParameterError);
  const Body alike = slab(box({.size = Point<3>(1.0 * um, 1.0 * um, 1.0 * um), .cells = {4, 4, 4}}), 24);
  session->set_up = SetUp::whole;
  Body copy = alike;
  CHECK_THROWS_AS(StaticProblem(copy, {}), ParameterError);
  CHECK_THROWS_AS(session->require_same("option", std::to_string(session->rank())), ParameterError);
}

int main(int argc, char** argv) {
  mpi::Session all(argc, argv, {.partitioner = [](const mpi::ChunkGraph& graph, int ranks) { return partitioner(graph, ranks); }});
  session = &all;
  all.divided_contacts_from = 0;  // however few there are
  doctest::Context context(argc, argv);
  context.setOption("minimal", all.rank() != 0);
  const int failed = context.run();
  return static_cast<int>(all.largest(failed));
}
