// Bodies of which each rank has a part of the cloud, and nobody the whole, against the same ones in one process: the same but for round-off.
//
//   mpirun -np 4 --oversubscribe mpi_parts [options of doctest]
//
// All ranks run all cases, in the same order. Rank 0 computes alone, too, and compares.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <unistd.h>

#include <tactoid/boundary/all.hpp>
#include <tactoid/contact/all.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/director/all.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/neighbors/part_of.hpp>
#include <tactoid/input/cloud_file.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/integrator/subcycled_central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/mpi.hpp>
#include <tactoid/observe/motion.hpp>
#include <tactoid/observe/probe.hpp>
#include <tactoid/observe/reaction.hpp>
#include <tactoid/observe/stress.hpp>
#include <tactoid/output/body_frame.hpp>
#include <tactoid/output/checkpoint.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/body.hpp>
#include <tactoid/simulation/simulation.hpp>

using namespace tactoid;

namespace {

constexpr double um = 1e-6;

mpi::Session* session = nullptr;

/// A block of which each rank makes its own particles, and what their rows touch.
[[nodiscard]] inline auto block_in_parts(const mpi::Session& ranks, const Box& whole) {
  const Rkpm<3> kernel{};
  const Part part{.rank = ranks.rank(), .ranks = ranks.size(), .support = kernel.support};
  return Body{"block", box_part(whole, part), kernel, NodalCentroids{}, Materials{Region{"body", NeoHookean::from_young(1e4, 0.3)}}};
}

[[nodiscard]] Part part(double support, bool surface = false) { return {.rank = session->rank(), .ranks = session->size(), .support = support, .surface = surface}; }

/// What is compared: lists of numbers by name; of particles by their number in the whole.
using Numbers = std::map<std::string, std::vector<double>>;

/// `values(i)` of all particles, on all ranks; each gives those of its own ones.
template <class Body, class Values>
std::vector<double> of_particles(const Body& body, const Values& values) {
  const auto* part = body.cloud().part.get();
  std::vector<double> list;
  std::size_t width = 0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (part != nullptr && !part->is_own(i)) continue;
    list.push_back(static_cast<double>(body.cloud().number(i)));
    const auto x = values(i);
    width = static_cast<std::size_t>(x.size());
    for (std::size_t k = 0; k < width; ++k) list.push_back(x[static_cast<Eigen::Index>(k)]);
  }
  if (Ranks::current != nullptr) list = mpi::join(MPI_COMM_WORLD, list);
  const std::size_t n = list.size() / (width + 1);
  CHECK(n == (part != nullptr ? part->whole : body.size()));
  std::vector<double> ordered(n * width);
  for (std::size_t k = 0; k < n; ++k) std::copy_n(list.data() + k * (width + 1) + 1, width, ordered.data() + static_cast<std::size_t>(list[k * (width + 1)]) * width);
  return ordered;
}

template <class S>
Numbers numbers_of(S& simulation) {
  auto& body = simulation.template body<0>();
  Numbers n;
  const Field velocity = simulation.template velocity<0>();
  n["displacement"] = of_particles(body, [&](std::size_t i) { return body.displacement[i].template head<3>().eval(); });
  n["velocity"] = of_particles(body, [&](std::size_t i) { return velocity[i].template head<3>().eval(); });
  n["force"] = of_particles(body, [&](std::size_t i) { return body.force[i].template head<3>().eval(); });
  n["mass"] = of_particles(body, [&](std::size_t i) { return Eigen::Matrix<double, 1, 1>(body.masses()[i]); });
  if (!body.director.empty()) n["director"] = of_particles(body, [&](std::size_t i) { return body.director[i].template head<3>().eval(); });
  const StressFields stress = stress_fields(body);
  n["stress"] = of_particles(body, [&](std::size_t i) { return Vector3(stress.effective_stress[i], 0.0, 0.0); });
  n["volume ratio"] = of_particles(body, [&](std::size_t i) { return Eigen::Matrix<double, 1, 1>(stress.volume_ratio[i]); });
  const RegionStatistics of_region = region_statistics(body, stress.point_effective_stress, 0);
  n["stress of a region"] = {of_region.mean, of_region.max};
  const Motion m = motion<0>(simulation);
  n["center"] = {m.center_of_mass[0], m.center_of_mass[1], m.center_of_mass[2]};
  n["energies"] = {simulation.ledger().kinetic, simulation.ledger().strain, simulation.ledger().stabilization, simulation.ledger().dissipated, simulation.ledger().external_work,
                   simulation.ledger().initial};
  n["reactions"] = {0.0};
  for (const Vector3& reaction : reactions<0>(simulation).conditions) n["reactions"].insert(n["reactions"].end(), reaction.begin(), reaction.end());
  n["step"] = {simulation.largest_stable_time_step()};
  if (Ranks::current != nullptr) CHECK_NOTHROW(session->require_same("step", fmt::format("{:a}", n["step"].front())));  // or they would go different ways
  n["time"] = {simulation.time()};
  n["pairs"] = {static_cast<double>(simulation.pairs())};
  return n;
}

