// EXPECT: A BoundaryTerm has `TermEnergy apply(const ParticleFields& body, double time)`.
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/simulation.hpp>

using namespace tactoid;

struct Load {
  void initialize(const PointCloud<1>&, const ParticleFields&) {}
  double stiffness_rate(const ParticleFields&) const { return 0.0; }
};

int main() {
  Body body{"bar", bar({.length = 1e-6, .cells = 10}), Rkpm<1>{}, NodalCentroids{}, Materials{Region{"body", NeoHookean{}}}};
  Simulation simulation{Bodies{body}, Contacts{}, Boundaries{on<0>(Load{})}, CentralDifference{}};
}
