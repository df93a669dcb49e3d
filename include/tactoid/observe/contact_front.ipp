#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/observe/contact_front.hpp>

namespace tactoid {

TACTOID_INLINE std::vector<double> outer_front(const std::vector<std::array<Point<2>, 2>>& contour,
                                               const Point<2>& center, std::size_t rays) {
  const double sector = 2.0 * std::numbers::pi / static_cast<double>(rays);
  std::vector<double> r(rays, 0.0);
  bool crossed = false;
  for (const auto& segment : contour) {
    const Point<2> a = segment[0] - center, d = segment[1] - segment[0];
    const double cross = a[0] * d[1] - a[1] * d[0];
    const double from = std::atan2(a[1], a[0]);
    // The segment turns by less than π around the center, in the sense of the sign of `cross`.
    const double turn = std::atan2(cross, a.squaredNorm() + a.dot(d));
    const auto first = static_cast<long>(std::ceil(std::min(from, from + turn) / sector));
    const auto last = static_cast<long>(std::floor(std::max(from, from + turn) / sector));
    for (long k = first; k <= last; ++k) {
      const double angle = sector * static_cast<double>(k);
      const double divisor = std::cos(angle) * d[1] - std::sin(angle) * d[0];
      // No crossing lies beyond the segment's ends, whatever the round-off of a segment along the ray.
      const double end = std::max(a.norm(), (a + d).norm());
      const double distance = divisor == 0.0 ? end : std::min(cross / divisor, end);
      double& ray = r[static_cast<std::size_t>((k % static_cast<long>(rays) + static_cast<long>(rays)) %
                                               static_cast<long>(rays))];
      ray = std::max(ray, distance);
      crossed = true;
    }
  }
  if (!crossed) return {};
  std::vector<double> filled = r;
  for (std::size_t k = 0; k < rays; ++k) {
    if (r[k] > 0.0) continue;
    std::size_t before = 1, after = 1;
    while (before < rays && r[(k + rays - before) % rays] == 0.0) ++before;
    while (after < rays && r[(k + after) % rays] == 0.0) ++after;
    const double w = static_cast<double>(before) / static_cast<double>(before + after);
    filled[k] = (1.0 - w) * r[(k + rays - before) % rays] + w * r[(k + after) % rays];
  }
  return filled;
}

TACTOID_INLINE Point<2> front_centroid(const std::vector<double>& r, const Point<2>& center) {
  const double sector = 2.0 * std::numbers::pi / static_cast<double>(r.size());
  double area = 0.0;
  Point<2> moment = Point<2>::Zero();
  for (std::size_t k = 0; k < r.size(); ++k) {
    const double angle = sector * static_cast<double>(k), next = r[(k + 1) % r.size()];
    const Point<2> a(r[k] * std::cos(angle), r[k] * std::sin(angle));
    const Point<2> b(next * std::cos(angle + sector), next * std::sin(angle + sector));
    const double twice = a[0] * b[1] - a[1] * b[0];
    area += twice;
    moment += twice / 3.0 * (a + b);
  }
  return area > 0.0 ? Point<2>(center + moment / area) : center;
}

TACTOID_INLINE ContactFront contact_front(const FacetSurface<3>& surface, std::span<const Vector4> position,
                                          std::span<const double> gaps, double cutoff, const Vector3& up, int modes) {
  struct Corner {
    Vector3 x;
    double g;  // gap − cutoff
  };
  ContactFront front;
  std::vector<std::array<Vector3, 2>> contour;
  auto add_triangle = [&](const Corner& a, const Corner& b, const Corner& c) {
    // Keeps the part with g < 0: corners in order, with the crossings between them.
    std::array<Vector3, 4> polygon;
    std::array<Vector3, 2> crossing;
    std::size_t n = 0, crossings = 0;
    const std::array<const Corner*, 3> corner = {&a, &b, &c};
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner &p = *corner[k], &q = *corner[(k + 1) % 3];
      if (p.g < 0.0) polygon[n++] = p.x;
      if ((p.g < 0.0) != (q.g < 0.0)) {
        const Vector3 x = p.x + (p.g / (p.g - q.g)) * (q.x - p.x);
        polygon[n++] = x;
        crossing[crossings++] = x;
      }
    }
    for (std::size_t k = 2; k < n; ++k) {
      const double area = -0.5 * up.dot((polygon[k - 1] - polygon[0]).cross(polygon[k] - polygon[0]));
      front.area += area;
      front.centroid += area / 3.0 * (polygon[0] + polygon[k - 1] + polygon[k]);
    }
    if (crossings == 2) contour.push_back(crossing);
  };
  for (const auto& facet : surface.facets) {
    std::array<Corner, 4> c;
    Corner middle{Vector3::Zero(), 0.0};
    constexpr std::array<std::size_t, 4> around = {0, 1, 3, 2};  // tensor order to a loop
    for (std::size_t k = 0; k < 4; ++k) {
      const Index i = facet[around[k]];
      c[k] = {position[i].head<3>(), gaps[i] - cutoff};
      middle.x += 0.25 * c[k].x;
      middle.g += 0.25 * c[k].g;
    }
    for (std::size_t k = 0; k < 4; ++k) add_triangle(middle, c[k], c[(k + 1) % 4]);
  }
  front.modes.assign(static_cast<std::size_t>(modes) + 1, 0.0);
  front.phases = front.modes;
  if (!(front.area > 0.0)) {
    front.area = 0.0;
    front.centroid.setZero();
    return front;
  }
  front.centroid /= front.area;
  // In the plane of the substrate.
  const Vector3 e1 = detail::in_plane_axis(up), e2 = up.cross(e1);
  const auto project = [&](const Vector3& x) { return Point<2>(x.dot(e1), x.dot(e2)); };
  std::vector<std::array<Point<2>, 2>> plane;
  for (const auto& segment : contour) plane.push_back({project(segment[0]), project(segment[1])});
  const std::size_t rays = 16 * static_cast<std::size_t>(modes) + 8;
  const Point<2> start = project(front.centroid);
  Point<2> center = start;
  std::vector<double> r = outer_front(plane, center, rays);
  front.center = front.centroid;
  if (r.empty()) return front;
  for (int pass = 0; pass < 4; ++pass) {
    center = front_centroid(r, center);
    r = outer_front(plane, center, rays);
    if (r.empty()) return front;
  }
  front.center += (center[0] - start[0]) * e1 + (center[1] - start[1]) * e2;
  for (std::size_t k = 0; k < rays; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(rays);
    front.outline.push_back(front.center + r[k] * (std::cos(angle) * e1 + std::sin(angle) * e2));
  }
  const auto coefficients = [&](std::size_t m) {  // of cos m θ and sin m θ
    Point<2> c = Point<2>::Zero();
    for (std::size_t k = 0; k < rays; ++k) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(m * k % rays) / static_cast<double>(rays);
      c += 2.0 / static_cast<double>(rays) * r[k] * Point<2>(std::cos(angle), std::sin(angle));
    }
    return c;
  };
  front.radius = 0.5 * coefficients(0)[0];
  if (!(front.radius > 0.0)) return front;
  front.modes[0] = 1.0;
  double sum = 0.0;
  for (std::size_t m = 1; m < front.modes.size(); ++m) {
    const Point<2> c = coefficients(m) / front.radius;
    front.modes[m] = c.norm();
    front.phases[m] = std::atan2(c[1], c[0]);
    if (m >= 2) sum += 0.5 * c.squaredNorm();
  }
  front.modulation = std::sqrt(sum);
  return front;
}

