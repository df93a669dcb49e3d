// EXPECT: An Observer has `double next_time(const Simulation&)`
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/simulation.hpp>

using namespace tactoid;

struct Silent {
  template <class S>
  void begin(S&) {}
  template <class S>
  void after_step(S&) {}
  template <class S>
  void end(S&) {}
  template <class S>
  void last_good_state(S&) {}
};

int main() {
  Body body{"bar", bar({.length = 1e-6, .cells = 10}), Rkpm<1>{}, NodalCentroids{}, Materials{Region{"body", NeoHookean{}}}};
  Simulation simulation{Bodies{body}, Contacts{}, Boundaries{}, CentralDifference{}};
  simulation.run(1e-6, Silent{});
}
