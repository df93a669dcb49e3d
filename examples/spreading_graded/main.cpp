// A cell spreads on a substrate that is stiffer on one side: does it go there? See README.md beside this file.
//
//   spreading_graded --out out/graded
//   spreading_graded --soft 2 --stiff 50 --preset elastic --activity=-1kPa
#include <cmath>
#include <numbers>

#include "common/program.hpp"
#include "common/spreading_run.hpp"

int main(int argc, char** argv) {
  using namespace tactoid;
  return run_program("spreading_graded", [&] {
    SpreadingParameters p;
    SpreadingRun run{.out = "out/spreading_graded"};
    double soft = 2.0, stiff = 10.0;
    Options options("spreading_graded",
                    "A cell spreads on a substrate whose stiffness grows with the angle, from the side +x to the side -x "
                    "(Zeng and Li, Soft Matter 2012, 8, 5765, Figs. 11 and 12).");
    options.add("soft", &soft, Range::positive(), "Factor on the constants of the base substrate on the side +x");
    options.add("stiff", &stiff, Range::positive(), "Factor on the constants of the base substrate on the side -x");
    p.add_to(options);
    run.add_to(options);
    if (!options.parse(argc, argv)) return 0;
    const GradedSubstrate substrate{[&](const Vector3& X) {
      const double angle = std::abs(std::atan2(X[1], X[0]));  // θ, 0 … π
      return p.substrate_law(soft + (stiff - soft) * angle / std::numbers::pi);
    }};
    run(SpreadingCase{p, substrate}, options);
    return 0;
  });
}
