// SPDX-License-Identifier: Apache-2.0
#include "mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pathtracer {
namespace {

constexpr int kSplineSteps = 8;

float radians(float degrees) { return degrees * kPi / 180; }

Vec3 turned(Vec3 p, float angle) {
  const float c = std::cos(angle);
  const float s = std::sin(angle);
  return {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
}

Vec3 scaled(Vec3 a, float s) { return a * s; }
Vec2 scaled(Vec2 a, float s) { return {a.x * s, a.y * s}; }
float scaled(float a, float s) { return a * s; }
Vec3 sum(Vec3 a, Vec3 b) { return a + b; }
Vec2 sum(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
float sum(float a, float b) { return a + b; }

// Catmull-Rom through all points.
template <class Value>
std::vector<Value> spline(std::span<const Value> points) {
  std::vector<Value> out;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Value& a = points[i == 0 ? 0 : i - 1];
    const Value& b = points[i];
    const Value& c = points[i + 1];
    const Value& d = points[std::min(i + 2, points.size() - 1)];
    for (int step = 0; step < kSplineSteps; ++step) {
      const float t = static_cast<float>(step) / kSplineSteps;
      const float t2 = t * t;
      const float t3 = t2 * t;
      out.push_back(sum(sum(scaled(a, (-t3 + 2 * t2 - t) / 2), scaled(b, (3 * t3 - 5 * t2 + 2) / 2)),
                        sum(scaled(c, (-3 * t3 + 4 * t2 + t) / 2), scaled(d, (t3 - t2) / 2))));
    }
  }
  out.push_back(points.back());
  return out;
}

// A grid of rings.size() / (segments + 1) rings; the first and last column coincide. Normals from the neighbours.
Mesh skin(std::vector<Vec3> points, int segments) {
  Mesh mesh;
  const auto columns = static_cast<std::uint32_t>(segments) + 1;
  const auto rings = static_cast<std::uint32_t>(points.size()) / columns;
  const auto point = [&](std::uint32_t ring, std::uint32_t column) { return points[ring * columns + column]; };
  for (std::uint32_t r = 0; r < rings; ++r) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      const std::uint32_t before = c == 0 ? columns - 2 : c - 1;
      const std::uint32_t after = c + 1 == columns ? 1 : c + 1;
      const Vec3 across = point(r, after) - point(r, before);
      const Vec3 along = point(std::min(r + 1, rings - 1), c) - point(r == 0 ? 0 : r - 1, c);
      const Vec3 normal = cross(along, across);
      const float size = length(normal);
      mesh.normals.push_back(size > 0 ? normal / size : Vec3());  // 0: a pole, where the face's normal is used
      mesh.uvs.push_back({static_cast<float>(c) / static_cast<float>(segments),
                          static_cast<float>(r) / static_cast<float>(rings - 1)});
      if (r > 0 && c > 0) {
        const std::uint32_t i = r * columns + c;
        mesh.faces.push_back({i - columns - 1, i, i - columns});
        mesh.faces.push_back({i - columns - 1, i - 1, i});
      }
    }
  }
  mesh.positions = std::move(points);
  return mesh;
}

}  // namespace

Mesh quad(Vec3 corner, Vec3 edge_u, Vec3 edge_v) {
  Mesh mesh;
  mesh.positions = {corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Mesh block(Vec3 base_centre, Vec3 size, float turn_degrees) {
  Mesh mesh;
  const Vec3 ex = {size.x, 0, 0};
  const Vec3 ey = {0, size.y, 0};
  const Vec3 ez = {0, 0, size.z};
  const Vec3 low = {-size.x / 2, 0, -size.z / 2};
  const Vec3 high = low + ex + ey + ez;
  for (const Mesh& side : {quad(low, ex, ez), quad(low, ez, ey), quad(low, ey, ex), quad(high, -ez, -ex),
                           quad(high, -ey, -ez), quad(high, -ex, -ey)}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), side.positions.begin(), side.positions.end());
    mesh.uvs.insert(mesh.uvs.end(), side.uvs.begin(), side.uvs.end());
    for (const auto& face : side.faces) mesh.faces.push_back({first + face[0], first + face[1], first + face[2]});
  }
  return placed(std::move(mesh), base_centre, turn_degrees);
}

Mesh lathe(std::span<const Vec2> profile, int segments) {
  std::vector<Vec3> points;
  for (const Vec2 p : spline(profile)) {
    for (int s = 0; s <= segments; ++s) {
      const float angle = 2 * kPi * static_cast<float>(s % segments) / static_cast<float>(segments);
      points.push_back({p.x * std::cos(angle), p.y, p.x * std::sin(angle)});
    }
  }
  return skin(std::move(points), segments);
}

Mesh tube(std::span<const Vec3> points, std::span<const float> radii, int segments) {
  const std::vector<Vec3> path = spline(points);
  const std::vector<float> radius = spline(radii);
  std::vector<Vec3> skin_points;
  Vec3 side = Basis(normalised(path[1] - path[0])).to_world({1, 0, 0});
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vec3 along = normalised(path[std::min(i + 1, path.size() - 1)] - path[i == 0 ? 0 : i - 1]);
    side = normalised(side - along * dot(side, along));  // carried along the curve, so that the skin does not twist
    const Vec3 other = cross(side, along);
    for (int s = 0; s <= segments; ++s) {
      const float angle = 2 * kPi * static_cast<float>(s % segments) / static_cast<float>(segments);
      skin_points.push_back(path[i] + (side * std::cos(angle) + other * std::sin(angle)) * radius[i]);
    }
  }
  return skin(std::move(skin_points), segments);
}

Mesh placed(Mesh mesh, Vec3 position, float turn_degrees, float scale) {
  const float angle = radians(turn_degrees);
  for (Vec3& p : mesh.positions) p = turned(p * scale, angle) + position;
  for (Vec3& n : mesh.normals) n = turned(n, angle);
  return mesh;
}

}  // namespace pathtracer
