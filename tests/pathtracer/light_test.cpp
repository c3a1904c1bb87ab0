// SPDX-License-Identifier: Apache-2.0
//
// Light that arrives, against closed forms; with every way to find it.
#include <cmath>

#include "catch.hpp"
#include "lights.hpp"
#include "path.hpp"
#include "scenes/scenes.hpp"
#include "support/statistics.hpp"

using namespace pathtracer;

namespace {

const Ray kDown = {{0, 1e-2F, 0}, {0, -1, 0}, 0};  // onto the origin

Geometry white_floor() {
  Geometry shapes;
  shapes.add(floor_square(2), diffuse(Colour(1)));
  return shapes;
}

// Radiance that the white floor sends up from the origin, after one bounce: irradiance / pi.
Statistics outgoing(const Scene& scene, DirectLight direct_light, int samples = 20000) {
  Statistics radiance;
  for (int i = 0; i < samples; ++i) {
    Random random(1, 0, static_cast<std::uint64_t>(i));
    radiance.add(trace_path(scene, kDown, random, {.max_bounces = 1, .direct_light = direct_light}).colour.y);
  }
  return radiance;
}

DirectLight any_way() { return GENERATE(DirectLight::kBoth, DirectLight::kLights, DirectLight::kScattered); }

// View factor from a point to a parallel rectangle at height 1 with one corner above the point.
double corner_factor(double a, double b) {
  const double ra = std::sqrt(1 + a * a);
  const double rb = std::sqrt(1 + b * b);
  return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2 * kPi);
}

}  // namespace

TEST_CASE("light of a rectangle") {
  Geometry shapes = white_floor();
  shapes.add(quad({-0.5F, 1, -0.25F}, {1.5F, 0, 0}, {0, 0, 1}), lamp(Colour(3)));
  const Scene scene(std::move(shapes), {}, {});
  const double factor =
      corner_factor(0.5, 0.25) + corner_factor(1, 0.25) + corner_factor(0.5, 0.75) + corner_factor(1, 0.75);
  CHECK(outgoing(scene, any_way()).agrees_with(3 * factor));
}

TEST_CASE("light of a ball at rest and moving past") {
  const DirectLight way = any_way();
  Geometry shapes = white_floor();
  shapes.add({0, 2, 0}, 0.6F, lamp(Colour(2)));
  const Scene scene(std::move(shapes), {}, {});
  const Statistics radiance = outgoing(scene, way);
  INFO(radiance.mean() << " +- " << radiance.standard_error());
  CHECK(radiance.agrees_with(2 * 0.36 / 4));

  Geometry moving = white_floor();
  moving.add({-10, 2, 0}, 0.6F, lamp(Colour(2)), {20, 0, 0});
  const Scene moving_scene(std::move(moving), {}, {});
  Random random(2, 0, 0);
  Statistics halfway;
  for (int i = 0; i < 10000; ++i) {
    Ray ray = kDown;
    ray.time = 0.5F;
    halfway.add(trace_path(moving_scene, ray, random, {.max_bounces = 1, .direct_light = way}).colour.y);
  }
  CHECK(halfway.agrees_with(2 * 0.36 / 4));
}

TEST_CASE("light of a ball from the side") {
  Geometry shapes = white_floor();
  shapes.add({2, 1, 0}, 0.5F, lamp(Colour(2)));
  const Scene scene(std::move(shapes), {}, {});
  CHECK(outgoing(scene, any_way()).agrees_with(2 * 0.25 / 5 / std::sqrt(5.0)));
}

TEST_CASE("light of the sun and of the sky") {
  const DirectLight way = any_way();
  const Scene sky(white_floor(), constant_environment(Colour(0.7F)), {});
  CHECK(outgoing(sky, way).agrees_with(0.7));

  Environment sun;
  set_sun(sun, 30, 70, 10, Colour(4));
  const Scene sunny(white_floor(), sun, {});
  CHECK(outgoing(sunny, way, 40000).agrees_with(4 * 0.5 / kPi));
}

TEST_CASE("several lights: each with its own share") {
  Geometry shapes = white_floor();
  shapes.add({0, 2, 0}, 0.6F, lamp(Colour(2)));
  shapes.add({2, 1, 0}, 0.5F, lamp(Colour(20)));
  shapes.add(quad({-3, 1, -3}, {1, 0, 0}, {0, 1, 0}), lamp(Colour(1)));  // faces away
  const Scene scene(std::move(shapes), constant_environment(Colour(0.01F)), {});
  const double balls = 2 * 0.36 / 4 + 20 * 0.25 / 5 / std::sqrt(5.0);
  const Statistics radiance = outgoing(scene, any_way(), 40000);
  CHECK(radiance.mean() > balls - 4 * radiance.standard_error());
  CHECK(radiance.mean() < balls + 0.01 + 4 * radiance.standard_error());
}

TEST_CASE("lights: the density of a sample is the one told for a ray that meets it") {
  Geometry shapes;
  shapes.add(quad({-0.5F, 1, -0.25F}, {1.5F, 0, 0}, {0, 0, 1}), lamp(Colour(3)));
  shapes.add({3, 1, 0}, 0.5F, lamp(Colour(2)), {0, 1, 0});
  Environment sky = constant_environment(Colour(0.1F));
  set_sun(sky, 50, 200, 2, Colour(1));
  const Scene scene(std::move(shapes), sky, {});
  Random random(3, 0, 0);
  int met = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 from = {random.uniform(), -random.uniform(), random.uniform()};
    const float time = random.uniform();
    const LightSample s = scene.lights().sample(from, time, random.uniform2());
    if (s.pdf == 0) continue;
    const Ray ray = {from, s.direction, time};
    Hit hit;
    if (!scene.geometry().intersect(ray, hit)) {
      if (s.distance == kInfinity) REQUIRE(scene.lights().environment_pdf(s.direction) == Approx(s.pdf).epsilon(1e-3));
      continue;
    }
    if (s.distance == kInfinity || hit.at.distance < 0.999F * s.distance) continue;
    ++met;
    REQUIRE(hit.at.distance == Approx(s.distance).epsilon(1e-2));
    REQUIRE(scene.lights().pdf(scene.geometry().surface_point(ray, hit), from, time) == Approx(s.pdf).epsilon(2e-2));
  }
  CHECK(met > 200);
}

TEST_CASE("lamps shine to the front only, and shadows are black") {
  const DirectLight way = any_way();
  Geometry turned = white_floor();
  turned.add(quad({-0.5F, 1, -0.5F}, {0, 0, 1}, {1, 0, 0}), lamp(Colour(3)));
  const Scene turned_scene(std::move(turned), {}, {});
  CHECK(outgoing(turned_scene, way, 2000).mean() == 0);

  Geometry shaded = white_floor();
  shaded.add({0, 2, 0}, 0.3F, lamp(Colour(2)));
  shaded.add({0, 0.8F, 0}, 0.4F, diffuse(Colour()));
  const Scene shaded_scene(std::move(shaded), {}, {});
  CHECK(outgoing(shaded_scene, way, 2000).mean() == 0);
}