/// No rank has the whole, and they have not all as much.
template <class Body>
void check_parts(const Body& body) {
  if (Ranks::current == nullptr || session->size() == 1) return;
  CHECK(body.size() < body.cloud().part->whole);
}

/// Largest difference, over the largest number.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double off = 0.0, size = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    off = std::max(off, std::abs(a[k] - b[k]));
    size = std::max(size, std::abs(a[k]));
  }
  return off == 0.0 ? 0.0 : off / size;
}

/// The stable step is measured by small differences of forces, which have much round-off.
double tolerance_of(const std::string& name, double tolerance) { return name == "step" ? 1e-9 : tolerance; }

/// Runs `compute(simulation)` on what `compose(cloud)` gives, of the whole cloud on rank 0 alone, and in parts, twice: the same but for `tolerance`; the second time to the bit.
template <int D, class Compose, class Compute>
void compare(const PointCloud<D>& cloud, const Part& wanted, const Compose& compose, const Compute& compute, double tolerance = 1e-11) {
  Numbers alone;
  if (session->rank() == 0) {
    Ranks::current = nullptr;
    auto simulation = compose(cloud);
    compute(simulation);
    alone = numbers_of(simulation);
    Ranks::current = session;
  }
  const auto in_parts = [&] {
    auto simulation = compose(part_of(cloud, wanted));
    check_parts(simulation.template body<0>());
    CHECK(simulation.template body<0>().in_parts() == (session->size() > 1));
    CHECK(simulation.template body<0>().size() == simulation.template body<0>().cloud().size());
    compute(simulation);
    return numbers_of(simulation);
  };
  const Numbers first = in_parts(), second = in_parts();
  if (session->rank() != 0) return;
  for (const auto& [name, list] : alone) {
    INFO(name);
    CHECK(difference(list, first.at(name)) <= tolerance_of(name, tolerance));
    CHECK(first.at(name) == second.at(name));
  }
  CHECK(alone.at("pairs") == first.at("pairs"));
  CHECK(alone.at("mass").size() == cloud.size());
}

/// Velocities, and displacements of a percent of a spacing, that have nothing to do with places.
template <class Body>
void shake(Body& body, double speed) {
  for (std::size_t i = 0; i < body.size(); ++i)
    for (int k = 0; k < Body::dimension; ++k) body.displacement[i][k] = 2e-3 * um * detail::hashed_uniform(8, 3 * body.cloud().number(i) + static_cast<std::size_t>(k));
  for (std::size_t i = 0; i < body.size(); ++i)
    for (int k = 0; k < Body::dimension; ++k) body.velocity[i][k] = speed * detail::hashed_uniform(7, 3 * body.cloud().number(i) + static_cast<std::size_t>(k));
}

/// Steps of a length that does not feel round-off: two digits of 0.4 of the stable one.
template <class S>
void take(S& simulation, std::size_t steps) {
  for (const std::size_t end = simulation.steps() + steps; simulation.steps() < end;) {
    const double step = 0.4 * simulation.largest_stable_time_step(), digit = std::pow(10.0, std::floor(std::log10(step)) - 1.0);
    simulation.run(simulation.time() + std::floor(step / digit) * digit);
  }
}

template <int D>
auto slab(PointCloud<D> cloud, std::size_t points_per_chunk = 24) {
  return Body{"slab", std::move(cloud), Rkpm<D>{}, NodalCentroids{.points_per_chunk = points_per_chunk}, Materials{Region{"body", YangVisco<>{}}}};
}
template <class Body>
auto free_body(Body body) {
  return Simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{}, CentralDifference{.safety = 0.5}};
}
template <int D>
auto shaken_slab(const PointCloud<D>& cloud) {
  auto body = slab(cloud);
  shake(body, 20.0);
  return free_body(std::move(body));
}

/// A cell so fine that two ranks have a part each; `height` of its middle, m.
PointCloud<3> fine_cell(double height) {
  return ball({.radius = 5.0 * um, .core_radius = 2.0 * um, .core_cells = 6, .shells = 6, .center = {0.0, 0.0, height}});
}

/// A bar, of which two ranks have a part each.
const Box short_bar{.size = Point<3>(3.0 * um, 0.5 * um, 0.5 * um), .cells = {24, 4, 4}};

}  // namespace

TEST_CASE("A free bar") {
  compare(jitter(box(short_bar), 0.1), part(Rkpm<3>{}.support), shaken_slab<3>, [](auto& simulation) {
    const Vector3 before = motion<0>(simulation).momentum;
    take(simulation, 200);
    CHECK((motion<0>(simulation).momentum - before).norm() < 1e-11 * 1e3 * um * um * um * 20.0);
  });
}

