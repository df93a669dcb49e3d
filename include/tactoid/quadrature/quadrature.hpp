#pragma once

#include <concepts>

#include <tactoid/core/unsatisfied.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/kernel/kernel.hpp>
#include <tactoid/quadrature/point_table.hpp>

namespace tactoid {

/// Stabilisation of a body with respect to the modes that its quadrature points do not see.
struct Stabilization {
  double modulus = 0.0;       ///< Pa
  double damping_time = 0.0;  ///< s; the stabilising force has the part modulus × damping time × rate
};

/// A rule of integration: where the weak form is sampled, with which gradients, and how it is kept stable.
///
/// `build` is called once, when a body is composed. It returns a complete table (points sorted by region, rows
/// sorted by particle, chunks coloured), or throws GeometryError naming the point, the number of
/// its neighbours and the condition number of the moment matrix.
/// `stabilization(shear_modulus)` gives the stabilisation of a region from the shear modulus of its law (0: fluid).
template <class Q, class K>
concept Quadrature =
    Kernel<K> &&
    (requires(const Q& q, const PointCloud<K::dimension>& cloud, const K& kernel) {
      { q.build(cloud, kernel) } -> std::same_as<PointTable>;
    } || unsatisfied<"A Quadrature has `PointTable build(const PointCloud<D>& cloud, const Kernel& kernel) const`.">) &&
    (requires(const Q& q) {
      { q.stabilization(1.0) } -> std::same_as<Stabilization>;
    } || unsatisfied<"A Quadrature has `Stabilization stabilization(double shear_modulus) const`.">);

}  // namespace tactoid
