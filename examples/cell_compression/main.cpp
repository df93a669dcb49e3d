// A cell, or an elastic ball, pressed between two rigid plates: force against reduction. See README.md beside this file.
//
//   cell_compression --body cell --nucleus 0.618 --duration 200us --out out/compression
//   cell_compression --body core-shell --method static
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tactoid/tactoid.hpp>

#include "common/frame_series.hpp"
#include "common/octant.hpp"
#include "common/options.hpp"
#include "common/program.hpp"
#include "common/run_keeper.hpp"

using namespace tactoid;

namespace {

struct CompressionParameters {
  std::string body = "cell";         ///< cell; homogeneous: all of the nucleus' material; core-shell: with a softer shell
  std::string method = "explicit";   ///< explicit: dynamics; static: equilibria (elastic bodies)
  double reduction = 0.5;            ///< (H₀ − H)/H₀ at the end, H the distance of the plates
  double duration = 100e-6;          ///< of the motion of the plates, s
  double ramp = 0.1;                 ///< part of the duration in which the plates come to their speed
  double resolution = 1.0;           ///< scales the numbers of cells in each direction
  double radius = 5e-6;              ///< of the body, m
  double nucleus = 0.382;            ///< radius of the nucleus over that of the body
  double density = 1000.0;           ///< kg/m³
  double nucleus_c1 = 2126.0, nucleus_c2 = 170.0, nucleus_lambda = 1.7e5;  ///< Pa
  double shell_ratio = 1.0 / 9.0;    ///< stiffness of the elastic shell over that of the core
  double viscosity = 0.003;          ///< μ of the gel, Pa s
  double bulk_modulus = 6.8e5;       ///< K of the gel, Pa
  double surface_tension = 0.072e-3; ///< of the cell, N/m
  double penalty = 5e12;             ///< of the plates, Pa/m; their elastic depth is taken off the reduction
  double support = 1.75;             ///< of the kernel, per longest edge
  double hourglass = 0.12;           ///< stabilisation modulus over the shear modulus, in the solids
  double fluid_hourglass = 5.0;      ///< stabilisation modulus of the gel, Pa
  double safety = 0.8;               ///< of the stable time step
  int samples = 100;                 ///< lines of the history

  void add_to(Options& options) {
    options.add_choice("body", &body, {"cell", "homogeneous", "core-shell"},
                       "A gel with a nucleus, a ball of the nucleus' material, or one with a softer elastic shell");
    options.add_choice("method", &method, {"explicit", "static"}, "Dynamics, or equilibria of the elastic bodies");
    options.add("reduction", &reduction, Range::inside(0.0, 0.9), "Reduction of the height, (H0 - H)/H0, at the end");
    options.add_quantity("duration", &duration, Quantity::time, Range::positive(), "Time in which the plates move");
    options.add("ramp", &ramp, Range::inside(0.0, 1.0), "Part of that time in which they come to their speed");
    options.add("resolution", &resolution, Range::between(0.2, 10.0), "Scales the numbers of cells in each direction");
    options.add_quantity("radius", &radius, Quantity::length, Range::positive(), "Radius of the body");
    options.add("nucleus", &nucleus, Range::inside(0.0, 1.0), "Radius of the nucleus over that of the body");
    options.add_quantity("density", &density, Quantity::density, Range::positive(), "Density");
    options.add_quantity("nucleus-c1", &nucleus_c1, Quantity::pressure, Range::positive(), "C1 of the nucleus");
    options.add_quantity("nucleus-c2", &nucleus_c2, Quantity::pressure, Range::non_negative(), "C2 of the nucleus");
    options.add_quantity("nucleus-lambda", &nucleus_lambda, Quantity::pressure, Range::positive(), "Lambda of the nucleus");
    options.add("shell-ratio", &shell_ratio, Range::positive(), "Stiffness of the elastic shell over that of the core");
    options.add_quantity("viscosity", &viscosity, Quantity::viscosity, Range::non_negative(), "Viscosity of the gel");
    options.add_quantity("bulk-modulus", &bulk_modulus, Quantity::pressure, Range::positive(), "Bulk modulus of the gel");
    options.add_quantity("surface-tension", &surface_tension, Quantity::surface_tension, Range::non_negative(),
                         "Surface tension of the cell");
    options.add("penalty", &penalty, Range::positive(), "Stiffness of the plates, Pa/m");
    options.add("support", &support, Range::between(1.2, 4.0), "Support of the kernel per longest cell edge");
    options.add("hourglass", &hourglass, Range::non_negative(), "Stabilisation over shear modulus in the solids");
    options.add_quantity("fluid-hourglass", &fluid_hourglass, Quantity::pressure, Range::non_negative(),
                         "Stabilisation modulus of the gel");
    options.add("safety", &safety, Range::between(0.01, 1.0), "Fraction of the stable time step");
    options.add("samples", &samples, Range::between(2, 100000), "Lines of the history");
  }

