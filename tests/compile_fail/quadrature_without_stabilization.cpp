// EXPECT: A Quadrature has `Stabilization stabilization(double shear_modulus) const`.
#include <tactoid/geometry/all.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/simulation.hpp>

using namespace tactoid;

struct Rule {
  template <Kernel K>
  PointTable build(const PointCloud<K::dimension>&, const K&) const {
    return {};
  }
};

int main() {
  Body body{"bar", bar({.length = 1e-6, .cells = 10}), Rkpm<1>{}, Rule{}, Materials{Region{"body", NeoHookean{}}}};
}
