// EXPECT: A Window has `static double slope(double q)`
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/simulation.hpp>

using namespace tactoid;

struct Hat {
  static double value(double q) { return q < 1.0 ? 1.0 - q : 0.0; }
};

int main() { Rkpm<1, 1, Hat> kernel; }
