#pragma once

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <tactoid/tactoid.hpp>

#include <common/frame_series.hpp>

namespace tactoid {

/// Observes a simulation of a cell (body 0) on a substrate (body 1), in 3 dimensions or in a meridian section (D = 2), and
/// writes, in a folder, history.csv, front.csv (the shape of the front), the frames for ParaView (fields.pvd) and
/// summary.json. The columns are the same: z is along the axis, and what breaks the symmetry is zero.
template <int D = 3>
class SpreadingRecorder {
 public:
  /// `cutoff`: gap below which the surface counts as spread, m. With `resumed_at` (s) it goes on with the files of the run that is
  /// continued from there, and awaits its state. `more`: columns of the history that the study adds.
  SpreadingRecorder(std::filesystem::path folder, double cutoff, std::optional<double> resumed_at = {}, std::vector<std::string> more = {})
      : folder_(std::move(folder)),
        cutoff_(cutoff),
        columns_(with(columns(), more)),
        history_(folder_ / "history.csv", columns_, resumed_at),
        front_(folder_ / "front.csv", front_columns(), resumed_at),
        frames_(folder_, {"cell", "substrate"}, resumed_at) {}

  /// What the next line and the next frame need; the recorder must have measured once.
  template <class Archive>
  void state(Archive& archive) {
    archive("last", last_);
    frames_.state(archive);
    archive.part("gaps", gaps_);
  }

  static std::vector<std::string> columns() {
    return {"time",
            "dt",
            "spread_area",
            "contact_radius",
            "front_modulation",
            "nucleus_effective_stress_mean",
            "nucleus_effective_stress_max",
            "cell_effective_stress_max",
            "com_x",
            "com_y",
            "com_z",
            "contact_x",
            "contact_y",
            "kinetic_energy",
            "strain_energy",
            "adhesion_energy",
            "surface_energy",
            "dissipated_energy",
            "external_work",
            "energy_error",
            "momentum_x",
            "momentum_y",
            "momentum_z",
            "stabilization_energy",
            "gap_min",
            "front_plus_x",
            "front_minus_x"};
  }

  /// The front is r(θ) = radius (1 + Σ mode_m cos(m θ − phase_m)) around its center.
  static std::vector<std::string> front_columns() {
    std::vector<std::string> names = {"time", "center_x", "center_y", "radius"};
    for (int m = 1; m <= front_modes; ++m) names.push_back(fmt::format("mode_{}", m));
    for (int m = 1; m <= front_modes; ++m) names.push_back(fmt::format("phase_{}", m));
    return names;
  }

  /// One line of the histories; `more`: the values of the columns that the study adds.
  template <class S>
  void record(S& simulation, const std::vector<double>& more = {}) {
    if (!last_.empty() && last_.front() == simulation.time()) return;
    const Timer timer(seconds_);
    measure(simulation);
    const ParticleFields cell = simulation.template particles<0>();
    const StressFields stress = stress_fields(simulation.template body<0>());
    const PointTable& table = simulation.template body<0>().table();
    const RegionStatistics nucleus = region_statistics(table, stress.point_effective_stress, 0);
    double largest = 0.0;
    for (double s : stress.point_effective_stress) largest = std::max(largest, s);
    const ContactFront front = front_of(cell);
    const Motion a = motion<0>(simulation), b = motion<1>(simulation);
    const Vector3 momentum = in_space(a.momentum + b.momentum), center_of_mass = in_space(a.center_of_mass);
    const EnergyLedger& e = simulation.ledger();
    double smallest = std::numeric_limits<double>::infinity();
    for (double g : gaps_.gaps()) smallest = std::min(smallest, g);
    last_ = {simulation.time(),
             simulation.last_time_step(),
             front.area,
             front.radius,
             front.modulation,
             nucleus.mean,
             nucleus.max,
             largest,
             center_of_mass[0],
             center_of_mass[1],
             center_of_mass[2],
             front.centroid[0],
             D == 2 ? 0.0 : front.centroid[1],
             e.kinetic,
             e.strain + e.stabilization,
             e.adhesion,
             e.surface,
             e.dissipated,
             e.external_work,
             e.error(),
             momentum[0],
             momentum[1],
             momentum[2],
             e.stabilization,
             smallest,
             D == 2 ? front.radius : front_radius(front, Vector3::Zero(), Vector3::UnitX()),
             D == 2 ? front.radius : front_radius(front, Vector3::Zero(), -Vector3::UnitX())};
    last_ = with(std::move(last_), more);
    history_.write(last_);
    std::vector<double> shape = {simulation.time(), front.center[0], D == 2 ? 0.0 : front.center[1], front.radius};
    for (const auto* part : {&front.modes, &front.phases})
      for (std::size_t m = 1; m <= front_modes; ++m) shape.push_back(m < part->size() ? (*part)[m] : 0.0);
    front_.write(shape);
  }

