// A bar of nematic gel, stretched and compressed: what it loses in a cycle. See README.md beside this file.
//
//   bar_hysteresis --frequency 1MHz --method uniform --out out/bar
//   bar_hysteresis --frequency 100kHz --bulk-modulus 2.2GPa --method inertial
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <tactoid/tactoid.hpp>

#include "common/frame_series.hpp"
#include "common/options.hpp"
#include "common/program.hpp"
#include "common/run_keeper.hpp"

using namespace tactoid;

namespace {

constexpr double pi = std::numbers::pi;

struct BarParameters {
  double frequency = 1e5;         ///< f, Hz
  std::string method = "uniform"; ///< uniform: every point follows u(X, t) = u(L, t) X/L; inertial: the ends alone are moved
  double length = 1e-4;           ///< L, m
  double amplitude = 0.25e-4;     ///< U, m
  double density = 1000.0;        ///< kg/m³
  double viscosity = 0.003;       ///< μ, Pa s
  double bulk_modulus = 6.8e5;    ///< K, Pa
  double activity = 0.1;          ///< ζ, Pa: the paper's 0.0001 if its unit is kPa
  double director_elasticity = 1e-12;  ///< η, N
  double diffusivity = 1e-7;      ///< D, m²/s
  double core_size = 0.5e-6;      ///< ε_d, m
  double left_angle = pi / 6.0;   ///< of the director at the fixed end, rad
  double right_angle = pi / 3.0;  ///< and at the moved end, rad
  int cells = 50;
  int cycles = 3;                 ///< the motion grows in the first one; the last one is recorded
  int samples = 400;              ///< of the recorded cycle
  double safety = 0.5;

  void add_to(Options& options) {
    options.add_quantity("frequency", &frequency, Quantity::frequency, Range::positive(), "Frequency of the moved end");
    options.add_choice("method", &method, {"uniform", "inertial"},
                       "Every point follows the moved end in proportion (no inertia), or only the ends are held");
    options.add_quantity("length", &length, Quantity::length, Range::positive(), "Length of the bar");
    options.add_quantity("amplitude", &amplitude, Quantity::length, Range::positive(), "Largest displacement of the moved end");
    options.add_quantity("density", &density, Quantity::density, Range::positive(), "Density");
    options.add_quantity("viscosity", &viscosity, Quantity::viscosity, Range::non_negative(), "Viscosity");
    options.add_quantity("bulk-modulus", &bulk_modulus, Quantity::pressure, Range::positive(), "Bulk modulus");
    options.add_quantity("activity", &activity, Quantity::pressure, Range::any(), "Active stress; negative is contractile");
    options.add_quantity("director-elasticity", &director_elasticity, Quantity::force, Range::non_negative(),
                         "Elastic constant of the director in the stress");
    options.add("diffusivity", &diffusivity, Range::non_negative(), "Diffusivity of the director, m^2/s");
    options.add_quantity("core-size", &core_size, Quantity::length, Range::positive(), "Core size of defects of the director");
    options.add_quantity("left-angle", &left_angle, Quantity::angle, Range::any(), "Angle of the director at the fixed end");
    options.add_quantity("right-angle", &right_angle, Quantity::angle, Range::any(), "Angle of the director at the moved end");
    options.add("cells", &cells, Range::between(2, 100000), "Cells along the bar");
    options.add("cycles", &cycles, Range::between(2, 1000), "Cycles; the motion grows in the first, the last is recorded");
    options.add("samples", &samples, Range::between(8, 1000000), "Lines of the history");
    options.add("safety", &safety, Range::between(0.01, 1.0), "Fraction of the stable time step");
  }

  /// What no single range can say.
  void validate() const {
    if (amplitude >= length)
      throw ParameterError(fmt::format("--amplitude = {:g} m is not allowed: it must be below the length of the bar, {:g} m.",
                                       amplitude, length));
  }

  [[nodiscard]] double period() const { return 1.0 / frequency; }
  [[nodiscard]] double largest_strain() const { return amplitude / length; }

  /// u(L, t): it grows smoothly, with two derivatives, in the first cycle.
  [[nodiscard]] double end_displacement(double t) const {
    const double s = std::min(t * frequency, 1.0);
    return amplitude * s * s * s * (10.0 - s * (15.0 - 6.0 * s)) * std::sin(2.0 * pi * frequency * t);
  }