TEST_CASE("A long bar, periodic, which no rank has whole") {
  const PointCloud<3> bar = jitter(box({.size = Point<3>(8.0 * um, 0.4 * um, 0.5 * um), .cells = {56, 3, 4}, .periodic = {true, false, false}}), 0.1);
  compare(bar, part(Rkpm<3>{}.support), shaken_slab<3>, [](auto& simulation) {
    take(simulation, 50);
  });
}

TEST_CASE("A body so large that its gradients are made consistent with the help of smooth fields") {
  const PointCloud<3> cloud = jitter(box({.size = Point<3>(1.9 * um, 1.0 * um, 1.0 * um), .cells = {29, 14, 14}}), 0.1);
  CHECK(cloud.size() >= detail::particles_for_coarse_space);
  compare(cloud, part(Rkpm<3>{}.support), [](const PointCloud<3>& here) {
    auto body = slab(here, 0);
    shake(body, 20.0);
    return free_body(std::move(body));
  }, [](auto& simulation) { take(simulation, 3); }, 1e-10);
}

TEST_CASE("A graded plate that is pulled") {
  const PointCloud<2> cloud = rectangle({.size = {4.0 * um, 1.0 * um}, .cells = {32, 8}});
  compare(cloud, part(Rkpm<2>{}.support), [](const PointCloud<2>& here) {
    const auto left = select(here, [](const Point<2>& X) { return X[0] < 1e-9; });
    const auto right = select(here, [](const Point<2>& X) { return X[0] > 3.999 * um; });
    Body body{"plate", here, Rkpm<2>{}, NodalCentroids{.points_per_chunk = 16},
              Materials{Region{"body", Graded{[](const Vector3& X) { return NeoHookean::from_young(1e4 * (1.0 + X[0] / um), 0.3); }}}}};
    shake(body, 0.1);
    return Simulation{Bodies{std::move(body)}, Contacts{},
                      Boundaries{on<0>(fixed(left)), on<0>(PrescribedMotion{right, [](const Vector3&, double t) { return Vector3(1e-3 * um + 0.1 * t, 0.0, 0.0); }, {true, false, false}})},
                      CentralDifference{.safety = 0.5}};
  }, [](auto& simulation) {
    take(simulation, 100);
    CHECK(std::abs(simulation.ledger().external_work) > 0.0);
    CHECK(reactions<0>(simulation).conditions[1][0] != 0.0);
    CHECK(simulation.ledger().error() < 0.02);
  });
}

TEST_CASE("A cell of two regions with a director, in the plane and in space") {
  const auto compose = [](const PointCloud<3>& here) {
    Body body{"cell", here, Rkpm<3>{}, NodalCentroids{.points_per_chunk = 16}, Materials{Region{"nucleus", ModifiedMooneyRivlin{}}, Region{"cytoplasm", NematicGel<>{}}}, DirectorField<>{},
              [](const Vector3& X) { return Vector3(std::cos(1e6 * X[0]), std::sin(1e6 * X[1]), 0.3); }};
    shake(body, 0.5);
    return free_body(std::move(body));
  };
  compare(fine_cell(0.0), part(Rkpm<3>{}.support), compose, [](auto& simulation) { take(simulation, 50); });
}

namespace {

/// A bar of two regions, the second of which is at its end, where not all ranks are; both graded, the second one harder.
PointCloud<3> bar_of_two_regions() {
  PointCloud<3> cloud = box({.size = Point<3>(4.0 * um, 0.5 * um, 0.5 * um), .cells = {32, 4, 4}});
  cloud.regions = {"soft", "hard"};
  for (std::size_t c = 0; c < cloud.cells.size(); ++c)
    cloud.cell_regions[c] = cloud.positions[cloud.cells[c][0]][0] > 3.4 * um && cloud.positions[cloud.cells[c].back()][0] > 3.4 * um ? 1 : 0;
  return cloud;
}
auto graded_bar(const PointCloud<3>& here) {
  const auto law = [](double base, double slope) { return Graded{[=](const Vector3& X) { return NeoHookean::from_young(base * (1.0 + slope * X[0] / um), 0.3); }}; };
  Body body{"bar", here, Rkpm<3>{}, NodalCentroids{.points_per_chunk = 16}, Materials{Region{"soft", law(1e4, 2.0)}, Region{"hard", law(1e5, 1.0)}}};
  shake(body, 1.0);
  return free_body(std::move(body));
}

}  // namespace

TEST_CASE("Graded laws of two regions, one of which is not on all ranks") {
  compare(bar_of_two_regions(), part(Rkpm<3>{}.support), graded_bar, [](auto& simulation) {
    const auto& cloud = simulation.template body<0>().cloud();
    if (Ranks::current != nullptr && session->size() == 4) CHECK((std::count(cloud.cell_regions.begin(), cloud.cell_regions.end(), Index{1}) > 0) == (session->rank() == 3));
    take(simulation, 50);
  });
}

