#include <tactoid/tactoid.hpp>

double mass_of_a_body() {
  using namespace tactoid;
  const Body body{"box", box({.size = {2_um, 1_um, 1_um}, .cells = {4, 2, 2}}), Rkpm<3>{}, NodalCentroids{}, Materials{Region{"body", NeoHookean{}}}};
  double mass = 0.0;
  for (const double m : body.masses()) mass += m;
  return mass;
}
