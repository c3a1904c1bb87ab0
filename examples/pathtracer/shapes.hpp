// SPDX-License-Identifier: Apache-2.0
//
// What rays meet: triangles and spheres, each at rest or moving along a line while the shutter is open.
#pragma once

#include <cmath>
#include <limits>

#include "vec3.hpp"

namespace pathtracer {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Ray {
  Vec3 origin;
  Vec3 direction;  ///< unit length
  float time = 0;  ///< of the shutter's interval, in [0, 1)
};

struct Bounds {
  Vec3 low{kInfinity};
  Vec3 high{-kInfinity};

  void add(Vec3 p) {
    low = min(low, p);
    high = max(high, p);
  }
  void add(const Bounds& b) {
    low = min(low, b.low);
    high = max(high, b.high);
  }
  [[nodiscard]] Vec3 centre() const { return (low + high) * 0.5F; }
  [[nodiscard]] float half_area() const {
    const Vec3 d = high - low;
    return d.x * d.y + d.y * d.z + d.z * d.x;
  }
};

struct Triangle {
  Vec3 corner;
  Vec3 edge1;
  Vec3 edge2;
  Vec3 motion;  ///< way from time 0 to time 1
};

struct Sphere {
  Vec3 centre;
  float radius = 1;
  Vec3 motion;
};

/// Where a ray met a shape: the distance, and for triangles the weights of the second and third corner.
struct ShapeHit {
  float distance = kInfinity;
  Vec2 weights;
};

inline Bounds bounds(const Triangle& t) {
  Bounds box;
  for (const Vec3 corner : {t.corner, t.corner + t.edge1, t.corner + t.edge2}) {
    box.add(corner);
    box.add(corner + t.motion);
  }
  return box;
}

inline Bounds bounds(const Sphere& s) {
  Bounds box;
  for (const Vec3 centre : {s.centre, s.centre + s.motion}) {
    box.add(centre - Vec3(s.radius));
    box.add(centre + Vec3(s.radius));
  }
  return box;
}

/// True, with `hit` overwritten, if the ray meets the triangle nearer than `hit`. After Möller and Trumbore (1997).
inline bool intersect(const Triangle& t, const Ray& ray, ShapeHit& hit) {
  const Vec3 p = cross(ray.direction, t.edge2);
  const float determinant = dot(t.edge1, p);
  if (determinant == 0) return false;
  const float inverse = 1 / determinant;
  const Vec3 from_corner = ray.origin - t.motion * ray.time - t.corner;
  const float u = dot(from_corner, p) * inverse;
  if (!(u >= 0 && u <= 1)) return false;
  const Vec3 q = cross(from_corner, t.edge1);
  const float v = dot(ray.direction, q) * inverse;
  if (!(v >= 0 && u + v <= 1)) return false;
  const float distance = dot(t.edge2, q) * inverse;
  if (!(distance > 0 && distance < hit.distance)) return false;
  hit = {distance, {u, v}};
  return true;
}

inline bool intersect(const Sphere& s, const Ray& ray, ShapeHit& hit) {
  const Vec3 to_centre = s.centre + s.motion * ray.time - ray.origin;
  const float along = dot(to_centre, ray.direction);
  const Vec3 aside = to_centre - ray.direction * along;  // its length squared has no cancellation, unlike b^2 - 4ac
  const float discriminant = s.radius * s.radius - dot(aside, aside);
  if (discriminant < 0) return false;
  const float half = std::sqrt(discriminant);
  const float distance = along - half > 0 ? along - half : along + half;
  if (!(distance > 0 && distance < hit.distance)) return false;
  hit = {distance, {}};
  return true;
}

}  // namespace pathtracer