TEST_CASE("A ring about the axis") {
  const PointCloud<2> ring = meridian(Disc{.radius = 3.0 * um, .height = 0.5 * um, .core_cells = 16, .rings = 8, .layers = 4});
  compare(ring, part(Rkpm<2>{}.support), [](const PointCloud<2>& here) {
    Body body{"ring", here, Rkpm<2>{}, NodalCentroids{.points_per_chunk = 16}, Materials{Region{"body", NeoHookean::from_young(1e4, 0.3)}}};
    shake(body, 0.5);
    return free_body(std::move(body));
  }, [](auto& simulation) { take(simulation, 50); });
}

TEST_CASE("A block under surface tension and pressure, on a plate") {
  compare(jitter(box(short_bar), 0.1), part(Rkpm<3>{}.support, true), [](const PointCloud<3>& here) {
    auto body = slab(here);
    shake(body, 20.0);
    return Simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{on<0>(SurfaceTension{}), on<0>(CurvatureSurfaceTension{}), on<0>(AmbientPressure{.pressure = 300.0})},
                      CentralDifference{.safety = 0.5}};
  }, [](auto& simulation) {
    take(simulation, 100);
    CHECK(simulation.ledger().surface > 0.0);
  });
}

TEST_CASE("A cell that sticks to a substrate of which each rank has a part") {
  const PointCloud<3> ground = box({.size = Point<3>(48.0 * um, 12.0 * um, 3.0 * um), .cells = {32, 8, 3}, .origin = Point<3>(-24.0 * um, -6.0 * um, -3.0 * um)});
  compare(ground, part(Rkpm<3>{}.support, true), [](const PointCloud<3>& here) {
    const auto bottom = select(here, [](const Point<3>& X) { return X[2] < -2.99 * um; });
    Body body{"cell", ball({.radius = 5.0 * um, .core_radius = 2.0 * um, .core_cells = 4, .shells = 4, .center = {0.0, 0.0, 5.15 * um}}), Rkpm<3>{}, NodalCentroids{.points_per_chunk = 16},
              Materials{Region{"nucleus", ModifiedMooneyRivlin{}}, Region{"cytoplasm", NematicGel<>{}}}, DirectorField<>{}, RandomDirector{{.correlation_length = 2.0 * um, .seed = 2}}};
    return Simulation{Bodies{slab(here), std::move(body)}, Contacts{between<1, 0>(LigandReceptor{}), between<1, 0>(VanDerWaals{})},
                      Boundaries{on<1>(SurfaceTension{}), on<0>(PrescribedMotion{bottom, [](const Vector3&, double) { return Vector3(0.0, 0.0, -1e-3 * um); }})}, CentralDifference{}};
  }, [](auto& simulation) {
    take(simulation, 80);
    const auto gaps = simulation.template contact<1>().gaps();
    CHECK(*std::min_element(gaps.begin(), gaps.end()) < 0.1 * um);  // they touch
    CHECK(simulation.ledger().adhesion != 0.0);
  });
}

TEST_CASE("Gradients in single precision, and steps of its own") {
  compare(jitter(box(short_bar), 0.1), part(Rkpm<3>{}.support), [](const PointCloud<3>& here) {
    Body body{"block", here, Rkpm<3>{}, stored_as<float>(NodalCentroids{.points_per_chunk = 24}), Materials{Region{"body", YangVisco<>{}}}};
    shake(body, 20.0);
    return Simulation{Bodies{std::move(body)}, Contacts{}, Boundaries{}, SubcycledCentralDifference{CentralDifference{.safety = 0.5}, 4}};
  }, [](auto& simulation) { take(simulation, 40); });
}

TEST_CASE("A box that is made in parts is the box") {
  const Box bar{.size = Point<3>(4.0 * um, 0.5 * um, 0.5 * um), .cells = {40, 4, 5}};
  const auto compose = [](PointCloud<3> cloud) {
    auto body = slab(std::move(cloud));
    for (std::size_t i = 0; i < body.size(); ++i) body.velocity[i][0] = 10.0 * std::sin(body.cloud().positions[i][0] / um);
    return free_body(std::move(body));
  };
  auto divided = compose(box_part(bar, part(Rkpm<3>{}.support)));
  take(divided, 40);
  auto whole = [&] {
    Ranks::current = nullptr;
    auto simulation = compose(box(bar));
    take(simulation, 40);
    Ranks::current = session;
    return save_state(simulation);
  }();
  CHECK(divided.ledger().strain == doctest::Approx(whole.at("ledger/strain").values[0]).epsilon(1e-11));
  CHECK(divided.time() == doctest::Approx(whole.at("time").values[0]).epsilon(1e-11));
  const auto& body = divided.body<0>();
  if (session->size() > 3) CHECK(body.size() < 0.8 * static_cast<double>(body.cloud().part->whole));
}

TEST_CASE("The block of the page") {
  auto simulation = free_body(block_in_parts(*session, short_bar));
  take(simulation, 1);
  CHECK(motion<0>(simulation).mass == doctest::Approx(0.75 * um * um * um * NeoHookean::from_young(1e4, 0.3).density).epsilon(1e-12));
}

