// A body from a mesh of your own: an elastic cell of any shape falls on a rigid plate. See README.md beside this file.
//
//   gmsh -3 -format msh41 examples/own_mesh/cell.geo -o cell.msh
//   own_mesh --mesh cell.msh --out out/own_mesh
//   own_mesh --mesh cell.vtu --region-array part ...      own_mesh --mesh points.csv --alpha 1.4 ...
#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tactoid/input/vtu_zlib.hpp>
#include <tactoid/tactoid.hpp>

#include "common/frame_series.hpp"
#include "common/options.hpp"
#include "common/program.hpp"
#include "common/run_keeper.hpp"

namespace {

struct Input {
  std::string mesh = "cell.msh", region_array;
  double scale = 1e-6, alpha = tactoid::PointsOptions{}.alpha;
  int nucleus = 1, cytoplasm = 2;  // numbers of the regions in a VTU file
};

/// The body in a file, by the ending of its name.
tactoid::PointCloud<3> read(const Input& input) {
  using namespace tactoid;
  const std::string ending = std::filesystem::path(input.mesh).extension().string();
  if (ending == ".msh") return read_gmsh<3>(input.mesh, {.scale = input.scale});
  if (ending == ".vtu")
    return read_vtu<3>(input.mesh, {.scale = input.scale,
                                    .region = input.region_array,
                                    .region_names = {{input.nucleus, "nucleus"}, {input.cytoplasm, "cytoplasm"}},
                                    .decompress = zlib_decompress});
  if (ending == ".csv") return read_csv<3>(input.mesh, {.scale = input.scale, .alpha = input.alpha});
  throw ParameterError(fmt::format("mesh = {} is not allowed: its name must end with .msh, .vtu or .csv.", in_quotes(input.mesh)));
}

}  // namespace

int main(int argc, char** argv) {
  using namespace tactoid;
  return run_program("own_mesh", [&] {
    Input input;
    std::string out = "out/own_mesh";
    double nucleus = 15e3, cytoplasm = 1.5e3, poisson = 0.45, speed = 0.3, end_time = 20e-6;
    int threads = thread_count(), frames = 20;
    Restart restart;
    Options options("own_mesh", "A body from a file, with the regions nucleus and cytoplasm, falls on a rigid plate.");
    options.add("mesh", &input.mesh, "File of Gmsh (.msh, version 4.1), of VTK (.vtu): hexahedra or tetrahedra; or a table of points (.csv)");
    options.add("region-array", &input.region_array, "Cell array with the regions in a VTU file; empty: region or gmsh:physical");
    options.add("nucleus-region", &input.nucleus, Range::between(-1000000, 1000000), "Number of the nucleus in a VTU file");
    options.add("cytoplasm-region", &input.cytoplasm, Range::between(-1000000, 1000000), "Number of the cytoplasm in a VTU file");
    options.add("alpha", &input.alpha, Range::positive(), "Largest radius of a tetrahedron between points of a table, in their spacings");
    options.add_quantity("scale", &input.scale, Quantity::length, Range::positive(), "The unit of length of the file");
    options.add_quantity("nucleus", &nucleus, Quantity::pressure, Range::positive(), "Young's modulus of the nucleus");
    options.add_quantity("cytoplasm", &cytoplasm, Quantity::pressure, Range::positive(), "Young's modulus of the cytoplasm");
    options.add("poisson", &poisson, Range::inside(0.0, 0.5), "Poisson's ratio of both");
    options.add_quantity("speed", &speed, Quantity::velocity, Range::non_negative(), "Speed of the fall");
    options.add_quantity("end-time", &end_time, Quantity::time, Range::positive(), "Simulated time");
    restart.add_to(options);
    options.add("out", &out, "Folder of the results");
    options.add("threads", &threads, Range::between(1, 1024), "Threads");
    options.add("frames", &frames, Range::between(1, 100000), "Frames for ParaView");
    if (!options.parse(argc, argv)) return 0;
    set_thread_count(threads);
    const auto start = std::chrono::steady_clock::now();

    PointCloud<3> cloud = read(input);
    fmt::print("{}: {} particles, {} cells, {} facets, volume {:.4g} m^3\n", input.mesh, cloud.size(), cloud.cells.size(), cloud.facets.size(),
               volume(cloud));
    double bottom = cloud.positions.front()[2];
    for (const Point<3>& X : cloud.positions) bottom = std::min(bottom, X[2]);

    // A mesh of tetrahedra has its particles nearer to each other than its edges are long: a smaller support is enough.
    Body cell{"cell", std::move(cloud), Rkpm<3>{.support = 1.5}, NodalCentroids{},
              Materials{Region{"nucleus", NeoHookean::from_young(nucleus, poisson)},
                        Region{"cytoplasm", NeoHookean::from_young(cytoplasm, poisson)}}};
    std::fill(cell.velocity.begin(), cell.velocity.end(), Vector4(0.0, 0.0, -speed, 0.0));
    Simulation simulation{Bodies{std::move(cell)}, Contacts{},
                          Boundaries{on<0>(RigidPlate{.point = {0.0, 0.0, bottom - 0.05 * input.scale}, .law = RepulsiveWall{.penalty = 1e11}})},
                          CentralDifference{.safety = 0.5}};

    const std::optional<double> resumed_at = restart.resume(simulation);
    Restart::require_end_after(resumed_at, end_time);
    const std::filesystem::path folder = out;
    prepare_folder(folder);
    const std::vector<std::string> columns{"time", "height", "force", "kinetic_energy", "strain_energy", "energy_error"};
    const auto values = [&](auto& s) {
      const EnergyLedger& e = s.ledger();
      return std::array{s.time(), motion(s.template particles<0>()).center_of_mass[2] - bottom, -s.template boundary<0>().force().z(),
                        e.kinetic, e.strain + e.stabilization, e.error()};
    };
    HistoryWriter history(folder / "history.csv", columns, resumed_at);
    FrameSeries series(folder, {"cell"}, resumed_at);
    restart.restore("series", series);
    restart.announce(simulation);
    options.write_toml(folder / "parameters.toml");
    RunKeeper keeper(restart, options, folder, [&](StateWriter& writer) {
      writer.part("simulation", simulation);
      writer.part("series", series);
    });
    // The last values, what the run took (a continued one: since then), and whether it came to its end.
    const auto finish = [&](bool completed) {
      Summary summary;
      const auto last = values(simulation);
      for (std::size_t i = 0; i < columns.size(); ++i) summary.set(columns[i], last[i]);
      summary.set("particles", simulation.body<0>().size()).set("steps", simulation.steps());
      summary.set("wall_seconds", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      summary.set("threads", thread_count()).set("version", version).set("completed", completed);
      summary.write(folder / "summary.json");
    };
    keeper.run([&] {
      simulation.run(end_time, every(end_time / 200, [&](auto& s) { history.write(values(s)); }),
                     every(end_time / frames, [&](auto& s) {
                       series.next();
                       series.add(0, s.template body<0>(), s.template particles<0>(), s.time());
                     }),
                     every_steps(1, [&](auto&) { keeper.check(); }));
    }, finish);
    fmt::print("{} steps, energy error {:.2g} %; results in {}\n", simulation.steps(), 100.0 * simulation.ledger().error(), out);
    return 0;
  });
}
