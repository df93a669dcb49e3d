#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/geometry/o_grid.hpp>

namespace tactoid::detail {

template <int D>
Point<D> equiangular_direction(const Point<D>& d) {
  Point<D> t;
  for (int k = 0; k < D; ++k) t[k] = std::tan(0.25 * std::numbers::pi * d[k]);
  return t.normalized();
}

}  // namespace tactoid::detail

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template Point<1> equiangular_direction<1>(const Point<1>& d);
template Point<2> equiangular_direction<2>(const Point<2>& d);
template Point<3> equiangular_direction<3>(const Point<3>& d);
}  // namespace tactoid::detail
#endif
