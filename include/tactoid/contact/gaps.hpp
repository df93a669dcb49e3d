#pragma once

#include <limits>
#include <span>
#include <vector>

#include <tactoid/contact/surface.hpp>
#include <tactoid/contact/tracking.hpp>
#include <tactoid/geometry/particle_fields.hpp>

namespace tactoid {

/// Measures the gap between the surface particles of body A and the deformed surface of body B, for observers
/// (spreading area, pictures) and anchoring. It forces nothing, and keeps its own tracked closest points.
template <int D>
class SurfaceGaps {
 public:
  /// Builds both surfaces and measures once. Throws GeometryError for a cloud without facets or with periodic
  /// directions.
  void initialize(const PointCloud<D>& cloud_a, const ParticleFields& a, const PointCloud<D>& cloud_b,
                  const ParticleFields& b);

  /// Brings gaps and normals to the present positions. Call it as often as they are needed, at best in regular
  /// intervals.
  std::span<const double> measure(const ParticleFields& a, const ParticleFields& b);

  /// Signed gap per particle of A, m; infinity for particles that are not on the surface.
  [[nodiscard]] std::span<const double> gaps() const { return gaps_; }
  /// Unit normal out of B at the closest point, per particle of A; zero for particles that are not on the surface.
  [[nodiscard]] std::span<const Vector4> normals() const { return normals_; }
  /// Closest points of the surface particles, in the order of `surface().nodes`.
  [[nodiscard]] std::span<const ClosestPoint<D>> closest() const { return tracker_.closest(); }
  [[nodiscard]] const FacetSurface<D>& surface() const { return surface_; }  ///< of body A
  [[nodiscard]] const FacetSurface<D>& master() const { return master_; }    ///< of body B

  /// For checkpoints: gaps, normals and the closest points that are followed.
  template <class Archive>
  void state(Archive& archive) {
    archive.part("tracker", tracker_);
    state_at(archive, "gaps", gaps_, surface_.nodes);
    state_at(archive, "normals", normals_, surface_.nodes);
  }

 private:
  FacetSurface<D> surface_, master_;
  ClosestPointTracker<D> tracker_;
  Field points_;
  std::vector<double> gaps_;
  Field normals_;
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/gaps.ipp>
#endif
