// Indentation of a soft bead: a rigid tip presses a viscoelastic ball against a plate. The program of the tutorial; see
// README.md beside this file.
//
//   indentation [FOLDER [PRESS_TIME [CORE_MODULUS]]]       such as: indentation out/slow 400us 1kPa
#include <array>
#include <filesystem>
#include <string>
#include <utility>

#include <tactoid/tactoid.hpp>

using namespace tactoid;

/// A neo-Hookean solid with a viscosity in parallel, σ = σ_elastic + 2η d: the simplest viscoelastic solid (Kelvin, Voigt).
struct KelvinVoigt {
  static constexpr bool uses_rate = true;                   ///< the law wants Ḟ
  NeoHookean elastic = NeoHookean::from_young(1_kPa, 0.4);  ///< E = 1 kPa
  double viscosity = 1e-3;                                  ///< η, Pa·s
  double density = elastic.density;                         ///< kg/m³

  void validate() const {
    elastic.validate();
    require_non_negative("KelvinVoigt.viscosity", viscosity, "Pa s");
  }
  [[nodiscard]] double wave_speed() const { return elastic.wave_speed(); }
  [[nodiscard]] double shear_modulus() const { return elastic.shear_modulus(); }
  [[nodiscard]] double viscosity_modulus() const { return 2.0 * viscosity; }

  template <class T>
  [[nodiscard]] Response<T> response(const PointState<T>& point, NoHistory<T>&) const {
    const Inversion<T> F = invert(point.deformation_gradient);
    const Tensor<T> d = rate_of_deformation(velocity_gradient(point.deformation_rate, F.inverse));
    Response<T> r;
    r.stress = elastic.first_piola(point.deformation_gradient) + d * F.cofactors * T(2.0 * viscosity);  // P = J σ F⁻ᵀ
    r.energy = elastic.energy(point.deformation_gradient);
    r.dissipated_power = F.determinant * T(2.0 * viscosity) * contract(d, d);
    return r;
  }
};

void indent(const std::filesystem::path& folder, double press_time, double core_modulus) {
  // The body: a ball of 10 µm on the plate z = 0, of a shell of 1 kPa and a core of its own modulus.
  const double radius = 5_um, depth = 1_um;
  PointCloud<3> cloud = ball({.radius = radius, .core_radius = 2_um, .core_cells = 6, .shells = 5,
                              .center = {0.0, 0.0, radius}, .core_region = "core", .shell_region = "shell"});
  Body bead{"bead", std::move(cloud), Rkpm<3>{}, NodalCentroids{},
            Materials{Region{"core", KelvinVoigt{.elastic = NeoHookean::from_young(core_modulus, 0.4)}},
                      Region{"shell", KelvinVoigt{}}}};

  // What acts on it: the plate below, and a rigid sphere that comes down from above at a constant speed.
  const RepulsiveWall wall{.penalty = 3e10};
  const RigidSphere tip{.center = {0.0, 0.0, 3.0 * radius}, .radius = radius, .velocity = {0.0, 0.0, -depth / press_time}};
  Simulation simulation{Bodies{std::move(bead)}, Contacts{},
                        Boundaries{on<0>(RigidPlate{.law = wall}), on<0>(OnRigid{.law = wall, .surface = tip, .points_per_direction = 4})},
                        CentralDifference{.safety = 0.5}};

  // What is kept of it.
  prepare_folder(folder / "fields");
  HistoryWriter history(folder / "history.csv", {"time", "depth", "force", "energy_error"});
  PvdSeries series(folder / "fields.pvd");
  int frame = 0;
  auto record = every(press_time / 200, [&](auto& s) {
    const double force = s.template boundary<1>().force().z();
    history.write(std::array{s.time(), depth * s.time() / press_time, force, s.ledger().error()});
  });
  auto draw = every(press_time / 20, [&](auto& s) {
    const std::string file = fmt::format("fields/bead_{:04}.vtu", frame++);
    auto& body = s.template body<0>();
    write_body_frame(folder / file, body, s.template particles<0>(), stress_fields(body), s.time());
    series.add(s.time(), file, "bead");
  });
  simulation.run(press_time, record, draw);

  const double force = simulation.boundary<1>().force().z();
  Summary{}.set("press_time", press_time).set("depth", depth).set("force", force).set("steps", simulation.steps())
      .set("energy_error", simulation.ledger().error()).write(folder / "summary.json");
  fmt::print("{}: {:.3f} nN at a depth of 1 um in {:.0f} us; {} steps, energy error {:.1e}\n", folder.string(), 1e9 * force,
             1e6 * press_time, simulation.steps(), simulation.ledger().error());
}

int main(int argc, char** argv) {
  try {
    const std::string folder = argc > 1 ? argv[1] : "out", press_time = argc > 2 ? argv[2] : "400us", core = argc > 3 ? argv[3] : "1kPa";
    indent(folder, parse_quantity(press_time, Quantity::time, "PRESS_TIME"), parse_quantity(core, Quantity::pressure, "CORE_MODULUS"));
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
