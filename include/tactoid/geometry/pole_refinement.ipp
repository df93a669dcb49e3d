#pragma once

#include <algorithm>
#include <cmath>

#include <tactoid/core/compiled.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/pole_refinement.hpp>
#include <tactoid/geometry/validate.hpp>

namespace tactoid {

TACTOID_INLINE void PoleRefinement::validate() const {
  if (!(factor >= 1.0)) reject("PoleRefinement.factor", factor, "", "at least 1");
  require_positive("PoleRefinement.angle", angle, "rad");
  if (!(factor * angle < 0.8 * std::numbers::pi)) reject("PoleRefinement.factor", factor, "", "such that factor * angle is below 0.8 pi");
}

// The rate is 1/factor up to factor × angle, and grows from there like t² (3 − 2t), to where π stays π.
TACTOID_INLINE double PoleRefinement::polar_angle(double before) const {
  const double end = factor * angle, rest = std::numbers::pi - end, low = 1.0 / factor;
  if (before <= end) return low * before;
  const double t = (before - end) / rest, high = 2.0 * (std::numbers::pi - angle) / rest - low;
  return angle + rest * (low * t + (high - low) * t * t * t * (1.0 - 0.5 * t));
}

template <int D>
  requires(D >= 2)
PointCloud<D> refine_pole(const PointCloud<D>& ball, const Point<D>& center, double radius, const PoleRefinement& refinement) {
  refinement.validate();
  require_positive("refine_pole.radius", radius, "m");
  if (refinement.factor == 1.0) return ball;
  PointCloud<D> refined = ball;
  for (Point<D>& X : refined.positions) {
    const Point<D> r = X - center;
    const double distance = r.norm(), beside = r.template head<D - 1>().norm();
    if (!(beside > 1e-12 * radius)) continue;  // on the axis
    const double polar = std::atan2(beside, -r[D - 1]), share = std::sqrt(std::min(distance / radius, 1.0));
    const double turned = polar + share * (refinement.polar_angle(polar) - polar);
    X.template head<D - 1>() = center.template head<D - 1>() + (distance * std::sin(turned) / beside) * r.template head<D - 1>();
    X[D - 1] = center[D - 1] - distance * std::cos(turned);
  }
  tactoid::validate(refined);
  return refined;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template PointCloud<2> refine_pole<2>(const PointCloud<2>&, const Point<2>&, double, const PoleRefinement&);
template PointCloud<3> refine_pole<3>(const PointCloud<3>&, const Point<3>&, double, const PoleRefinement&);
}  // namespace tactoid
#endif
