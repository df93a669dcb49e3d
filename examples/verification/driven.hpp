#pragma once

#include <cmath>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include <tactoid/boundary/prescribed_motion.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid::verification {

/// Every particle of a cloud.
template <int D>
[[nodiscard]] std::vector<Index> everything(const PointCloud<D>& cloud) {
  std::vector<Index> all(cloud.size());
  std::iota(all.begin(), all.end(), Index(0));
  return all;
}

/// The motion x = F(t) X of the particles, F a function of time.
[[nodiscard]] inline PrescribedMotion affine(std::vector<Index> particles, std::function<Tensor3(double time)> F) {
  return {std::move(particles), [F = std::move(F)](const Vector3& X, double t) { return Vector3(F(t) * X - X); }};
}

/// Observed order: from the errors at two sizes, `ratio` = coarse size / fine size.
[[nodiscard]] inline double order(double coarse, double fine, double ratio = 2.0) {
  return std::log(coarse / fine) / std::log(ratio);
}

/// Results of independent small cases, computed side by side: a case is run by one thread (loops inside it are not
/// split again), which is faster than splitting bodies of a hundred particles.
template <class Result, class Case>
[[nodiscard]] std::vector<Result> side_by_side(std::size_t cases, const Case& run) {
  std::vector<Result> results(cases);
  parallel_for(cases, [&](std::size_t i) { results[i] = run(i); });
  return results;
}

}  // namespace tactoid::verification
