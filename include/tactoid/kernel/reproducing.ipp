#pragma once

#include <tactoid/kernel/reproducing.hpp>

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template class Reproducing<2, 1, CubicBSpline, true>;
template class Reproducing<2, 1, CubicBSpline, false>;
template class Reproducing<3, 1, CubicBSpline, true>;
template class Reproducing<3, 1, CubicBSpline, false>;
}  // namespace tactoid::detail
#endif
