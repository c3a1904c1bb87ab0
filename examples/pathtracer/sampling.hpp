// SPDX-License-Identifier: Apache-2.0
//
// Maps from the unit square to the domains that are sampled.
#pragma once

#include <algorithm>
#include <cmath>

#include "vec3.hpp"

namespace pathtracer {

/// Uniform on the unit disc; neighbours stay neighbours.
inline Vec2 uniform_disc(Vec2 u) {
  const float x = 2 * u.x - 1;
  const float y = 2 * u.y - 1;
  if (x == 0 && y == 0) return {};
  const bool wide = std::abs(x) > std::abs(y);
  const float radius = wide ? x : y;
  const float angle = wide ? kPi / 4 * (y / x) : kPi / 2 - kPi / 4 * (x / y);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Density cos / pi around +z.
inline Vec3 cosine_hemisphere(Vec2 u) {
  const Vec2 d = uniform_disc(u);
  return {d.x, d.y, std::sqrt(std::max(0.0F, 1 - d.x * d.x - d.y * d.y))};
}

/// Uniform over the directions within a cone around +z. `height` = 1 - cosine of its half angle, in (0, 2]; 2: sphere.
inline Vec3 uniform_cone(Vec2 u, float height) {
  const float down = u.x * height;  // 1 - z, kept as such: for narrow cones z itself has no digits left
  const float radius = std::sqrt(std::max(0.0F, down * (2 - down)));
  const float angle = 2 * kPi * u.y;
  return {radius * std::cos(angle), radius * std::sin(angle), 1 - down};
}
inline float uniform_cone_pdf(float height) { return 1 / (2 * kPi * height); }

/// Barycentric weights of the second and third corner, uniform on a triangle.
inline Vec2 uniform_triangle(Vec2 u) {
  const float root = std::sqrt(u.x);
  return {root * (1 - u.y), root * u.y};
}

/// Weight of the first of two ways to sample the same integral: the power heuristic (Veach 1997).
inline float power_heuristic(float pdf, float other_pdf) {
  const float ratio = other_pdf / pdf;
  return 1 / (1 + ratio * ratio);
}

}  // namespace pathtracer
