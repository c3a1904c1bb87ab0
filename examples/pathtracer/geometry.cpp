// SPDX-License-Identifier: Apache-2.0
#include "geometry.hpp"

#include <algorithm>
#include <cmath>

namespace pathtracer {
namespace {

Vec3 mixed(const std::array<Vec3, 3>& a, Vec2 w) { return a[0] * (1 - w.x - w.y) + a[1] * w.x + a[2] * w.y; }

Vec2 sphere_uv(Vec3 normal) {
  const float turn = std::atan2(normal.x, normal.z) / (2 * kPi);
  return {turn + 0.5F, std::acos(std::clamp(normal.y, -1.0F, 1.0F)) / kPi};
}

}  // namespace

void Geometry::add(const Mesh& mesh, const Material& material, Vec3 motion) {
  const auto material_index = static_cast<std::uint32_t>(materials_.size());
  materials_.push_back(material);
  for (const auto& face : mesh.faces) {
    const Vec3 corner = mesh.positions[face[0]];
    const Triangle triangle = {corner, mesh.positions[face[1]] - corner, mesh.positions[face[2]] - corner, motion};
    const Vec3 normal = cross(triangle.edge1, triangle.edge2);
    if (!(length(normal) > 0)) continue;  // such as at the pole of a turned shape
    Shading shading;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 own = mesh.normals.empty() ? Vec3() : mesh.normals[face[i]];
      shading.normals[i] = own == Vec3() ? normalised(normal) : own;
      shading.uvs[i] = mesh.uvs[face[i]];
    }
    triangles_.push_back(triangle);
    shading_.push_back(shading);
    triangle_material_.push_back(material_index);
  }
}

void Geometry::add(Vec3 centre, float radius, const Material& material, Vec3 motion) {
  sphere_material_.push_back(static_cast<std::uint32_t>(materials_.size()));
  materials_.push_back(material);
  spheres_.push_back({centre, radius, motion});
}

void Geometry::build_tree() {
  std::vector<Bounds> boxes;
  boxes.reserve(shape_count());
  for (const Triangle& t : triangles_) boxes.push_back(bounds(t));
  for (const Sphere& s : spheres_) boxes.push_back(bounds(s));
  tree_ = Bvh(boxes);
  lights_.assign(shape_count(), -1);
}

const Material& Geometry::material(std::uint32_t shape) const {
  return materials_[is_triangle(shape) ? triangle_material_[shape] : sphere_material_[shape - triangles_.size()]];
}

bool Geometry::intersect_shape(std::uint32_t shape, const Ray& ray, ShapeHit& hit) const {
  return is_triangle(shape) ? pathtracer::intersect(triangle(shape), ray, hit)
                            : pathtracer::intersect(sphere(shape), ray, hit);
}

bool Geometry::intersect(const Ray& ray, Hit& hit) const {
  bool found = false;
  tree_.walk(ray, hit.at.distance, [&](std::uint32_t shape, float) {
    if (intersect_shape(shape, ray, hit.at)) {
      hit.shape = shape;
      found = true;
    }
    return hit.at.distance;
  });
  return found;
}

bool Geometry::is_occluded(const Ray& ray, float distance, std::uint32_t except) const {
  ShapeHit hit{distance, {}};
  bool found = false;
  tree_.walk(ray, distance, [&](std::uint32_t shape, float limit) {
    found = shape != except && intersect_shape(shape, ray, hit);
    return found ? -1.0F : limit;
  });
  return found;
}

SurfacePoint Geometry::surface_point(const Ray& ray, const Hit& hit) const {
  SurfacePoint point;
  point.material = &material(hit.shape);
  point.light = lights_[hit.shape];
  if (!is_triangle(hit.shape)) {
    const Sphere& s = sphere(hit.shape);
    const Vec3 centre = s.centre + s.motion * ray.time;
    point.normal = normalised(ray.origin + ray.direction * hit.at.distance - centre);
    point.geometric_normal = point.normal;
    point.position = centre + point.normal * s.radius;
    point.uv = sphere_uv(point.normal);
    return point;
  }
  const Triangle& t = triangle(hit.shape);
  const Shading& shading = shading_[hit.shape];
  const Vec2 w = hit.at.weights;
  point.position = t.corner + t.motion * ray.time + t.edge1 * w.x + t.edge2 * w.y;
  point.geometric_normal = normalised(cross(t.edge1, t.edge2));
  point.normal = normalised(mixed(shading.normals, w));
  if (dot(point.normal, point.geometric_normal) < 0) point.normal = -point.normal;
  point.uv = {shading.uvs[0].x * (1 - w.x - w.y) + shading.uvs[1].x * w.x + shading.uvs[2].x * w.y,
              shading.uvs[0].y * (1 - w.x - w.y) + shading.uvs[1].y * w.x + shading.uvs[2].y * w.y};
  return point;
}

Vec3 ray_start(const SurfacePoint& point, Vec3 direction) {
  constexpr float kRelative = 2e-5F;  // a hundred times the rounding of a coordinate
  const float offset = kRelative * (1 + largest(max(point.position, -point.position)));
  return point.position + point.geometric_normal * (dot(direction, point.geometric_normal) < 0 ? -offset : offset);
}

}  // namespace pathtracer
