// A contractile cell on a graded substrate, with bonds that hold in the tangential direction: does it go to the stiff side? See
// README.md beside this file.
//
//   durotaxis --activity=-1kPa --out out/durotaxis
//   durotaxis --activity=-5kPa --director uniform --tethers stochastic --soft 2 --stiff 50
#include "common/program.hpp"
#include "common/spreading_run.hpp"
#include "common/tethers.hpp"

int main(int argc, char** argv) {
  using namespace tactoid;
  return run_program("durotaxis", [&] {
    SpreadingParameters p{.activity = -1000.0, .preset = "elastic"};
    SpreadingRun run{.out = "out/durotaxis"};
    Tethers tethers;
    StiffnessGradient gradient;
    Options options("durotaxis",
                    "A contractile cell on a substrate whose stiffness grows with the angle, from the side +x to the side -x, held by bonds "
                    "between material points.");
    gradient.add_to(options);
    tethers.add_to(options);
    p.add_to(options);
    run.add_to(options);
    if (!options.parse(argc, argv)) return 0;
    tethers.follow(p);
    run(SpreadingCase{p, p.graded_substrate(gradient), tethers}, options);
    return 0;
  });
}
