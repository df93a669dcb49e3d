// A viscous cell of revolution spreads on a substrate for minutes, by implicit steps. See README.md beside this file.
//
//   spreading_slow --out out/spreading_slow
//   spreading_slow --elasticity 1kPa --viscosity 100Pa.s --tethers off
#include <algorithm>
#include <limits>

#include "common/program.hpp"
#include "common/spreading_run.hpp"
#include "common/tethers.hpp"

namespace {

using namespace tactoid;

/// Implicit steps that end a run which crawls: before a point is inverted, or where Newton's method stumbles over the edges of facets,
/// steps get shorter and shorter.
struct ImpatientSteps : ImplicitDynamics {
  double least_share = 1e-3;  ///< of the longest step so far
  int allowed = 300;          ///< more steps that are shorter than steps that are not
  int shorter = 0;            ///< more steps that were shorter

  template <class System>
  void step(System& system, double until) {
    ImplicitDynamics::step(system, until);
    shorter = past.last_step < least_share * past.report.largest_step ? shorter + 1 : std::max(0, shorter - 1);
    if (shorter > allowed)
      throw ComputationError(fmt::format("The steps at t = {:.6g} s have fallen to {:.2g} s, from {:.2g} s: a point is about to be inverted, or "
                                         "surfaces touch in a way that Newton's method does not follow.", system.time(),
                                         past.last_step, past.report.largest_step));
  }
  template <class Archive>
  void state(Archive& archive) {
    ImplicitDynamics::state(archive);
    archive("shorter", shorter);
  }
};

/// The axisymmetric cell on its substrate with tethers, under an implicit integrator.
struct SlowCase : SpreadingCase<YangVisco<>, 2, Tethers> {
  UpdatedReference<ImpatientSteps> integrator;

  [[nodiscard]] auto simulation() const { return SpreadingCase::simulation(integrator); }
};

}  // namespace

int main(int argc, char** argv) {
  return run_program("spreading_slow", [&] {
    SpreadingParameters p{.contact_refinement = 2.0, .viscosity = 10.0, .activity = 0.0, .director = "radial", .preset = "elastic", .van_der_waals = 100.0, .bonds_on = "substrate", .contact_points = 4, .surface_smoothing = 0.05, .fluid_hourglass_viscosity = 1.0, .min_time_step = 0.0,
                          .end_time = 600.0};
    // Steps are as long as the shape allows: what they take out of fast motion shows in the balance of energy, and stops no run.
    SpreadingRun run{.out = "out/spreading_slow", .frames = 24, .samples = 240, .energy_limit = 1e9};
    double elasticity = 10e3, longest = 0.0, redistribution = 1.0;
    // Bonds are as long as the gap at which adhesion holds the surfaces.
    Tethers tethers{.length = 100e-9, .capture_distance = 150e-9, .rate_factor = 1.0};
    UpdatedReference<ImpatientSteps> integrator{{}, 1.5, 1};
    Options options("spreading_slow", "A viscous cell of revolution adheres to and spreads on a substrate for minutes, in its meridian section.");
    options.add_quantity("elasticity", &elasticity, Quantity::pressure, Range::positive(), "Young's modulus of the substrate");
    options.add("inertia", &integrator.inertia, "Keep inertia; without it all forces balance at every instant");
    options.add("tolerance", &integrator.tolerance, Range::inside(0.0, 1.0), "Local error of a step over the size of a body");
    options.add_quantity("max-time-step", &longest, Quantity::time, Range::non_negative(), "Longest step; 0: none");
    options.add("update-at", &integrator.distortion, Range::non_negative(), "Stretch of a point since the last update at which a body gets a new reference; 0: never");
    options.add("redistribute", &redistribution, Range::between(0.0, 1.0), "Share of the way to their first spacing that particles on the surface of the gel slide with each update, those inside follow; 0: particles are matter");
    tethers.add_to(options);
    p.add_to(options);
    run.add_to(options);
    if (!options.parse(argc, argv)) return 0;
    p.validate_axisymmetric();
    if (integrator.distortion == 0.0) integrator.distortion = std::numeric_limits<double>::infinity();
    if (redistribution > 0.0) integrator.redistribution = Redistribution{.share = redistribution};
    integrator.time_step = p.time_step;
    if (longest > 0.0) integrator.max_time_step = longest;
    integrator.min_time_step = p.min_time_step > 0.0 ? p.min_time_step : std::min(1e-12, 1e-6 * p.end_time);
    integrator.first_time_step = std::min(1e-8, 1e-3 * p.end_time);  // the defect of a radial director relaxes first
    integrator.newton_tolerance = 1e-2 * integrator.tolerance;
    // E = 3 × the shear modulus 2 (C₁ + C₂): λ is large.
    const double factor = elasticity / (6.0 * (p.substrate_c1 + p.substrate_c2));
    tethers.follow(p);
    run(SlowCase{{p, p.substrate_law(factor), tethers}, integrator}, options);
    return 0;
  });
}
