// A cell spreads on a substrate that is stiffer on one side: does it go there? See README.md beside this file.
//
//   spreading_graded --out out/graded
//   spreading_graded --soft 2 --stiff 50 --preset elastic --activity=-1kPa
#include "common/program.hpp"
#include "common/spreading_run.hpp"

int main(int argc, char** argv) {
  using namespace tactoid;
  return run_program("spreading_graded", [&] {
    SpreadingParameters p;
    SpreadingRun run{.out = "out/spreading_graded"};
    StiffnessGradient gradient;
    Options options("spreading_graded",
                    "A cell spreads on a substrate whose stiffness grows with the angle, from the side +x to the side -x "
                    "(Zeng and Li, Soft Matter 2012, 8, 5765, Figs. 11 and 12).");
    gradient.add_to(options);
    p.add_to(options);
    run.add_to(options);
    if (!options.parse(argc, argv)) return 0;
    run(SpreadingCase{p, p.graded_substrate(gradient)}, options);
    return 0;
  });
}
