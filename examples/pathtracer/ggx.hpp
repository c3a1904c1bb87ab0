// SPDX-License-Identifier: Apache-2.0
//
// The GGX distribution of microfacets (Walter et al. 2007), in coordinates where the normal is +z.
#pragma once

#include <algorithm>
#include <cmath>

#include "vec3.hpp"

namespace pathtracer::ggx {

/// Density of microfacet normals.
inline float distribution(Vec3 half, float alpha) {
  const float a2 = alpha * alpha;
  // 1 - z^2 + a^2 z^2, written so that smooth surfaces keep their digits.
  const float d = half.x * half.x + half.y * half.y + a2 * half.z * half.z;
  return a2 / (kPi * d * d);
}

inline float slope_root(Vec3 v, float alpha) { return std::sqrt(alpha * alpha * (v.x * v.x + v.y * v.y) + v.z * v.z); }

/// The part of the microfacets facing `v` that are not hidden from it.
inline float masking(Vec3 v, float alpha) { return 2 * v.z / (v.z + slope_root(v, alpha)); }

/// The part that is hidden neither from `a` nor from `b`, with the correlation of heights (Heitz 2014).
inline float shadowing(Vec3 a, Vec3 b, float alpha) {
  return 2 * a.z * b.z / (a.z * slope_root(b, alpha) + b.z * slope_root(a, alpha));
}

/// A microfacet normal among those that `v` sees (Dupuy and Benyoub 2023).
inline Vec3 sample_visible(Vec3 v, float alpha, Vec2 u) {
  const Vec3 stretched = normalised({alpha * v.x, alpha * v.y, v.z});
  const float angle = 2 * kPi * u.x;
  const float z = (1 - u.y) * (1 + stretched.z) - stretched.z;
  const float radius = std::sqrt(std::clamp(1 - z * z, 0.0F, 1.0F));
  const Vec3 h = Vec3(radius * std::cos(angle), radius * std::sin(angle), z) + stretched;
  return normalised({alpha * h.x, alpha * h.y, std::max(h.z, 1e-6F)});
}

/// The density of the directions into which `sample_visible` reflects `v`.
inline float reflection_pdf(Vec3 v, Vec3 half, float alpha) {
  return masking(v, alpha) * distribution(half, alpha) / (4 * v.z);
}

}  // namespace pathtracer::ggx
