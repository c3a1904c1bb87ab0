// SPDX-License-Identifier: Apache-2.0
#include "sampling.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

#include "camera.hpp"
#include "catch.hpp"
#include "environment.hpp"
#include "mesh.hpp"
#include "random.hpp"
#include "support/statistics.hpp"
#include "texture.hpp"

using namespace pathtracer;

TEST_CASE("random: uniform, also over neighbouring pixels, samples and seeds") {
  const int what = GENERATE(0, 1, 2);
  constexpr int kCells = 16;
  constexpr int kCount = 40000;
  std::array<int, kCells * kCells> cells{};  // of the first two numbers
  Statistics product;                        // with the stream before
  float before = 0.5F;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    Random random(what == 0 ? i : 7, what == 1 ? i : 7, what == 2 ? i : 7);
    const Vec2 u = random.uniform2();
    REQUIRE((u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1));
    ++cells[static_cast<std::size_t>(kCells * u.y) * kCells + static_cast<std::size_t>(kCells * u.x)];
    product.add((u.x - 0.5) * (before - 0.5));
    before = u.x;
  }
  double chi2 = 0;
  const double expected = static_cast<double>(kCount) / cells.size();
  for (const int n : cells) chi2 += (n - expected) * (n - expected) / expected;
  const double freedom = cells.size() - 1;
  CHECK(std::abs(chi2 - freedom) < 4 * std::sqrt(2 * freedom));
  CHECK(product.agrees_with(0));
}

TEST_CASE("random: equal seed, pixel and index give equal numbers") {
  Random a(3, 4, 5);
  Random b(3, 4, 5);
  Random c(3, 5, 4);
  CHECK(a.bits() == b.bits());
  CHECK(a.bits() != c.bits());
}

TEST_CASE("sampling: moments of the maps") {
  Random random(5, 0, 0);
  Statistics disc2, cosine, cone, triangle;
  constexpr float kHeight = 0.3F;
  for (int i = 0; i < 20000; ++i) {
    const Vec2 u = random.uniform2();
    const Vec2 d = uniform_disc(u);
    disc2.add(d.x * d.x + d.y * d.y);
    cosine.add(cosine_hemisphere(u).z);
    const Vec3 c = uniform_cone(u, kHeight);
    REQUIRE(length(c) == Approx(1).epsilon(1e-5));
    cone.add(c.z);
    const Vec2 t = uniform_triangle(u);
    REQUIRE((t.x >= 0 && t.y >= 0 && t.x + t.y <= 1.00001F));
    triangle.add(t.x * t.y);
  }
  CHECK(disc2.agrees_with(0.5));
  CHECK(cosine.agrees_with(2.0 / 3));
  CHECK(cone.agrees_with(1 - kHeight / 2));
  CHECK(triangle.agrees_with(1.0 / 12));
}

TEST_CASE("environment: the density of its samples is the one it tells") {
  Environment sky = constant_environment(Colour(0.4F));
  sky.zenith = {0.1F, 0.2F, 0.9F};
  set_sun(sky, 40, 20, 9, Colour(2));
  Random random(6, 0, 0);
  Statistics radiance, solid_angle, in_sun;
  for (int i = 0; i < 40000; ++i) {
    const EnvironmentSample s = sky.sample(random.uniform2());
    REQUIRE(s.pdf > 0);
    radiance.add(s.radiance.y / s.pdf);
    solid_angle.add(1 / s.pdf);
    in_sun.add(dot(s.direction, sky.to_sun) > std::cos(9 * kPi / 180) ? s.radiance.x / s.pdf : 0);
  }
  CHECK(solid_angle.agrees_with(4 * kPi));
  CHECK(radiance.agrees_with(4 * kPi * sky.mean_radiance().y));
  const double cap = 2 * kPi * sky.sun_height;
  CHECK(in_sun.mean() > cap * sky.sun.x);
  CHECK(in_sun.mean() < cap * (sky.sun.x + 0.4F));
}

TEST_CASE("camera: the middle of the image shows the target") {
  const Camera camera = {.eye = {1, 2, 3}, .target = {-2, 0, 1}};
  const Ray ray = camera.ray(32, 24, 64, 48, {});
  CHECK(dot(ray.direction, normalised(camera.target - camera.eye)) == Approx(1));
}

TEST_CASE("camera: rays of one point of the image meet in the plane of focus") {
  const Camera camera = {.eye = {0, 0, 5}, .target = {0, 0, 0}, .lens_radius = 0.5F, .focus_distance = 3};
  const auto at_focus = [&](Vec2 lens) {
    const Ray ray = camera.ray(10, 40, 64, 48, {.pixel = {0.25F, 0.5F}, .lens = lens});
    return ray.origin + ray.direction * ((2 - ray.origin.z) / ray.direction.z);
  };
  const Vec3 expected = at_focus({0.5F, 0.5F});
  CHECK(expected.x < -0.5F);  // left and below
  CHECK(expected.y < -0.5F);
  for (const Vec2 lens : {Vec2{0, 0}, Vec2{0.1F, 0.9F}, Vec2{0.99F, 0.5F}}) {
    CHECK(length(at_focus(lens) - expected) < 1e-5F);
  }
}

TEST_CASE("meshes: turned shapes are closed and face outwards") {
  const Vec2 profile[] = {{0, 0}, {1, 0}, {1, 2}, {0, 2}};
  const Vec3 path[] = {{0, 0, 0}, {0, 2, 0}, {1, 4, 0}};
  const float radii[] = {1, 1, 1};
  for (const Mesh& mesh : {lathe(profile, 32), tube(path, radii, 24), block({1, 2, 3}, {1, 2, 3}, 30)}) {
    double volume = 0;
    for (const auto& f : mesh.faces) {
      volume += dot(mesh.positions[f[0]], cross(mesh.positions[f[1]], mesh.positions[f[2]])) / 6;
      if (mesh.normals.empty()) continue;
      const Vec3 normal =
          cross(mesh.positions[f[1]] - mesh.positions[f[0]], mesh.positions[f[2]] - mesh.positions[f[0]]);
      for (const auto corner : f) REQUIRE(dot(mesh.normals[corner], normal) >= -1e-3F * length(normal));
    }
    CHECK(volume > 3);
  }
}

TEST_CASE("textures: squares, pixels, and their repetition") {
  const Texture checker({Colour(1), Colour(0)}, 2);
  CHECK(checker.at({0.1F, 0.1F}) == Colour(1));
  CHECK(checker.at({0.6F, 0.1F}) == Colour(0));
  CHECK(checker.at({-0.1F, 0.1F}) == Colour(0));
  const auto image = std::make_shared<const Image>(Image{2, 1, {Colour(0), Colour(1)}});
  CHECK(image->at({0.25F, 0}).x == Approx(0));
  CHECK(image->at({0.5F, 0.7F}).x == Approx(0.5));
  CHECK(image->at({1.75F, -3}).x == Approx(1));
  CHECK(Texture(image, 2).at({0.375F, 0}).x == Approx(1));
}