  /// What no single range can say.
  void validate() const {
    if (body == "cell" && method == "static")
      throw ParameterError(
          "--method static is not allowed with --body cell: a fluid gel carries no shear at rest; use --method explicit, or "
          "--body homogeneous or core-shell.");
  }

  /// An eighth of the ball, by symmetry.
  [[nodiscard]] PointCloud<3> cloud() const {
    const auto even = [&](double n) { return 2 * std::max(1, static_cast<int>(std::lround(0.5 * n * resolution))); };
    return octant(ball({.radius = radius,
                        .core_radius = nucleus * radius,
                        .core_cells = even(10.0),
                        .shells = std::max(1, static_cast<int>(std::lround(5.0 * resolution)))}),
                  radius);
  }
  [[nodiscard]] NodalCentroids quadrature() const {
    return {.solid_ratio = hourglass, .fluid_modulus = fluid_hourglass};
  }
  [[nodiscard]] double tension() const { return body == "cell" ? surface_tension : 0.0; }
  [[nodiscard]] double rest_pressure() const { return 2.0 * tension() / radius; }
  [[nodiscard]] ModifiedMooneyRivlin nucleus_law() const {
    return {.density = density, .c1 = nucleus_c1, .c2 = nucleus_c2, .lambda = nucleus_lambda, .initial_pressure = rest_pressure()};
  }
  [[nodiscard]] ModifiedMooneyRivlin shell_law() const {
    return nucleus_law().scaled(body == "core-shell" ? shell_ratio : 1.0);
  }
  [[nodiscard]] NematicGel<> gel() const {
    return {.density = density,
            .viscosity = viscosity,
            .bulk_modulus = bulk_modulus,
            .reference_pressure = rest_pressure(),
            .director_elasticity = 0.0,
            .activity = 0.0};
  }

  /// How far each plate has moved, m: smoothly from rest, then steadily.
  [[nodiscard]] double depth(double t) const {
    const double s = std::clamp(t / duration, 0.0, 1.0), x = std::min(1.0, s / ramp);
    return radius * reduction / (1.0 - 0.5 * ramp) * (ramp * (x * x * x - 0.5 * x * x * x * x) + std::max(0.0, s - ramp));
  }
  [[nodiscard]] double speed(double t) const {
    const double x = std::clamp(t / duration / ramp, 0.0, 1.0);
    return radius * reduction / (1.0 - 0.5 * ramp) / duration * (3.0 - 2.0 * x) * x * x;
  }

  /// What a continued run keeps: the motion of the plates.
  template <class Archive>
  void state(Archive& archive) const {
    archive.expect("reduction", reduction);
    if (method == "static") {
      archive.expect("samples", samples);
    } else {
      archive.expect("duration", duration);
      archive.expect("ramp", ramp);
    }
  }
};

/// Particles in the plane of symmetry normal to direction k.
std::vector<Index> cut(const PointCloud<3>& cloud, int k) {
  return select(cloud, [k](const Point<3>& X) { return X[k] == 0.0; });
}
/// The conditions of symmetry.
std::vector<PrescribedMotion> symmetry(const PointCloud<3>& cloud) {
  return {fixed(cut(cloud, 0), {true, false, false}), fixed(cut(cloud, 1), {false, true, false}),
          fixed(cut(cloud, 2), {false, false, true})};
}

/// Writes history.csv, the frames and summary.json.
class Recorder {
 public:
  /// Where a continued run stands.
  struct Place {
    double line;   ///< time in the history, s; of equilibria the depth of the plates, m
    double frame;  ///< time of the frames
  };
  /// With `resumed_at` it goes on with the files of the run that is continued, and awaits its state.
  Recorder(const CompressionParameters& p, std::filesystem::path folder, std::optional<Place> resumed_at)
      : p_(p),
        folder_(std::move(folder)),
        history_(folder_ / "history.csv", columns(), resumed_at ? std::optional(resumed_at->line) : std::nullopt,
                 p.method == "static" ? "plate_depth" : "time"),
        series_(folder_, {"body"}, resumed_at ? std::optional(resumed_at->frame) : std::nullopt) {}

