// A cell adheres to and spreads on a uniform substrate: the main job of Tactoid. See README.md beside this file.
//
//   spreading_uniform --stiffness 10 --end-time 5us --out out/spreading_uniform
//   spreading_uniform --resolution 0.5 --end-time 2us --preset elastic --stiffness 2
#include <chrono>

#include <tactoid/tactoid.hpp>

#include "common/options.hpp"
#include "common/program.hpp"
#include "common/spreading_parameters.hpp"
#include "common/spreading_recorder.hpp"

using namespace tactoid;

namespace {

int run(int argc, char** argv) {
  SpreadingParameters p;
  std::string out = "out/spreading_uniform";
  int threads = thread_count(), frames = 20, samples = 200;
  double energy_limit = 0.1;
  Options options("spreading_uniform",
                  "A cell adheres to and spreads on a uniform substrate (Zeng and Li, Soft Matter 2012, 8, 5765).");
  p.add_to(options);
  options.add("out", &out, "Folder of the results");
  options.add("threads", &threads, Range::between(1, 1024), "Threads");
  options.add("frames", &frames, Range::between(1, 100000), "Frames for ParaView");
  options.add("samples", &samples, Range::between(1, 1000000), "Lines of the history");
  options.add("max-energy-error", &energy_limit, Range::positive(), "Relative energy error that stops the run");
  if (!options.parse(argc, argv)) return 0;
  set_thread_count(threads);

  const auto start = std::chrono::steady_clock::now();
  PointCloud<3> substrate_cloud = p.substrate_cloud();
  const auto bottom =
      select(substrate_cloud, [&](const Point<3>& X) { return X[2] < -p.substrate_height * (1.0 - 1e-9); });
  PointCloud<3> cell_cloud = p.cell_cloud();
  Field director = p.director_field(cell_cloud);

  Body cell{"cell",
            std::move(cell_cloud),
            Rkpm<3>{.support = p.support},
            p.quadrature(),
            Materials{Region{"nucleus", p.nucleus_law()}, Region{"cytoplasm", p.cytoplasm_law()}},
            DirectorField<>{.diffusivity = p.diffusivity, .core_size = p.core_size},
            std::move(director)};
  Body substrate{"substrate", std::move(substrate_cloud), Rkpm<3>{.support = p.support}, p.quadrature(),
                 Materials{Region{"body", p.substrate_law(p.stiffness)}}};
  Simulation simulation{
      Bodies{std::move(cell), std::move(substrate)},
      Contacts{between<0, 1>(p.ligand_receptor()), between<0, 1>(p.van_der_waals_force()),
               between<0, 1>(ContactAnchoring{.capture_distance = p.anchoring ? p.bond_range : 1e-30})},
      Boundaries{on<0>(SurfaceTension{.tension = p.surface_tension}), on<1>(fixed(bottom))},
      CentralDifference{.safety = p.safety, .time_step = p.time_step}};

  prepare_folder(out);
  options.write_toml(std::filesystem::path(out) / "parameters.toml");
  SpreadingRecorder recorder(out, p.bond_range);
  Progress progress(p.end_time);
  fmt::print("cell {} particles, substrate {} particles, {} pairs, first stable step {:.3g} ns, {} threads\n",
             simulation.body<0>().size(), simulation.body<1>().size(), simulation.pairs(),
             1e9 * simulation.largest_stable_time_step(), thread_count());
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const double setup = seconds();
  const auto watch_energy = [&](auto& s) {
    const double error = s.ledger().error();
    if (s.steps() < 100 || error <= energy_limit) return;  // at first there is little work to compare with
    recorder.record(s);
    recorder.write_frame(s);
    throw ComputationError(fmt::format(
        "The energy balance is off by {:.3g} % at t = {:.6g} s, and --max-energy-error allows {:.3g} %; likely causes are "
        "too weak a stabilisation or too large a time step.",
        100.0 * error, s.time(), 100.0 * energy_limit));
  };
  const auto finish = [&](bool completed) {
    progress.finish();
    recorder.write_summary(simulation, seconds() - setup, completed);
  };
  try {
    simulation.run(p.end_time, every(p.end_time / samples, [&](auto& s) { recorder.record(s); }),
                   every(p.end_time / frames, [&](auto& s) { recorder.write_frame(s); }),
                   every_steps(10, [&](auto& s) {
                     progress.update(s.time(), s.steps());
                     watch_energy(s);
                   }));
  } catch (const ComputationError&) {
    finish(false);
    throw;
  }
  finish(true);
  fmt::print("{} steps in {:.1f} s (set-up {:.1f} s), energy error {:.2g} %; results in {}\n", simulation.steps(),
             seconds() - setup, setup, 100.0 * simulation.ledger().error(), out);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return run_program("spreading_uniform", [&] { return run(argc, argv); });
}
