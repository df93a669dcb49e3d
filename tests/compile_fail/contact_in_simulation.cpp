// EXPECT: A Contact has `double stiffness_rate(
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/simulation.hpp>

using namespace tactoid;

struct Sticky {
  void initialize(const PointCloud<1>&, const ParticleFields&, const PointCloud<1>&, const ParticleFields&) {}
  TermEnergy apply(const ParticleFields&, const ParticleFields&, double) { return {}; }
};

int main() {
  Body body{"bar", bar({.length = 1e-6, .cells = 10}), Rkpm<1>{}, NodalCentroids{}, Materials{Region{"body", NeoHookean{}}}};
  Simulation simulation{Bodies{body, body}, Contacts{between<0, 1>(Sticky{})}, Boundaries{}, CentralDifference{}};
}