  template <class Archive>
  void state(Archive& archive) {
    archive("last", last_);
    series_.state(archive);
  }

  static std::vector<std::string> columns() {
    return {"reduction",     "force",          "time",          "plate_depth",   "kinetic_energy",
            "strain_energy", "surface_energy", "dissipated_energy", "external_work", "energy_error",
            "nucleus_effective_stress_mean", "nucleus_reduction"};
  }

  /// `on_plate`: force on the plate of the octant, N; `layer`: energy in the plate's penalty, J; energies of the octant.
  template <class Body>
  void record(Body& body, const ParticleFields& fields, double time, double depth, double on_plate, double layer,
              const EnergyLedger& e) {
    // The plate is an elastic layer; the mean depth of what lies in it, weighted by the force, is 2 U/F.
    const double penetration = on_plate > 0.0 ? 2.0 * layer / on_plate : 0.0;
    const RegionStatistics nucleus =
        region_statistics(body.table(), stress_fields(body).point_effective_stress, nucleus_region(body));
    last_ = {(depth - penetration) / p_.radius, 4.0 * on_plate, time, depth, 8.0 * e.kinetic, 8.0 * (e.strain + e.stabilization),
             8.0 * e.surface, 8.0 * e.dissipated, 8.0 * e.external_work, e.error(), nucleus.mean,
             1.0 - height(body, fields) / (p_.nucleus * p_.radius)};
    history_.write(last_);
  }
  template <class Body>
  void write_frame(Body& body, const ParticleFields& fields, double time) {
    series_.next();
    series_.add(0, body, fields, time);
  }
  void write_summary(std::size_t particles, std::size_t steps, double seconds, bool completed) const {
    Summary summary;
    const std::vector<std::string> names = columns();
    for (std::size_t i = 0; i < names.size() && i < last_.size(); ++i) summary.set(names[i], last_[i]);
    summary.set("particles", particles).set("steps", steps).set("wall_seconds", seconds).set("threads", thread_count());
    summary.set("version", version).set("completed", completed);
    summary.write(folder_ / "summary.json");
  }

 private:
  template <class Body>
  static Index nucleus_region(const Body& body) {
    const auto& names = body.cloud().regions;
    return static_cast<Index>(std::find(names.begin(), names.end(), "nucleus") - names.begin());
  }
  /// Of the nucleus' top on the axis, m.
  template <class Body>
  double height(const Body& body, const ParticleFields& fields) const {
    for (std::size_t i = 0; i < body.size(); ++i) {
      const Point<3>& X = body.cloud().positions[i];
      if (X[0] == 0.0 && X[1] == 0.0 && std::abs(X[2] - p_.nucleus * p_.radius) < 1e-6 * p_.radius) return fields.position[i][2];
    }
    return 0.0;
  }

  const CompressionParameters& p_;
  std::filesystem::path folder_;
  HistoryWriter history_;
  FrameSeries series_;
  std::vector<double> last_;
};

/// What a run needs beside its body.
struct Run {
  const CompressionParameters& p;
  const Options& options;
  const Restart& restart;
  std::filesystem::path folder;
  int frames;

