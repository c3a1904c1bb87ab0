// SPDX-License-Identifier: Apache-2.0
#include "bvh.hpp"

#include <cstdint>
#include <vector>

#include "catch.hpp"
#include "geometry.hpp"
#include "random.hpp"

using namespace pathtracer;

namespace {

Vec3 in_cube(Random& random) { return {random.uniform(), random.uniform(), random.uniform()}; }

Mesh random_triangles(Random& random, std::uint32_t count, float size) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 corner = in_cube(random);
    for (int k = 0; k < 3; ++k) {
      mesh.positions.push_back(corner + (in_cube(random) - Vec3(0.5F)) * size);
      mesh.uvs.push_back({});
    }
    mesh.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

Ray random_ray(Random& random) {
  const Vec3 origin = in_cube(random) * 3 - Vec3(1);
  const Vec3 way = in_cube(random) - origin;
  const bool is_straight = random.uniform() < 0.2F;  // along the sides of boxes
  return {origin, normalised(is_straight ? Vec3(0, 0, way.z) : way), random.uniform()};
}

Hit brute_force(const Geometry& shapes, const Ray& ray) {
  Hit hit;
  for (std::uint32_t shape = 0; shape < shapes.shape_count(); ++shape) {
    const bool nearer = shapes.is_triangle(shape) ? intersect(shapes.triangle(shape), ray, hit.at)
                                                  : intersect(shapes.sphere(shape), ray, hit.at);
    if (nearer) hit.shape = shape;
  }
  return hit;
}

void compare_with_brute_force(const Geometry& shapes, Random& random, int rays) {
  int hits = 0;
  for (int i = 0; i < rays; ++i) {
    const Ray ray = random_ray(random);
    const Hit expected = brute_force(shapes, ray);
    Hit hit;
    const bool met = shapes.intersect(ray, hit);
    REQUIRE(met == (expected.at.distance < kInfinity));
    if (!met) continue;
    ++hits;
    REQUIRE(hit.at.distance == expected.at.distance);
    REQUIRE(hit.shape == expected.shape);
    REQUIRE(shapes.is_occluded(ray, hit.at.distance * 1.001F));
    REQUIRE_FALSE(shapes.is_occluded(ray, hit.at.distance * 0.999F));
  }
  CHECK(hits > 10);
}

}  // namespace

TEST_CASE("tree: rays meet what they meet without it") {
  Random random(1, 0, 0);
  const auto count = GENERATE(1U, 2U, 3U, 40U, 600U);
  Geometry shapes;
  shapes.add(random_triangles(random, count, 0.6F), {});
  shapes.add(random_triangles(random, count, 0.1F), {}, {0.3F, -0.2F, 0.5F});
  for (std::uint32_t i = 0; i < count; ++i) shapes.add(in_cube(random), 0.1F * random.uniform(), {}, in_cube(random));
  shapes.build_tree();
  compare_with_brute_force(shapes, random, 1500);
}

TEST_CASE("tree: shapes in one place cannot be parted, and are found") {
  Geometry shapes;
  for (int i = 0; i < 100; ++i) shapes.add({0.5F, 0.5F, 0.5F}, 0.2F + 0.001F * static_cast<float>(i), {});
  shapes.build_tree();
  Random random(2, 0, 0);
  compare_with_brute_force(shapes, random, 300);
}

TEST_CASE("tree: very uneven shapes stay within the walk's memory") {
  Geometry shapes;
  float x = 1;
  for (int i = 0; i < 100; ++i) {
    x *= 0.8F;
    shapes.add({x, 0, 0}, 0.1F * x, {});
  }
  shapes.build_tree();
  Hit hit;
  REQUIRE(shapes.intersect({{0, 0, 0}, {1, 0, 0}, 0}, hit));
  CHECK(hit.shape == 99);
}

TEST_CASE("tree: an empty scene") {
  Geometry shapes;
  shapes.build_tree();
  Hit hit;
  CHECK_FALSE(shapes.intersect({{0, 0, 0}, {0, 0, 1}, 0}, hit));
}

TEST_CASE("shapes: motion moves them while the shutter is open") {
  Geometry shapes;
  shapes.add({0, 0, 0}, 0.5F, {}, {4, 0, 0});
  shapes.build_tree();
  Hit hit;
  CHECK(shapes.intersect({{0, 0, -5}, {0, 0, 1}, 0}, hit));
  CHECK(hit.at.distance == Approx(4.5));
  hit = {};
  CHECK_FALSE(shapes.intersect({{0, 0, -5}, {0, 0, 1}, 0.5F}, hit));
  const Ray late = {{2, 0, -5}, {0, 0, 1}, 0.5F};
  REQUIRE(shapes.intersect(late, hit));
  CHECK(shapes.surface_point(late, hit).position.x == Approx(2));
  CHECK(shapes.surface_point(late, hit).normal.z == Approx(-1));
}