  /// One frame: both bodies.
  template <class S>
  void write_frame(S& simulation) {
    const Timer timer(seconds_);
    measure(simulation);
    frames_.next();
    frames_.add(0, simulation.template body<0>(), simulation.template particles<0>(), simulation.time(), gaps_.gaps());
    frames_.add(1, simulation.template body<1>(), simulation.template particles<1>(), simulation.time());
  }

  /// The final values under the names of the history, what the run took (a continued one: since then, for `steps_taken`), and
  /// whether it came to its end.
  template <class S>
  void write_summary(S& simulation, double substrate_mass_scaling, std::size_t steps_taken, double wall_seconds, bool completed) const {
    Summary summary;
    for (std::size_t i = 0; i < columns_.size(); ++i) summary.set(columns_[i], last_[i]);
    summary.set("steps", simulation.steps());
    summary.set("wall_seconds", wall_seconds);
    summary.set("particles_cell", simulation.template body<0>().size());
    summary.set("particles_substrate", simulation.template body<1>().size());
    summary.set("pairs", simulation.pairs());
    if (substrate_mass_scaling > 1.0) summary.set("substrate_mass_scaling", substrate_mass_scaling);
    double visits = static_cast<double>(steps_taken) * static_cast<double>(simulation.pairs());
    if constexpr (requires { simulation.integrator().report.body_steps; })
      if (simulation.integrator().max_ratio > 1 && simulation.steps() > 0) {
        // Steps above are cycles; of a run that was continued, its share of all visits.
        const auto& report = simulation.integrator().report;
        summary.set("small_steps", report.steps);
        summary.set("steps_cell", report.body_steps[0]);
        summary.set("steps_substrate", report.body_steps[1]);
        visits = static_cast<double>(report.body_steps[0]) * static_cast<double>(simulation.template body<0>().table().pairs()) +
                 static_cast<double>(report.body_steps[1]) * static_cast<double>(simulation.template body<1>().table().pairs());
        visits *= static_cast<double>(steps_taken) / static_cast<double>(simulation.steps());
      }
    summary.set("ns_per_pair", visits > 0.0 ? 1e9 * (wall_seconds - seconds_) / visits : 0.0);
    if constexpr (requires { simulation.integrator().report(); }) {
      const auto& report = simulation.integrator().report();
      summary.set("newton_iterations", report.newton_iterations);
      summary.set("linear_iterations", report.linear_iterations);
      summary.set("factorizations", report.factorizations);
      summary.set("rejected_steps", report.rejected + report.failed);
    }
    if constexpr (requires { simulation.integrator().reference; }) {
      const auto& reference = simulation.integrator().reference;
      summary.set("reference_updates", reference.updates);
      summary.set("refused_updates", reference.refused);
      summary.set("lost_energy", reference.lost_energy);
      summary.set("largest_distortion", reference.largest_distortion);
    }
    summary.set("threads", thread_count());
    summary.set("version", version);
    summary.set("completed", completed);
    summary.write(folder_ / "summary.json");
  }

  /// Measures the gaps at the present state, as every record and frame does first.
  template <class S>
  void measure(S& simulation) {
    const ParticleFields cell = simulation.template particles<0>(), substrate = simulation.template particles<1>();
    if (gaps_.gaps().empty())
      gaps_.initialize(simulation.template body<0>().cloud(), cell, simulation.template body<1>().cloud(), substrate);
    else
      gaps_.measure(cell, substrate);
  }

 private:
  struct Timer {
    explicit Timer(double& sum) : sum_(sum) {}
    ~Timer() { sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;
    double& sum_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  };

  template <class T>
  [[nodiscard]] static std::vector<T> with(std::vector<T> list, const std::vector<T>& more) {
    list.insert(list.end(), more.begin(), more.end());
    return list;
  }
  [[nodiscard]] ContactFront front_of(const ParticleFields& cell) const {
    if constexpr (D == 2) return contact_front(gaps_.surface(), cell.position, gaps_.gaps(), cutoff_);
    else return contact_front(gaps_.surface(), cell.position, gaps_.gaps(), cutoff_, Vector3::UnitZ(), front_modes);
  }
  /// A mean vector over whole rings points along the axis, z.
  [[nodiscard]] static Vector3 in_space(const Vector3& v) { return D == 2 ? Vector3(0.0, 0.0, v[1]) : v; }

  static constexpr int front_modes = 16;
  std::filesystem::path folder_;
  double cutoff_;
  std::vector<std::string> columns_;  // of the history
  HistoryWriter history_, front_;
  FrameSeries frames_;
  SurfaceGaps<D> gaps_;
  std::vector<double> last_;
  double seconds_ = 0.0;  // spent in observing and writing
};

}  // namespace tactoid
