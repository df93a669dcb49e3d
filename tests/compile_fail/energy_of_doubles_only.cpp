// EXPECT: A Material has `T energy(const Tensor<T>& F) const`, generic over its scalar T
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/simulation.hpp>

using namespace tactoid;

struct Linear {
  double density = 1000.0;
  double wave_speed() const { return 1.0; }
  double energy(const Tensor<double>& F) const { return contract(F, F); }
};

int main() { Materials materials{Region{"body", Linear{}}}; }
