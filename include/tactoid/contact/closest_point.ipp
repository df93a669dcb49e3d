#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/closest_point.hpp>

namespace tactoid::detail {

TACTOID_INLINE SegmentProjection project_on_segment(Index ia, Index ib, std::span<const Vector4> x, const Vector3& q) {
  const bool swapped = ib < ia;
  const Vector3 a = x[swapped ? ib : ia].head<3>(), b = x[swapped ? ia : ib].head<3>();
  const Vector3 edge = b - a;
  const double length2 = edge.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp((q - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
  const Vector3 p = s == 1.0 ? b : Vector3(a + s * edge);
  return {p, (q - p).squaredNorm(), swapped ? 1.0 - s : s};
}

TACTOID_INLINE void descend(const Bilinear& facet, const Vector3& q, double& s, double& t, double& distance2) {
  double damping = 0.0;
  for (int iteration = 0; iteration < 100; ++iteration) {
    const Vector3 r = q - facet.at(s, t), a1 = facet.b1 + t * facet.b12, a2 = facet.b2 + s * facet.b12;
    double g1 = r.dot(a1), g2 = r.dot(a2);
    const bool free1 = !((s <= 0.0 && g1 < 0.0) || (s >= 1.0 && g1 > 0.0));
    const bool free2 = !((t <= 0.0 && g2 < 0.0) || (t >= 1.0 && g2 > 0.0));
    g1 = free1 ? g1 : 0.0;
    g2 = free2 ? g2 : 0.0;
    const double scale = a1.squaredNorm() + a2.squaredNorm();
    const double h11 = a1.squaredNorm() + damping * scale, h22 = a2.squaredNorm() + damping * scale;
    const double h12 = free1 && free2 ? a1.dot(a2) - r.dot(facet.b12) : 0.0;
    const double det = h11 * h22 - h12 * h12;
    if (det > 1e-3 * h11 * h22) {
      const double s_new = std::clamp(s + (h22 * g1 - h12 * g2) / det, 0.0, 1.0);
      const double t_new = std::clamp(t + (h11 * g2 - h12 * g1) / det, 0.0, 1.0);
      const double d2 = (q - facet.at(s_new, t_new)).squaredNorm();
      if (d2 <= distance2) {
        const double moved = std::max(std::abs(s_new - s), std::abs(t_new - t));
        s = s_new;
        t = t_new;
        distance2 = d2;
        damping *= 0.1;
        if (moved < 1e-15) return;
        continue;
      }
    }
    damping = std::max(10.0 * damping, 1e-3);
    if (damping > 1e12) return;
  }
}

}  // namespace tactoid::detail

namespace tactoid {

template <int D>
FacetProjection<D> project_on_facet(const FacetSurface<D>& surface, Index f, std::span<const Vector4> x,
                                    const Vector3& q) {
  const auto& c = surface.facets[f];
  FacetProjection<D> result;
  if constexpr (D == 2) {
    const auto p = detail::project_on_segment(c[0], c[1], x, q);
    result.local = {p.parameter};
    result.point = p.point;
    result.squared_distance = p.squared_distance;
    result.corner = p.parameter <= 0.0 ? 0 : (p.parameter >= 1.0 ? 1 : -1);
    return result;
  } else {
    const Vector3 x0 = x[c[0]].template head<3>(), x1 = x[c[1]].template head<3>(), x2 = x[c[2]].template head<3>(),
                  x3 = x[c[3]].template head<3>();
    const detail::Bilinear facet{x0, x1 - x0, x2 - x0, (x3 - x2) - (x1 - x0)};
    double s = 0.5, t = 0.5;
    bool converged = false, convex = true;
    for (int iteration = 0; iteration < 20; ++iteration) {
      const Vector3 r = q - facet.at(s, t), a1 = facet.b1 + t * facet.b12, a2 = facet.b2 + s * facet.b12;
      const double a11 = a1.squaredNorm(), a22 = a2.squaredNorm(), twist = r.dot(facet.b12);
      const double h12 = a1.dot(a2) - twist, det = a11 * a22 - h12 * h12;
      convex = convex && 4.0 * twist * twist < a11 * a22 && det > 1e-6 * a11 * a22;
      if (!(det > 1e-6 * a11 * a22)) break;
      const double g1 = r.dot(a1), g2 = r.dot(a2);
      const double ds = (a22 * g1 - h12 * g2) / det, dt = (a11 * g2 - h12 * g1) / det;
      s += ds;
      t += dt;
      if (std::max(std::abs(ds), std::abs(dt)) < 1e-6) {  // the next step would be about its square
        converged = true;
        break;
      }
      if (std::max(std::abs(s - 0.5), std::abs(t - 0.5)) > 1.5) break;
    }
    const bool inside = converged && s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0;
    if (inside) {
      result.local = {s, t};
      result.point = facet.at(s, t);
      result.squared_distance = (q - result.point).squaredNorm();
      if (convex) return result;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const auto [a, b] = surface.side_corners(k);
      const auto p = detail::project_on_segment(c[a], c[b], x, q);
      if (!(p.squared_distance < result.squared_distance)) continue;
      const double u = p.parameter;
      result.local = k == 0   ? std::array{u, 0.0}
                     : k == 1 ? std::array{u, 1.0}
                     : k == 2 ? std::array{0.0, u}
                              : std::array{1.0, u};
      result.point = p.point;
      result.squared_distance = p.squared_distance;
      result.corner = u <= 0.0 ? static_cast<int>(a) : (u >= 1.0 ? static_cast<int>(b) : -1);
      result.side = result.corner < 0 ? static_cast<int>(k) : -1;
    }
    if (converged && convex) return result;
    // Not convex: look for a lower minimum inside, from nine starts.
    for (const double s0 : {0.1, 0.5, 0.9})
      for (const double t0 : {0.1, 0.5, 0.9}) {
        double si = s0, ti = t0, d2 = (q - facet.at(s0, t0)).squaredNorm();
        detail::descend(facet, q, si, ti, d2);
        const bool strictly_inside = si > 0.0 && si < 1.0 && ti > 0.0 && ti < 1.0;
        if (!strictly_inside || !(d2 < result.squared_distance * (1.0 - 1e-12))) continue;
        result.local = {si, ti};
        result.point = facet.at(si, ti);
        result.squared_distance = d2;
        result.side = result.corner = -1;
      }
    return result;
  }
}

template <int D>
Vector3 pseudo_normal(const FacetSurface<D>& surface, Index f, const FacetProjection<D>& p,
                      std::span<const Vector4> x) {
  if (p.interior()) return surface.normal(f, p.local, x);
  Vector3 sum = Vector3::Zero();
  const auto add_facets_at_corner = [&](Index node) {
    for (const Index g : surface.facets_of(node)) {
      const auto& corners = surface.facets[g];
      const std::size_t a = static_cast<std::size_t>(std::find(corners.begin(), corners.end(), node) - corners.begin());
      const auto local = FacetSurface<D>::make_local(double(a & 1u), double(a >> 1u));
      double angle = 1.0;
      if constexpr (D == 3) {
        // Edges of the facet leave this corner along ±∂x/∂s and ±∂x/∂t, with equal signs at corners 0 and 3.
        const FacetTangents tangents = surface.tangents(g, local, x);
        const double cosine = tangents.s.dot(tangents.t) * ((a == 0 || a == 3) ? 1.0 : -1.0);
        angle = std::atan2(tangents.area_vector().norm(), cosine);
      }
      sum += angle * surface.normal(g, local, x);
    }
  };
  if (p.corner >= 0) {
    add_facets_at_corner(surface.facets[f][static_cast<std::size_t>(p.corner)]);
  } else if constexpr (D == 3) {
    const auto [a, b] = surface.side_corners(static_cast<std::size_t>(p.side));
    const Index na = surface.facets[f][a], nb = surface.facets[f][b];
    for (const Index g : surface.facets_of(na)) {
      const auto& corners = surface.facets[g];
      const auto ia = std::find(corners.begin(), corners.end(), na) - corners.begin();
      const auto found = std::find(corners.begin(), corners.end(), nb);
      if (found == corners.end()) continue;
      const auto ib = found - corners.begin();
      const double along = (p.side < 2) ? p.local[0] : p.local[1];
      const auto local = FacetSurface<D>::make_local((1.0 - along) * double(ia & 1) + along * double(ib & 1),
                                                     (1.0 - along) * double(ia >> 1) + along * double(ib >> 1));
      sum += surface.normal(g, local, x);
    }
  }
  return sum.normalized();
}

template <int D>
ClosestPoint<D> complete(const FacetSurface<D>& surface, Index f, const FacetProjection<D>& p,
                         std::span<const Vector4> x, const Vector3& q) {
  ClosestPoint<D> closest;
  closest.facet = f;
  closest.local = p.local;
  closest.point = p.point;
  closest.on_rim = !p.interior();
  const Vector3 outward = pseudo_normal(surface, f, p, x);
  const Vector3 offset = q - p.point;
  if (p.interior()) {
    closest.normal = outward;
    closest.gap = offset.dot(outward);
    return closest;
  }
  const double distance = std::sqrt(p.squared_distance);
  const double sign = offset.dot(outward) < 0.0 ? -1.0 : 1.0;
  closest.gap = sign * distance;
  const double length = (x[surface.facets[f][0]] - x[surface.facets[f][1]]).norm();
  closest.normal = distance > 1e-10 * length ? Vector3(offset * (sign / distance)) : outward;
  return closest;
}

}  // namespace tactoid

#if defined(TACTOID_COMPILED)
namespace tactoid {
template FacetProjection<2> project_on_facet<2>(const FacetSurface<2>& surface, Index f, std::span<const Vector4> x,
                                                const Vector3& q);
template FacetProjection<3> project_on_facet<3>(const FacetSurface<3>& surface, Index f, std::span<const Vector4> x,
                                                const Vector3& q);
template Vector3 pseudo_normal<2>(const FacetSurface<2>& surface, Index f, const FacetProjection<2>& p,
                                  std::span<const Vector4> x);
template Vector3 pseudo_normal<3>(const FacetSurface<3>& surface, Index f, const FacetProjection<3>& p,
                                  std::span<const Vector4> x);
template ClosestPoint<2> complete<2>(const FacetSurface<2>& surface, Index f, const FacetProjection<2>& p,
                                     std::span<const Vector4> x, const Vector3& q);
template ClosestPoint<3> complete<3>(const FacetSurface<3>& surface, Index f, const FacetProjection<3>& p,
                                     std::span<const Vector4> x, const Vector3& q);
}  // namespace tactoid
#endif
