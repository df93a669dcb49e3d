// A cell of revolution spreads on a uniform substrate, computed in its meridian section. See README.md beside this file.
//
//   spreading_axisymmetric --out out/spreading_axisymmetric
//   spreading_axisymmetric --resolution 4 --preset elastic --stiffness 2
#include "common/program.hpp"
#include "common/spreading_run.hpp"

int main(int argc, char** argv) {
  using namespace tactoid;
  return run_program("spreading_axisymmetric", [&] {
    SpreadingParameters p{.activity = 0.0, .director = "radial"};
    SpreadingRun run{.out = "out/spreading_axisymmetric"};
    double stiffness = 10.0;
    Options options("spreading_axisymmetric",
                    "A cell of revolution adheres to and spreads on a uniform substrate, in its meridian section "
                    "(Zeng and Li, Soft Matter 2012, 8, 5765, Fig. 10).");
    options.add("stiffness", &stiffness, Range::positive(),
                "Factor on the constants of the base substrate; 2, 5 and 10 are substrates I, II and III");
    p.add_to(options);
    run.add_to(options);
    if (!options.parse(argc, argv)) return 0;
    run(axisymmetric_case(p, p.substrate_law(stiffness)), options);
    return 0;
  });
}
