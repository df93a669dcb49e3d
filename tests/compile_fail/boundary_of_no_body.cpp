// EXPECT: A boundary term names a body that does not exist.
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/simulation.hpp>

using namespace tactoid;

int main() {
  Body body{"bar", bar({.length = 1e-6, .cells = 10}), Rkpm<1>{}, NodalCentroids{}, Materials{Region{"body", NeoHookean{}}}};
  Simulation simulation{Bodies{body}, Contacts{}, Boundaries{on<1>(fixed({0}))}, CentralDifference{}};
}
