// EXPECT: All bodies of a Simulation have the same dimension.
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/simulation.hpp>

using namespace tactoid;

int main() {
  Body thin{"bar", bar({.length = 1e-6, .cells = 10}), Rkpm<1>{}, NodalCentroids{}, Materials{Region{"body", NeoHookean{}}}};
  Body flat{"sheet", rectangle({.size = {1e-6, 1e-6}, .cells = {4, 4}}), Rkpm<2>{}, NodalCentroids{},
            Materials{Region{"body", NeoHookean{}}}};
  Simulation simulation{Bodies{thin, flat}, Contacts{}, Boundaries{}, CentralDifference{}};
}