  /// The folder with its first files, or a continued run's.
  [[nodiscard]] Recorder start_recording(std::optional<Recorder::Place> resumed_at) const {
    prepare_folder(folder);
    Recorder recorder(p, folder, resumed_at);
    restart.restore("recorder", recorder);
    options.write_toml(folder / "parameters.toml");
    return recorder;
  }
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The plates close in the dynamics.
template <class Body>
void run_explicit(const Run& run, Body body) {
  const CompressionParameters& p = run.p;
  const auto is_surface = [R = p.radius](const Point<3>& X) { return X.norm() > R * (1.0 - 1e-9); };
  const RigidPlane plane{.point = {0.0, 0.0, p.radius}, .normal = -Vector3::UnitZ()};
  OnRigid<RepulsiveWall, Moving<RigidPlane>> plate{
      .law = {.penalty = p.penalty},
      .surface = {plane, [&p](double t) { return Vector3(0.0, 0.0, -p.depth(t)); },
                  [&p](double t) { return Vector3(0.0, 0.0, -p.speed(t)); }}};
  // No step is longer than the plate's penalty allows, wherever it touches.
  const FacetSurface<3> facets(with_facets_where(body.cloud(), is_surface));
  double rate = 0.0;
  for (const Index i : facets.nodes) rate = std::max(rate, p.penalty * facets.nodal_area[i] / body.masses()[i]);
  auto conditions = symmetry(body.cloud());
  Simulation simulation{Bodies{std::move(body)}, Contacts{},
                        Boundaries{on<0>(OnFacets{std::move(plate), is_surface}),
                                   on<0>(OnFacets{SurfaceTension{.tension = p.tension()}, is_surface}), on<0>(conditions[0]),
                                   on<0>(conditions[1]), on<0>(conditions[2])},
                        CentralDifference{.safety = p.safety,
                                          .max_time_step = 1.0 / std::sqrt(rate),
                                          .min_time_step = 20e-12}};  // below it the gel is squeezed out: no end in sight
  run.restart.restore("plates", p);
  std::optional<Recorder::Place> resumed_at;
  if (const auto time = run.restart.resume(simulation)) resumed_at = {*time, *time};
  Recorder recorder = run.start_recording(resumed_at);
  run.restart.announce(simulation);
  RunKeeper keeper(run.restart, run.options, run.folder, [&](StateWriter& writer) {
    writer.part("plates", p);
    writer.part("simulation", simulation);
    writer.part("recorder", recorder);
  });
  const auto start = std::chrono::steady_clock::now();
  const std::size_t first_step = simulation.steps();
  Progress progress(p.duration, simulation.time());
  const auto finish = [&](bool completed) {
    progress.finish();
    recorder.write_summary(simulation.template body<0>().size(), static_cast<std::size_t>(simulation.steps()), seconds_since(start),
                           completed);
  };
  keeper.run([&] {
    simulation.run(
        p.duration, every(p.duration / p.samples, [&](auto& s) {
          auto& wall = s.template boundary<0>().term;
          recorder.record(s.template body<0>(), s.template particles<0>(), s.time(), p.depth(s.time()), wall.force().z(),
                          wall.energy(), s.ledger());
        }),
        every(p.duration / run.frames, [&](auto& s) { recorder.write_frame(s.template body<0>(), s.template particles<0>(), s.time()); }),
        every_steps(100, [&](auto& s) { progress.update(s.time(), s.steps() - first_step); }),
        every_steps(1, [&](auto&) { keeper.check(); }));
  }, finish);
  fmt::print("{} steps in {:.1f} s, energy error {:.2g} %\n", simulation.steps(), seconds_since(start),
             100.0 * simulation.ledger().error());
}

/// How far a run of equilibria is.
struct LoadSteps {
  int done = 0;        ///< with the one at rest
  int iterations = 0;  ///< of Newton's method
  template <class Archive>
  void state(Archive& archive) {
    archive("done", done);
    archive("iterations", iterations);
  }
};

/// One equilibrium after the other, for as many positions of the plates as the history has lines.
template <class Body>
void run_static(const Run& run, Body body) {
  const CompressionParameters& p = run.p;
  const auto is_surface = [R = p.radius](const Point<3>& X) { return X.norm() > R * (1.0 - 1e-9); };
  const auto depth_of = [&](int k) { return p.radius * p.reduction * k / p.samples; };
  const auto fraction = [&](int k) { return static_cast<double>(k) / p.samples; };
  // It is continued behind the last equilibrium: what Newton's method had of the next one is lost, and computed again.
  LoadSteps steps;
  run.restart.restore("plates", p);
  run.restart.restore("load_steps", steps);
  run.restart.restore("body", body);
  std::optional<Recorder::Place> resumed_at;
  if (run.restart.from) {
    resumed_at = {depth_of(steps.done - 1), fraction(steps.done - 1)};
    fmt::print("going on behind equilibrium {} of {}\n", steps.done - 1, p.samples);
  }
  Recorder recorder = run.start_recording(resumed_at);
  RunKeeper keeper(run.restart, run.options, run.folder, [&](StateWriter& writer) {
    writer.part("plates", p);
    writer.part("load_steps", steps);
    writer.part("body", body);
    writer.part("recorder", recorder);
  });
  const auto start = std::chrono::steady_clock::now();
  Progress progress(1.0, resumed_at ? resumed_at->frame : 0.0);
  BodyFields fields;
  fields.prepare(body);
  const auto finish = [&](bool completed) {
    progress.finish();
    recorder.write_summary(body.size(), static_cast<std::size_t>(steps.iterations), seconds_since(start), completed);
  };
  keeper.run([&] {
    while (steps.done <= p.samples) {
      const int k = steps.done;
      const double depth = depth_of(k);
      EnergyLedger energies;
      double force = 0.0, layer = 0.0;
      if (k > 0) {
        StaticProblem problem(body, symmetry(body.cloud()),
                              OnFacets{OnRigid<>{.law = {.penalty = p.penalty},
                                                 .surface = {.point = {0.0, 0.0, p.radius - depth}, .normal = -Vector3::UnitZ()}},
                                       is_surface});
        steps.iterations += StaticNewton{.tolerance = 1e-9, .max_iterations = 60}.solve(problem).iterations;
        force = problem.reaction(2)[2];  // of the middle plane: as much as the plate's
        layer = energies.surface = problem.term_energy().potential;
        energies.strain = problem.energies().strain_energy;
        energies.stabilization = problem.energies().stabilization_energy;
      }
      fields.refresh(body, 0.0);
      recorder.record(body, fields.view(body), 0.0, depth, force, layer, energies);
      if (k * run.frames / p.samples != (k - 1) * run.frames / p.samples || k == 0) recorder.write_frame(body, fields.view(body), fraction(k));
      progress.update(fraction(k), static_cast<std::uint64_t>(steps.iterations));
      ++steps.done;
      keeper.check();
    }
  }, finish);
  fmt::print("{} equilibria, {} iterations in {:.1f} s\n", p.samples, steps.iterations, seconds_since(start));
}

int compress(int argc, char** argv) {
  CompressionParameters p;
  std::string out = "out/cell_compression";
  int threads = thread_count(), frames = 5;
  Options options("cell_compression",
                  "A cell or an elastic ball between two rigid plates: force against reduction (Zeng and Li, Soft Matter 2012, 8, "
                  "5765, Fig. 4).");
  p.add_to(options);
  Restart restart;
  restart.add_to(options);
  options.add("out", &out, "Folder of the results");
  options.add("threads", &threads, Range::between(1, 1024), "Threads");
  options.add("frames", &frames, Range::between(1, 100000), "Frames for ParaView");
  if (!options.parse(argc, argv)) return 0;
  p.validate();
  set_thread_count(threads);

  const Run run{p, options, restart, out, frames};
  if (p.body == "cell") {
    Body body{"cell",
              p.cloud(),
              Rkpm<3>{.support = p.support},
              p.quadrature(),
              Materials{Region{"nucleus", p.nucleus_law()}, Region{"cytoplasm", p.gel()}},
              DirectorField<>{},
              UniformDirector(Vector3::UnitZ())};
    run_explicit(run, std::move(body));
  } else {
    Body body{"ball", p.cloud(), Rkpm<3>{.support = p.support}, p.quadrature(),
              Materials{Region{"nucleus", p.nucleus_law()}, Region{"cytoplasm", p.shell_law()}}};
    if (p.method == "static")
      run_static(run, std::move(body));
    else
      run_explicit(run, std::move(body));
  }
  fmt::print("Results in {}\n", out);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return run_program("cell_compression", [&] { return compress(argc, argv); });
}
