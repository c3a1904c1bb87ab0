// SPDX-License-Identifier: Apache-2.0
//
// All shapes of a scene, and what rays meet of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bvh.hpp"
#include "material.hpp"
#include "mesh.hpp"
#include "shapes.hpp"

namespace pathtracer {

/// What was met: shape number `shape` (triangles first, then spheres).
struct Hit {
  ShapeHit at;
  std::uint32_t shape = 0;
};

constexpr std::uint32_t kNoShape = UINT32_MAX;

class Geometry {
 public:
  void add(const Mesh& mesh, const Material& material, Vec3 motion = {});
  void add(Vec3 centre, float radius, const Material& material, Vec3 motion = {});
  /// To be called once, after the last `add`.
  void build_tree();

  [[nodiscard]] bool intersect(const Ray& ray, Hit& hit) const;
  /// Is anything but the shape `except` nearer than `distance`?
  [[nodiscard]] bool is_occluded(const Ray& ray, float distance, std::uint32_t except = kNoShape) const;
  [[nodiscard]] SurfacePoint surface_point(const Ray& ray, const Hit& hit) const;

  [[nodiscard]] std::size_t shape_count() const { return triangles_.size() + spheres_.size(); }
  [[nodiscard]] bool is_triangle(std::uint32_t shape) const { return shape < triangles_.size(); }
  [[nodiscard]] const Triangle& triangle(std::uint32_t shape) const { return triangles_[shape]; }
  [[nodiscard]] const Sphere& sphere(std::uint32_t shape) const { return spheres_[shape - triangles_.size()]; }
  [[nodiscard]] const Material& material(std::uint32_t shape) const;

  /// Index into the list of lights, -1: none.
  [[nodiscard]] int light(std::uint32_t shape) const { return lights_[shape]; }
  void set_light(std::uint32_t shape, int light) { lights_[shape] = light; }

 private:
  // Of the three corners of a triangle.
  struct Shading {
    std::array<Vec3, 3> normals;
    std::array<Vec2, 3> uvs;
  };

  [[nodiscard]] bool intersect_shape(std::uint32_t shape, const Ray& ray, ShapeHit& hit) const;

  std::vector<Triangle> triangles_;
  std::vector<Shading> shading_;  // of the triangles
  std::vector<std::uint32_t> triangle_material_;
  std::vector<Sphere> spheres_;
  std::vector<std::uint32_t> sphere_material_;
  std::vector<Material> materials_;
  std::vector<int> lights_;
  Bvh tree_;
};

/// `position` moved off the surface, to the side that `direction` leaves to: rays must not meet where they start.
[[nodiscard]] Vec3 ray_start(const SurfacePoint& point, Vec3 direction);

}  // namespace pathtracer