TEST_CASE("Frames are written in pieces") {
  auto simulation = shaken_slab(box_part(short_bar, part(Rkpm<3>{}.support)));
  take(simulation, 5);
  auto& body = simulation.body<0>();
  const StressFields stress = stress_fields(body);
  const auto ratios = of_particles(body, [&](std::size_t i) { return Eigen::Matrix<double, 1, 1>(stress.volume_ratio[i]); });
  std::size_t different = 0;  // copies, at vertices of own cells and beyond
  for (std::size_t i = 0; i < body.size(); ++i) different += stress.volume_ratio[i] != ratios[body.cloud().number(i)] ? 1 : 0;
  CHECK(different == 0);
  const auto folder = std::filesystem::temp_directory_path() / ("tactoid_parts_" + session->text_of(0, std::to_string(::getpid())));
  std::filesystem::create_directories(folder);
  (void)session->largest(0);
  std::vector<int> owners(body.size(), 0);
  if (simulation.decomposition() != nullptr) owners = simulation.decomposition()->owners(0);
  write_body_pieces(folder / "slab.pvtu", body, simulation.particles<0>(), stress, simulation.time(), owners);
  double own = 0.0, cells = 0.0;
  for (const int owner : owners) own += owner == session->rank() ? 1.0 : 0.0;
  for (const auto& cell : body.cloud().cells) cells += owners[cell[0]] == session->rank() ? 1.0 : 0.0;
  const std::vector<double> all = mpi::join(MPI_COMM_WORLD, std::vector<double>{own, cells});
  own = cells = 0.0;
  for (std::size_t r = 0; r < all.size(); r += 2) own += all[r], cells += all[r + 1];
  CHECK(own == 625.0);
  CHECK(cells == 384.0);
  if (session->rank() == 0)
    for (int r = 0; r < session->size(); ++r) CHECK(std::filesystem::exists(folder / ("slab_" + std::to_string(r) + ".vtu")));
  (void)session->largest(0);
  if (session->rank() == 0) std::filesystem::remove_all(folder);
}

namespace {

/// A folder of the test that all ranks have, as long as it lives.
struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / ("tactoid_parts_" + session->text_of(0, std::to_string(::getpid())));
  Folder() {
    prepare_folder(path);
    (void)session->largest(0);
  }
  ~Folder() {
    (void)session->largest(0);
    if (session->rank() == 0) std::filesystem::remove_all(path);
  }
};

/// What `compute()` returns in a process alone, rank 0; nothing on the others.
template <class Compute>
void alone(const Compute& compute) {
  if (session->rank() == 0) {
    Ranks::current = nullptr;
    compute();
    Ranks::current = session;
  }
  (void)session->largest(0);
}

/// A state that some ranks have left goes on on as many, on one, and back.
template <class Compose>
void check_checkpoints(const Compose& compose, double tolerance) {
  const Folder folder;
  const auto file = folder.path / "state.h5", of_one = folder.path / "of_one.h5";
  auto simulation = compose(session->rank(), session->size());
  take(simulation, 15);
  write_checkpoint(file, {"parts", "", save_state(simulation)});
  const Numbers saved = numbers_of(simulation);
  take(simulation, 15);
  const Numbers straight = numbers_of(simulation);

  const auto go_on = [&](const std::filesystem::path& from, int rank, int ranks) {
    auto restored = compose(rank, ranks);
    const SavedState like = save_state(restored);
    restore_state(restored, read_checkpoint(from, like).state);
    const Numbers now = numbers_of(restored);
    for (const auto& [name, list] : saved) {
      INFO(name);
      CHECK(difference(now.at(name), list) <= (ranks == session->size() && from == file ? 0.0 : tolerance_of(name, tolerance)));
    }
    take(restored, 15);
    return numbers_of(restored);
  };
  const Numbers again = go_on(file, session->rank(), session->size());
  for (const auto& [name, list] : straight) {
    INFO(name);
    CHECK(list == again.at(name));  // the same bits
  }
  Numbers by_one;
  alone([&] {
    by_one = go_on(file, 0, 1);
    auto one = compose(0, 1);
    take(one, 15);
    write_checkpoint(of_one, {"parts", "", save_state(one)});
    const SavedState whole = read_checkpoint(of_one).state, here = save_state(one);
    for (const auto& [name, array] : here) {
      INFO(name);
      REQUIRE(whole.contains(name));
      CHECK((array.length == 0 ? whole.at(name) == array : whole.at(name).shape[0] == array.length));
    }
  });
  const Numbers from_one = go_on(of_one, session->rank(), session->size());
  if (session->rank() != 0) return;
  for (const auto& [name, list] : straight) {
    INFO(name);
    CHECK(difference(by_one.at(name), list) <= tolerance_of(name, tolerance));
    CHECK(difference(from_one.at(name), list) <= tolerance_of(name, tolerance));
  }
}

}  // namespace

