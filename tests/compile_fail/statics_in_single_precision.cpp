// EXPECT: Statics and implicit steps need a body whose gradients are stored as double.
#include <tactoid/geometry/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/body.hpp>
#include <tactoid/simulation/stiffness.hpp>

using namespace tactoid;

int main() {
  Body body{"bar", bar({.length = 1e-6, .cells = 10}), Rkpm<1>{}, stored_as<float>(NodalCentroids{}), Materials{Region{"body", NeoHookean{}}}};
  (void)assemble_stiffness(body);
}
