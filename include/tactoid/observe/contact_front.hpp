#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include <tactoid/contact/surface.hpp>
#include <tactoid/core/tensor.hpp>

namespace tactoid {

/// Area of contact and its front, from the gaps at the surface particles.
struct ContactFront {
  double area = 0.0;                    ///< of the surface with gap < cutoff, projected on the substrate, m²
  Vector3 centroid = Vector3::Zero();   ///< of that area, m; zero without contact
  double radius = 0.0;                  ///< mean of the front's radius r(θ) around the centroid, m
  std::vector<double> modes;            ///< amplitude of cos/sin m θ in r(θ) over `radius`, m = 0 … (modes[0] = 1)
  double modulation = 0.0;              ///< root mean square of r(θ)/radius − 1 in the modes m >= 2
};

/// The outer front r(θ) in equal sectors of angle, from points (θ, r) of the contour: the outermost point of each
/// sector, so that pockets under the cell do not count; sectors without a point are interpolated.
[[nodiscard]] inline std::vector<double> outer_front(const std::vector<std::array<double, 2>>& polar, std::size_t sectors) {
  std::vector<double> r(sectors, 0.0);
  for (const auto& [angle, distance] : polar) {
    const double turn = angle / (2.0 * std::numbers::pi) + 0.5;
    const auto sector = static_cast<std::size_t>(turn * static_cast<double>(sectors)) % sectors;
    r[sector] = std::max(r[sector], distance);
  }
  std::vector<double> filled = r;
  for (std::size_t k = 0; k < sectors; ++k) {
    if (r[k] > 0.0) continue;
    std::size_t before = 1, after = 1;
    while (before < sectors && r[(k + sectors - before) % sectors] == 0.0) ++before;
    while (after < sectors && r[(k + after) % sectors] == 0.0) ++after;
    const double w = static_cast<double>(before) / static_cast<double>(before + after);
    filled[k] = (1.0 - w) * r[(k + sectors - before) % sectors] + w * r[(k + after) % sectors];
  }
  return filled;
}

/// Cuts the facets of a surface along the contour gap = cutoff, so that the area is continuous in time. Each
/// bilinear facet is four triangles around its centre. `gaps`: signed gap per particle; `up`: unit normal of the
/// substrate, on which areas are projected: facets that face the substrate count.
[[nodiscard]] inline ContactFront contact_front(const FacetSurface<3>& surface, std::span<const Vector4> position,
                                                std::span<const double> gaps, double cutoff, const Vector3& up = Vector3::UnitZ(),
                                                int modes = 16) {
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
  if (!(front.area > 0.0)) {
    front.area = 0.0;
    front.centroid.setZero();
    return front;
  }
  front.centroid /= front.area;
  const std::size_t sectors = 4 * static_cast<std::size_t>(modes) + 8;
  const Vector3 e1 = up.unitOrthogonal(), e2 = up.cross(e1);
  std::vector<std::array<double, 2>> polar;
  for (const auto& segment : contour)
    for (const Vector3& x : segment) {
      const Vector3 d = x - front.centroid;
      polar.push_back({std::atan2(d.dot(e2), d.dot(e1)), std::hypot(d.dot(e1), d.dot(e2))});
    }
  if (polar.size() < 3) return front;
  const std::vector<double> r = outer_front(polar, sectors);
  auto amplitude = [&](int m) {
    double a = 0.0, b = 0.0;
    for (std::size_t k = 0; k < sectors; ++k) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(sectors);
      a += r[k] * std::cos(m * angle);
      b += r[k] * std::sin(m * angle);
    }
    return 2.0 * std::hypot(a, b) / static_cast<double>(sectors);
  };
  front.radius = 0.5 * amplitude(0);
  front.modes[0] = 1.0;
  double sum = 0.0;
  for (int m = 1; m <= modes; ++m) {
    front.modes[static_cast<std::size_t>(m)] = amplitude(m) / front.radius;
    if (m >= 2) sum += 0.5 * front.modes[static_cast<std::size_t>(m)] * front.modes[static_cast<std::size_t>(m)];
  }
  front.modulation = std::sqrt(sum);
  return front;
}

}  // namespace tactoid