TEST_CASE("A state goes from some ranks to others") {
  const Box bar{.size = Point<3>(4.0 * um, 0.5 * um, 0.5 * um), .cells = {24, 3, 4}};
  check_checkpoints([&](int rank, int ranks) {
    PointCloud<3> cloud = box_part(bar, {.rank = rank, .ranks = ranks, .support = Rkpm<3>{}.support});
    const auto left = select(cloud, [](const Point<3>& X) { return X[0] < 1e-9; }), right = select(cloud, [](const Point<3>& X) { return X[0] > 3.999 * um; });
    auto body = slab(std::move(cloud));
    shake(body, 5.0);
    return Simulation{Bodies{std::move(body)}, Contacts{},
                      Boundaries{on<0>(fixed(left)), on<0>(PrescribedMotion{right, [](const Vector3&, double t) { return Vector3(0.1 * t, 0.0, 0.0); }, {true, false, false}})},
                      SubcycledCentralDifference{CentralDifference{.safety = 0.5}, 4}};
  }, 1e-11);
}

TEST_CASE("The state of graded laws goes from some ranks to others") {
  const PointCloud<3> whole = bar_of_two_regions();
  check_checkpoints([&](int rank, int ranks) { return graded_bar(part_of(whole, {.rank = rank, .ranks = ranks, .support = Rkpm<3>{}.support})); }, 1e-11);
}

TEST_CASE("The state of a cell with a director, stuck to a plate, goes from some ranks to others") {
  const PointCloud<3> whole = fine_cell(5.1 * um);
  check_checkpoints([&](int rank, int ranks) {
    Body body{"cell", part_of(whole, {.rank = rank, .ranks = ranks, .support = Rkpm<3>{}.support, .surface = true}), Rkpm<3>{}, NodalCentroids{.points_per_chunk = 16},
              Materials{Region{"nucleus", ModifiedMooneyRivlin{}}, Region{"cytoplasm", NematicGel<>{}}}, DirectorField<>{.diffusivity = 1e-5},  // limits the steps
              [](const Vector3& X) { return Vector3(std::cos(1e6 * X[0]), std::sin(1e6 * X[1]), 0.3); }};
    shake(body, 0.5);
    return Simulation{Bodies{std::move(body), slab(disc({.radius = 8.0 * um, .height = 3.0 * um, .core_cells = 4, .rings = 2, .layers = 4}))}, Contacts{between<0, 1>(LigandReceptor{}), between<0, 1>(ContactAnchoring{})},
                      Boundaries{on<0>(SurfaceTension{})}, CentralDifference{}};
  }, 1e-10);
}

TEST_CASE("Rows of a list go into one file round after round, and come back to those who want them") {
  const Folder folder;
  const auto rank = static_cast<std::size_t>(session->rank()), ranks = static_cast<std::size_t>(session->size());
  const auto value_of = [](std::size_t row, std::size_t c) { return row == 17 ? 0.0 : static_cast<double>(10 * row + c); };  // nobody has row 17
  for (const std::size_t length : {1u, 40u, 1001u})
    for (const std::size_t at_a_time : {3u, 64u}) {
      INFO(length, " rows, ", at_a_time, " at a time");
      const auto path = folder.path / (std::to_string(length) + "_" + std::to_string(at_a_time) + ".h5");
      StateArray vectors{.shape = {0, 3}, .values = {}, .rows = {}, .length = length}, whole{.shape = {0}, .values = {}, .whole = true, .rows = {}, .length = length};
      for (std::size_t row = length; row-- > 0;)  // not in their order
        if (row * 7919 % ranks == rank && row != 17) {
          vectors.rows.push_back(row), whole.rows.push_back(row);
          for (std::size_t c = 0; c < 3; ++c) vectors.values.push_back(value_of(row, c));
          whole.values.push_back(value_of(row, 0));
        }
      std::string offsets;
      if (rank == 0) {
        const detail::Hdf5 file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
        const auto of_vectors = detail::make_room(file, "vectors", vectors), of_whole = detail::make_room(file, "of/whole", whole);
        offsets = std::to_string(of_vectors) + " " + std::to_string(of_whole);
      }
      std::istringstream places(session->text_of(0, offsets));
      std::uint64_t of_vectors = 0, of_whole = 0;
      places >> of_vectors >> of_whole;
      const auto shared = session->open_shared(path);
      detail::write_rows(*shared, of_vectors, vectors, at_a_time);
      detail::write_rows(*shared, of_whole, whole, at_a_time);
      shared->close();

      const detail::Hdf5 file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
      const StateArray all = detail::read_set(file, "vectors", nullptr), all_whole = detail::read_set(file, "of/whole", nullptr);
      REQUIRE(all.values.size() == 3 * length);
      CHECK(all_whole.whole);
      for (std::size_t row = 0; row < length; ++row) {
        for (std::size_t c = 0; c < 3; ++c) CHECK(all.values[3 * row + c] == value_of(row, c));
        CHECK(all_whole.values[row] == value_of(row, 0));
      }
      // Each wants some, also those that another one wants; the last one nothing.
      StateArray wanted{.shape = {0, 3}, .values = {}, .rows = {}, .length = length};
      for (std::size_t row = rank; row < length && (rank + 1 < ranks || ranks == 1); row += 2) wanted.rows.insert(wanted.rows.begin(), row);
      const detail::Hdf5 set(H5Dopen2(file, "vectors", H5P_DEFAULT), H5Dclose);
      detail::read_rows(set, wanted, at_a_time);
      REQUIRE(wanted.values.size() == 3 * wanted.rows.size());
      for (std::size_t k = 0; k < wanted.rows.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c) CHECK(wanted.values[3 * k + c] == value_of(wanted.rows[k], c));
    }
}