  /// ∮ P dF of the bar that stretches uniformly, per volume: 4πμω (1 − √(1 − e²)), Pa.
  [[nodiscard]] double uniform_loss() const {
    const double e = largest_strain();
    return 4.0 * pi * viscosity * 2.0 * pi * frequency * (1.0 - std::sqrt(1.0 - e * e));
  }

  /// What a continued run keeps: the motion of the end, and which cycle is recorded.
  template <class Archive>
  void state(Archive& archive) const {
    archive.expect("frequency", frequency);
    archive.expect("amplitude", amplitude);
    archive.expect("cycles", cycles);
  }
};

/// What is kept of the recorded cycle.
struct RecordedCycle {
  bool begun = false;
  double work_before = 0.0, dissipated_before = 0.0;  ///< until it began, J/m²
  double peak = 0.0;                                  ///< of the mean stress, Pa
  std::vector<double> last = {};                      ///< line of the history

  template <class Archive>
  void state(Archive& archive) {
    archive("begun", begun);
    archive("work_before", work_before);
    archive("dissipated_before", dissipated_before);
    archive("peak", peak);
    archive("last", last);
  }
};

/// Means over the bar, by reference volume: the Cauchy stress along it (Pa) and the angle of the director (rad).
template <class Body>
[[nodiscard]] std::array<double, 2> means(Body& body) {
  double volume = 0.0, stress = 0.0, angle = 0.0;
  const std::vector<PointSample> samples = body.sample_points();
  for (std::size_t q = 0; q < samples.size(); ++q) {
    const double V = body.table().volume[q];
    const Vector4& h = body.director[body.table().owner[q]];
    volume += V;
    stress += V * samples[q].cauchy(0, 0);
    angle += V * std::atan2(h[1], h[0]);
  }
  return {stress / volume, angle / volume};
}

int run(int argc, char** argv) {
  BarParameters p;
  std::string out = "out/bar_hysteresis";
  int threads = 1, frames = 4;
  Options options("bar_hysteresis",
                  "A bar of active nematic gel under a periodic motion of its end (Zeng and Li, Soft Matter 2012, 8, 5765, Fig. 3).");
  p.add_to(options);
  Restart restart;
  restart.add_to(options);
  options.add("out", &out, "Folder of the results");
  options.add("threads", &threads, Range::between(1, 1024), "Threads");
  options.add("frames", &frames, Range::between(1, 100000), "Frames for ParaView of the recorded cycle");
  if (!options.parse(argc, argv)) return 0;
  p.validate();
  set_thread_count(threads);

  PointCloud<1> cloud = bar({.length = p.length, .cells = p.cells});
  const double L = p.length;
  const auto left = select(cloud, [=](const Point<1>& X) { return X[0] < 1e-9 * L; });
  const auto right = select(cloud, [=](const Point<1>& X) { return X[0] > L * (1.0 - 1e-9); });
  const auto inside = select(cloud, [=](const Point<1>& X) { return X[0] >= 1e-9 * L && X[0] <= L * (1.0 - 1e-9); });
  const auto stretched = [&](std::vector<Index> particles) {
    return PrescribedMotion{std::move(particles),
                            [&p, L](const Vector3& X, double t) { return Vector3(p.end_displacement(t) * X[0] / L, 0.0, 0.0); }};
  };
  Body body{"bar",
            std::move(cloud),
            Rkpm<1>{},
            NodalCentroids{.fluid_modulus = 0.0},
            Materials{Region{"body", NematicGel<>{.density = p.density,
                                                  .viscosity = p.viscosity,
                                                  .bulk_modulus = p.bulk_modulus,
                                                  .reference_pressure = 0.0,
                                                  .director_elasticity = p.director_elasticity,
                                                  .activity = p.activity}}},
            DirectorField<>{.diffusivity = p.diffusivity, .core_size = p.core_size},
            [&](const Vector3& X) {
              const double angle = p.left_angle + (p.right_angle - p.left_angle) * X[0] / L;
              return Vector3(std::cos(angle), std::sin(angle), 0.0);
            }};
  body.anchored.assign(body.size(), 0);
  for (const auto* end : {&left, &right})
    for (const Index i : *end) body.anchored[i] = 1;
  Simulation simulation{
      Bodies{std::move(body)}, Contacts{},
      Boundaries{on<0>(stretched(right)), on<0>(fixed(left)),
                 on<0>(stretched(p.method == "uniform" ? inside : std::vector<Index>{}))},
      CentralDifference{.safety = p.safety, .max_time_step = p.period() / 2000.0}};

  RecordedCycle recorded;
  restart.restore("motion", p);
  restart.restore("recorded", recorded);
  const std::optional<double> resumed_at = restart.resume(simulation);
  const std::filesystem::path folder = out;
  prepare_folder(folder);
  const std::vector<std::string> columns = {"time",           "strain",        "stress",         "end_stress", "director_angle",
                                            "kinetic_energy", "strain_energy", "dissipated_energy", "external_work", "energy_error"};
  HistoryWriter history(folder / "history.csv", columns, resumed_at);
  FrameSeries series(folder, {"bar"}, resumed_at);
  restart.restore("series", series);
  restart.announce(simulation);
  options.write_toml(folder / "parameters.toml");
  RunKeeper keeper(restart, options, folder, [&](StateWriter& writer) {
    writer.part("motion", p);
    writer.part("recorded", recorded);
    writer.part("simulation", simulation);
    writer.part("series", series);
  });
  const auto record = [&](auto& s) {
    const auto [stress, angle] = means(s.template body<0>());
    const EnergyLedger& e = s.ledger();
    recorded.last = {s.time(), p.end_displacement(s.time()) / L, stress, reactions<0>(s).conditions[0][0], angle, e.kinetic,
                     e.strain, e.dissipated, e.external_work, e.error()};
    history.write(recorded.last);
    recorded.peak = std::max(recorded.peak, std::abs(stress));
  };
  const auto write_frame = [&](auto& s) {
    series.next();
    series.add(0, s.template body<0>(), s.template particles<0>(), s.time());
  };
  const double recorded_from = (p.cycles - 1) * p.period(), end = p.cycles * p.period();
  fmt::print("{} particles, {} cycles of {:g} s, stable step {:.3g} s\n", simulation.body<0>().size(), p.cycles, p.period(),
             simulation.largest_stable_time_step());
  const std::size_t first_step = simulation.steps();
  Progress progress(end, simulation.time());
  auto show = every_steps(1000, [&](auto& s) { progress.update(s.time(), s.steps() - first_step); });
  auto keep = every_steps(1, [&](auto&) { keeper.check(); });
  const auto finish = [&](bool completed) {
    progress.finish();
    Summary summary;
    for (std::size_t i = 0; i < recorded.last.size(); ++i) summary.set(columns[i], recorded.last[i]);
    if (completed) {
      summary.set("loss", (simulation.ledger().external_work - recorded.work_before) / L);
      summary.set("dissipated", (simulation.ledger().dissipated - recorded.dissipated_before) / L);
      summary.set("uniform_loss", p.uniform_loss()).set("peak_stress", recorded.peak);
    }
    summary.set("steps", simulation.steps()).set("particles", simulation.body<0>().size());
    summary.set("end_speed_over_wave_speed", 2.0 * pi * p.frequency * p.amplitude / std::sqrt(p.bulk_modulus / p.density));
    summary.set("threads", thread_count()).set("version", version).set("completed", completed);
    summary.write(folder / "summary.json");
  };
  keeper.run([&] {
    if (!recorded.begun) {
      simulation.run(recorded_from, show, keep);
      recorded.begun = true;
      recorded.work_before = simulation.ledger().external_work;
      recorded.dissipated_before = simulation.ledger().dissipated;
    }
    simulation.run(end, every(p.period() / p.samples, record), every(p.period() / frames, write_frame), show, keep);
  }, finish);
  fmt::print("{} steps; loss per cycle and volume {:.6g} Pa, of the uniform bar exactly {:.6g} Pa; results in {}\n",
             simulation.steps(), (simulation.ledger().external_work - recorded.work_before) / L, p.uniform_loss(), out);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return run_program("bar_hysteresis", [&] { return run(argc, argv); });
}
