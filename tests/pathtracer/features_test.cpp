// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "catch.hpp"
#include "path.hpp"
#include "scenes/scenes.hpp"
#include "support/statistics.hpp"

using namespace pathtracer;

namespace {

const Ray kForward = {{0, 1, 0}, {0, 0, -1}, 0};

PathSample trace(const Scene& scene, const Ray& ray, std::uint64_t index = 0) {
  Random random(1, 0, index);
  return trace_path(scene, ray, random);
}

Mesh wall(float z) { return quad({-5, -5, z}, {10, 0, 0}, {0, 10, 0}); }

}  // namespace

TEST_CASE("features are those of the first surface") {
  Geometry shapes;
  shapes.add(wall(-3), diffuse(Colour(0.2F, 0.4F, 0.6F)));
  shapes.add({0, 1, 2}, 0.5F, lamp(Colour(5)));
  const Scene scene(std::move(shapes), {}, {});
  const PathSample s = trace(scene, kForward);
  CHECK(s.albedo == Colour(0.2F, 0.4F, 0.6F));
  CHECK(s.normal.z == Approx(1));
  CHECK(s.depth == Approx(3));
  CHECK(length(s.position - Vec3(0, 1, -3)) < 1e-4F);
  CHECK(s.visibility == 1);
}

TEST_CASE("features behind a mirror and glass are those that are seen in them, tinted") {
  Geometry shapes;
  shapes.add(wall(-3), mirror({0.9F, 0.5F, 0.5F}));
  shapes.add(placed(wall(0), {0, 0, 4}, 180), diffuse(Colour(0.5F)));
  shapes.add(wall(-2), {.surface = Surface::kGlass, .colour = Colour(1), .refraction = 1});
  const Scene scene(std::move(shapes), {}, {});
  const PathSample s = trace(scene, kForward);
  CHECK(s.depth == Approx(10).epsilon(1e-4));
  CHECK(s.normal.z == Approx(-1));
  CHECK(s.position.z == Approx(4));
  CHECK(s.albedo.x == Approx(0.45));
  CHECK(s.albedo.y == Approx(0.25));
}

TEST_CASE("features of nothing are 0, of lamps black") {
  Geometry shapes;
  shapes.add(wall(-3), lamp(Colour(2)));
  const Scene scene(std::move(shapes), constant_environment(Colour(0.5F)), {});
  const PathSample on_lamp = trace(scene, kForward);
  CHECK(on_lamp.colour == Colour(2));
  CHECK(on_lamp.albedo == Colour());
  CHECK(on_lamp.depth == Approx(3));
  const PathSample nothing = trace(scene, {{0, 1, 0}, {0, 0, 1}, 0});
  CHECK(nothing.colour == Colour(0.5F));
  CHECK(nothing.depth == 0);
  CHECK(nothing.normal == Vec3());
  CHECK(nothing.visibility == 0);
}

TEST_CASE("visibility says how much of a lamp is seen") {
  Geometry shapes;
  shapes.add(floor_square(10), diffuse(Colour(0.5F)));
  shapes.add(quad({-0.5F, 2, -0.5F}, {1, 0, 0}, {0, 0, 1}), lamp(Colour(1)));
  shapes.add(quad({-2, 1.999F, -2}, {2.25F, 0, 0}, {0, 0, 4}), diffuse(Colour()));  // three quarters of the lamp
  const Scene scene(std::move(shapes), {}, {});
  Statistics visibility;
  for (std::uint64_t i = 0; i < 10000; ++i) visibility.add(trace(scene, {{0, 1, 0}, {0, -1, 0}, 0}, i).visibility);
  CHECK(visibility.mean() == Approx(0.25).margin(4 * visibility.standard_error() + 1e-3));
}

TEST_CASE("the second surface, and the random numbers of the lamp") {
  Geometry shapes;
  shapes.add(wall(-3), diffuse(Colour(0.5F)));
  shapes.add(placed(wall(0), {0, 0, 40}, 180), diffuse(Colour(0.5F)));
  const Scene scene(std::move(shapes), constant_environment(Colour(1)), {});
  int second = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const PathSample s = trace(scene, kForward, i);
    CHECK((s.light.x >= 0 && s.light.x < 1 && s.light.y >= 0 && s.light.y < 1));
    if (s.normal2 == Vec3()) continue;
    ++second;
    CHECK(s.position2.z == Approx(40));
    CHECK(s.normal2.z == Approx(-1));
  }
  CHECK(second > 5);
  CHECK(second < 100);
}
