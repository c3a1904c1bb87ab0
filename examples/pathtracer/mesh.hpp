// SPDX-License-Identifier: Apache-2.0
//
// Triangle meshes and ways to make them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "vec3.hpp"

namespace pathtracer {

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;                        ///< one per position, for smooth shading; empty: flat
  std::vector<Vec2> uvs;                            ///< one per position
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< counter-clockwise seen from the front
};

/// A parallelogram with the normal edge_u x edge_v, uv in [0, 1]^2.
[[nodiscard]] Mesh quad(Vec3 corner, Vec3 edge_u, Vec3 edge_v);

/// An upright box on (centre.x, base, centre.z), turned about the vertical.
[[nodiscard]] Mesh block(Vec3 base_centre, Vec3 size, float turn_degrees);

/// (radius, height) points, from the bottom outwards and up, turned around the vertical through the origin. Smoothed by
/// a spline.
[[nodiscard]] Mesh lathe(std::span<const Vec2> profile, int segments);

/// A round tube along a curve through `points`, with a radius at each.
[[nodiscard]] Mesh tube(std::span<const Vec3> points, std::span<const float> radii, int segments);

/// Scaled, turned about the vertical, then moved.
[[nodiscard]] Mesh placed(Mesh mesh, Vec3 position, float turn_degrees = 0, float scale = 1);

}  // namespace pathtracer
