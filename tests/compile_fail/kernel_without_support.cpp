// EXPECT: A Kernel has a parameter `double support` (support radius per local particle spacing) and
#include <tactoid/geometry/all.hpp>
#include <tactoid/kernel/windows.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/body.hpp>

using namespace tactoid;

struct Constant {
  static constexpr int dimension = 1, order = 1, basis_size = 2;
  using Window = CubicBSpline;
  void validate() const {}
  void shape_functions(std::span<const KernelNeighbor<1>>, ShapeFunctions<1>&) const {}
  double direct_gradient(std::span<const KernelNeighbor<1>>, std::vector<Point<1>>&) const { return 1.0; }
};

int main() {
  Body body{"bar", bar({.length = 1e-6, .cells = 10}), Constant{}, NodalCentroids{}, Materials{Region{"body", NeoHookean{}}}};
}