TEST_CASE("What does not fit into a file that all ranks write is told on all of them") {
  const Folder folder;
  const auto path = folder.path / "small.bin";
  if (session->rank() == 0) AtomicFile(path).commit();
  (void)session->largest(0);
  const auto file = session->open_shared(path);
  const std::vector<std::byte> bytes(std::size_t{1} << 20);
  file->write_at(static_cast<std::uint64_t>(session->rank()) * bytes.size(), bytes);
  rlimit former{};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &former) == 0);
  const auto former_action = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{static_cast<rlim_t>(session->size()) * bytes.size(), former.rlim_max};  // what is there already fits
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
  file->write_at(static_cast<std::uint64_t>(session->size() + session->rank()) * bytes.size(), bytes);
  CHECK_THROWS_WITH_AS(file->close(), doctest::Contains("Cannot write \""), FileError);
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &former) == 0);
  std::signal(SIGXFSZ, former_action);
}

TEST_CASE("Checkpoints that cannot be written or read are told on all ranks") {
  const Folder folder;
  auto simulation = shaken_slab(box_part(short_bar, part(Rkpm<3>{}.support)));
  const SavedState like = save_state(simulation);
  CHECK_THROWS_WITH_AS(write_checkpoint(folder.path / "nowhere" / "state.h5", {"parts", "", like}), doctest::Contains("Cannot write"), FileError);
  CHECK_THROWS_WITH_AS((void)read_checkpoint(folder.path / "none.h5", like), doctest::Contains("Cannot read"), FileError);
  CHECK_THROWS_WITH_AS((void)session->open_shared(folder.path / "none.h5"), doctest::Contains("Cannot write"), FileError);
  const auto file = folder.path / "state.h5";
  write_checkpoint(file, {"parts", "a = 1", like});
  CHECK(read_checkpoint(file, like).parameters == "a = 1");
  CHECK(!std::filesystem::exists(folder.path / "state.h5.part"));
  (void)session->largest(0);
  if (session->rank() == 0) {
    std::string bytes = read_file(file);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    AtomicFile damaged(file);
    damaged.write(bytes);
    damaged.commit();
  }
  (void)session->largest(0);
  CHECK_THROWS_WITH_AS((void)read_checkpoint(file, like), doctest::Contains("is a damaged checkpoint"), FileError);
  // The state of something else.
  Box other = short_bar;
  other.cells[0] = 25;
  auto larger = shaken_slab(box_part(other, part(Rkpm<3>{}.support)));
  CHECK_THROWS_AS(restore_state(larger, like), ParameterError);
}

TEST_CASE("A body from a file that no rank has read whole") {
  const Folder folder;
  const PointCloud<3> cloud = jitter(box(short_bar), 0.1);
  write_cloud(folder.path / "cloud.h5", cloud);
  (void)session->largest(0);
  const auto run = [](const PointCloud<3>& here) {
    auto simulation = shaken_slab(here);
    take(simulation, 10);
    return numbers_of(simulation);
  };
  const Part here = part(Rkpm<3>{}.support);
  const Numbers read = run(read_cloud_part<3>(folder.path / "cloud.h5", here)), made = run(part_of(cloud, here));
  for (const auto& [name, list] : made) {
    INFO(name);
    CHECK(read.at(name) == list);
  }
}

TEST_CASE("A point that is inverted on one rank ends the step on all, and the state before is there again") {
  auto body = slab(box_part(short_bar, part(Rkpm<3>{}.support)));
  const std::size_t wanted = 624;  // the last particle, of the last rank
  for (std::size_t i = 0; i < body.size(); ++i)
    if (body.cloud().number(i) == wanted) body.velocity[i][0] = -1e4;
  auto simulation = free_body(std::move(body));
  std::string told;
  try {
    simulation.run(1.0);
  } catch (const ComputationError& error) {
    told = error.what();
  }
  CHECK_NOTHROW(session->require_same("message", told));
  CHECK(told.find("Body \"slab\", particle ") != std::string::npos);
  CHECK(told.find("the point is inverted") != std::string::npos);
  CHECK(told.starts_with("rank ") == (session->size() > 1));
  for (const Vector4& u : simulation.body<0>().displacement) CHECK(u.allFinite());
}

