#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/gaps.hpp>

namespace tactoid {

template <int D>
void SurfaceGaps<D>::initialize(const PointCloud<D>& cloud_a, const ParticleFields& a, const PointCloud<D>& cloud_b,
                                const ParticleFields& b) {
  surface_ = FacetSurface<D>(cloud_a);
  master_ = FacetSurface<D>(cloud_b);
  gaps_.assign(cloud_a.size(), std::numeric_limits<double>::infinity());
  normals_.assign(cloud_a.size(), Vector4::Zero());
  points_.resize(surface_.nodes.size());
  tracker_ = {};
  measure(a, b);
}

template <int D>
std::span<const double> SurfaceGaps<D>::measure(const ParticleFields& a, const ParticleFields& b) {
  for (std::size_t k = 0; k < points_.size(); ++k) points_[k] = a.position[surface_.nodes[k]];
  tracker_.update(master_, points_, b.position);
  const auto closest = tracker_.closest();
  for (std::size_t k = 0; k < points_.size(); ++k) {
    gaps_[surface_.nodes[k]] = closest[k].gap;
    normals_[surface_.nodes[k]] = pad(closest[k].normal);
  }
  return gaps_;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template class SurfaceGaps<2>;
template class SurfaceGaps<3>;
}  // namespace tactoid
#endif
