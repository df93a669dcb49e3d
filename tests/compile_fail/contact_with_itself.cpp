// EXPECT: A contact is between two different bodies.
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/simulation.hpp>

using namespace tactoid;

struct None {};

int main() { (void)between<0, 0>(None{}); }