TACTOID_INLINE ContactFront contact_front(const FacetSurface<2>& surface, std::span<const Vector4> position,
                                          std::span<const double> gaps, double cutoff) {
  if (!surface.axisymmetric) throw ParameterError("contact_front: the surface in two dimensions must be that of an axisymmetric cloud.");
  ContactFront front;
  front.modes = {1.0};
  front.phases = {0.0};
  double height = 0.0;
  for (const auto& [a, b] : surface.facets) {
    const double ga = gaps[a] - cutoff, gb = gaps[b] - cutoff;
    if (ga >= 0.0 && gb >= 0.0) continue;
    const bool crosses = (ga < 0.0) != (gb < 0.0);
    const double cut = crosses ? ga / (ga - gb) : 0.0;
    const double crossing = (1.0 - cut) * position[a][0] + cut * position[b][0];
    const double from = ga < 0.0 ? position[a][0] : crossing, to = gb < 0.0 ? position[b][0] : crossing;
    front.area += std::numbers::pi * (to * to - from * from);  // facets that face the substrate run outward
    if (crosses && crossing > front.radius) {
      front.radius = crossing;
      height = (1.0 - cut) * position[a][1] + cut * position[b][1];
    }
  }
  front.center[1] = front.centroid[1] = height;
  return front;
}

TACTOID_INLINE double front_radius(const ContactFront& front, const Vector3& origin, const Vector3& direction,
                                   double half_angle, const Vector3& up) {
  const Vector3 axis = (direction - direction.dot(up) * up).normalized();
  double sum = 0.0;
  std::size_t count = 0;
  for (const Vector3& x : front.outline) {
    const Vector3 arm = (x - origin) - (x - origin).dot(up) * up;
    if (arm.dot(axis) < std::cos(half_angle) * arm.norm()) continue;
    sum += arm.norm();
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

}  // namespace tactoid
