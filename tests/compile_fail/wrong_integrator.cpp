// EXPECT: An Integrator has `void step(System&, double until)`: one step, not beyond `until`.
#include <tactoid/geometry/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/simulation.hpp>

using namespace tactoid;

struct Euler {
  template <class System>
  void initialize(System&) {}
  template <class System>
  void step(System&) {}
};

int main() {
  Body body{"bar", bar({.length = 1e-6, .cells = 10}), Rkpm<1>{}, NodalCentroids{}, Materials{Region{"body", NeoHookean{}}}};
  Simulation simulation{Bodies{body}, Contacts{}, Boundaries{}, Euler{}};
}
