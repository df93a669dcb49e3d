// Steps of an elastic block in free flight, divided among ranks: what step_benchmark measures in one process.
//
//   mpirun -np 2 mpi_block --edge 54 --steps 20
//   mpirun -np 1 --bind-to none mpi_block --edge 54 --steps 20 --threads 2
//
// Options: particles along an edge, steps, threads of each rank; --sum-order ranks, where each row is evaluated
// once; --set-up divided, where each rank makes the rows that it needs, or parts, where it makes its part of the cloud and nobody the whole (in the order of the ranks); and 1 in --scattered for a division that has nothing to do with places.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/mpi.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/body.hpp>
#include <tactoid/simulation/simulation.hpp>

namespace {

using namespace tactoid;

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Memory of this process now, MB, as Linux tells it.
long resident_megabytes() {
  std::ifstream file("/proc/self/statm");
  long total = 0, resident = 0;
  file >> total >> resident;
  return resident * 4096 / 1000000;
}

/// The most that it has been, MB.
long peak_megabytes() {
  std::ifstream file("/proc/self/status");
  std::string word;
  long kilobytes = 0;
  while (file >> word)
    if (word == "VmHWM:") file >> kilobytes;
  return kilobytes * 1024 / 1000000;
}

}  // namespace

int main(int argc, char** argv) {
  bool scattered = false, parts = false;
  const mpi::Partitioner partitioner = [&](const mpi::ChunkGraph& graph, int ranks) {
    if (!scattered) return mpi::partition_by_metis(graph, ranks);
    std::vector<int> owner(graph.size());
    for (std::size_t c = 0; c < owner.size(); ++c) owner[c] = static_cast<int>(c % static_cast<std::size_t>(ranks));
    return owner;
  };
  mpi::Session session(argc, argv, {.partitioner = partitioner});
  int edge = 54, steps = 20, threads = 1;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    const int value = std::atoi(argv[i + 1]);
    if (name == "--edge") edge = std::max(value, 3);
    if (name == "--steps") steps = std::max(value, 1);
    if (name == "--threads") threads = std::max(value, 1);
    if (name == "--sum-order" && argv[i + 1] == std::string("ranks")) session.sum_order = SumOrder::of_ranks;
    if (name == "--set-up" && argv[i + 1] == std::string("divided")) session.set_up = SetUp::divided;
    if (name == "--set-up" && argv[i + 1] == std::string("parts")) parts = true, session.sum_order = SumOrder::of_ranks;
    if (name == "--scattered") scattered = value != 0;
  }
  set_thread_count(threads);
  const int cells = edge - 1;
  const double size = 1e-2, start = seconds();
  const Rkpm<3> kernel{.support = 2.35};
  const Box cube{.size = {size, size, size}, .cells = {cells, cells, cells}};
  Body block{"block", parts ? box_part(cube, {.rank = session.rank(), .ranks = session.size(), .support = kernel.support}) : box(cube), kernel, NodalCentroids{},
             Materials{Region{"body", NeoHookean::from_young(1e6, 0.3)}}};
  for (std::size_t i = 0; i < block.size(); ++i) {
    const double z = block.cloud().positions[i][2] / size;
    block.velocity[i][0] = 0.1 * z * z;
  }
  Simulation simulation{Bodies{std::move(block)}, Contacts{}, Boundaries{}, CentralDifference{}};
  const double set_up = seconds() - start;
  const long peak = session.largest(peak_megabytes());
  const double dt = 0.4 * simulation.largest_stable_time_step();
  const auto step = [&] { simulation.run(simulation.time() + dt); };
  step();
  std::vector<double> times;
  const std::clock_t processor_start = std::clock();
  for (int n = 0; n < steps; ++n) {
    (void)session.largest(0);
    const double before = seconds();
    step();
    times.push_back(seconds() - before);
  }
  // Which other programs disturb less: of all threads of a rank, waiting included as far as it is awake.
  const double processor = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC / steps / threads;
  std::sort(times.begin(), times.end());
  const double median = times[times.size() / 2];
  const double pairs = static_cast<double>(simulation.pairs());
  long evaluated = static_cast<long>(pairs), sent = 0;
  if (const auto* divided = dynamic_cast<const mpi::DividedBodies*>(simulation.decomposition())) {
    evaluated = static_cast<long>(divided->evaluated_pairs());
    sent = static_cast<long>(divided->sent_to_neighbors());
  }
  evaluated = session.largest(evaluated);
  sent = session.largest(sent);
  const long busiest = session.largest(static_cast<long>(1e6 * processor));
  const long resident = session.largest(resident_megabytes());
  const long table = session.largest(static_cast<long>(simulation.body<0>().memory() / 1000000));
  if (is_first_rank())
    std::printf("%d ranks x %d threads, %d^3 particles: set-up %.1f s, step %.2f ms (median; least %.2f; processor %.2f), %.3f ns/pair; "
                "largest part %.4f of the pairs (%.4f of 1/ranks), %ld numbers sent; %ld MB resident, %ld MB body; %ld MB at most in set-up\n",
                session.size(), threads, edge, set_up, 1e3 * median, 1e3 * times.front(), 1e-3 * static_cast<double>(busiest), 1e9 * median / pairs,
                static_cast<double>(evaluated) / pairs, static_cast<double>(evaluated) * session.size() / pairs, sent, resident, table, peak);
}