TEST_CASE("A first state with an inverted point is refused on all ranks with the same words") {
  auto body = slab(box_part(short_bar, part(Rkpm<3>{}.support)));
  for (std::size_t i = 0; i < body.size(); ++i)
    if (body.cloud().number(i) == 624) body.displacement[i][0] = -1.0 * um;
  std::string told;
  try {
    auto simulation = free_body(std::move(body));
  } catch (const ComputationError& error) {
    told = error.what();
  }
  CHECK_NOTHROW(session->require_same("message", told));
  CHECK(told.find("the point is inverted") != std::string::npos);
  CHECK(told.starts_with("rank ") == (session->size() > 1));
}

TEST_CASE("What needs the whole is refused, on all ranks") {
  if (session->size() == 1) return;
  const auto body = [] { return slab(box_part(short_bar, part(Rkpm<3>{}.support))); };
  session->sum_order = SumOrder::of_one_process;
  CHECK_THROWS_WITH_AS(free_body(body()), "Body \"slab\": each process has a part of its cloud; choose SumOrder::of_ranks.", ParameterError);
  session->sum_order = SumOrder::of_ranks;
  CHECK_THROWS_WITH_AS((Simulation{Bodies{body()}, Contacts{}, Boundaries{on<0>(SurfaceTension{})}, CentralDifference{}}),
                       "Body \"slab\": each process has a part of its cloud; boundary term number 0 needs all facets (Part::surface).", ParameterError);
  CHECK_THROWS_WITH_AS((Simulation{Bodies{body(), slab(box(short_bar))}, Contacts{between<0, 1>(VanDerWaals{})}, Boundaries{}, CentralDifference{}}),
                       "Body \"slab\": each process has a part of its cloud; contact number 0 may read all of its particles.", ParameterError);
  CHECK_THROWS_WITH_AS((Simulation{Bodies{slab(box(short_bar)), body()}, Contacts{between<0, 1>(VanDerWaals{})}, Boundaries{}, CentralDifference{}}),
                       "Body \"slab\": each process has a part of its cloud; contact number 0 needs all facets (Part::surface).", ParameterError);
  auto simulation = free_body(body());
  CHECK_THROWS_AS((Probe{simulation.body<0>(), {Point<3>(0.1 * um, 0.1 * um, 0.1 * um)}}), ParameterError);
  CHECK_THROWS_AS(write_body_frame("nowhere.vtu", simulation.body<0>(), simulation.particles<0>(), stress_fields(simulation.body<0>()), 0.0), ParameterError);
  Part with_surface = part(Rkpm<3>{}.support, session->rank() == 1);
  CHECK_THROWS_WITH_AS(free_body(slab(box_part(short_bar, with_surface))), "Rank 1 has another simulation than rank 0: all ranks must run the same program with the same options.", ParameterError);
  // Parts of another division.
  CHECK_THROWS_AS(slab(box_part(short_bar, {.rank = 0, .ranks = session->size(), .support = 2.0})), ParameterError);
  CHECK_THROWS_AS(slab(box_part(short_bar, {.rank = session->rank(), .ranks = session->size() + 1, .support = 2.0})), ParameterError);
  CHECK_THROWS_WITH_AS(slab(session->rank() == 1 ? part_of(box(short_bar), part(Rkpm<3>{}.support)) : box_part(short_bar, part(Rkpm<3>{}.support))), doctest::Contains("are not of one division"), ParameterError);
  Box other = short_bar;
  if (session->rank() == 1) other.cells[0] = 25;
  CHECK_THROWS_WITH_AS(slab(box_part(other, part(2.0))), "Rank 1 has another cloud of which it has a part than rank 0: all ranks must run the same program with the same options.", ParameterError);
  CHECK_THROWS_AS((Body{"slab", box_part(short_bar, part(2.0)), Rkpm<3>{}, GaussCells<2>{}, Materials{Region{"body", YangVisco<>{}}}}), ParameterError);
  // Supports that are larger than the part was made for.
  CHECK_THROWS_AS((Body{"slab", box_part({.size = Point<3>(8.0 * um, 0.5 * um, 0.5 * um), .cells = {56, 4, 4}}, part(0.6)), Rkpm<3>{.support = 3.0}, NodalCentroids{}, Materials{Region{"body", YangVisco<>{}}}}),
                  ParameterError);
}

int main(int argc, char** argv) {
  mpi::Session all(argc, argv);
  session = &all;
  all.divided_contacts_from = 0;  // however small
  session->sum_order = SumOrder::of_ranks;
  doctest::Context context(argc, argv);
  context.setOption("minimal", all.rank() != 0);
  const int failed = context.run();
  return static_cast<int>(all.largest(failed));
}
