// SPDX-License-Identifier: Apache-2.0
#include "material.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "catch.hpp"
#include "ggx.hpp"
#include "random.hpp"
#include "sampling.hpp"
#include "scenes/scenes.hpp"
#include "support/statistics.hpp"

using namespace pathtracer;

namespace {

SurfacePoint facing_up(const Material& material) {
  SurfacePoint point;
  point.normal = point.geometric_normal = {0, 1, 0};
  point.material = &material;
  return point;
}

Vec3 tilted(float cosine) { return {std::sqrt(1 - cosine * cosine), cosine, 0}; }

// f(direction, solid angle) over the upper half of the directions. With z = 1 - t^2 there are most points where lobes
// are.
template <class Function>
void for_directions(int steps, Function f) {
  for (int i = 0; i < steps; ++i) {
    const double t = (i + 0.5) / steps;
    const double z = 1 - t * t;
    const double radius = std::sqrt(1 - z * z);
    for (int k = 0; k < steps; ++k) {
      const double angle = 2 * kPi * (k + 0.5) / steps;
      f(Vec3(static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)),
             static_cast<float>(z)),
        4 * kPi * t / (static_cast<double>(steps) * steps));
    }
  }
}

template <class Function>
double integral(int steps, Function f) {
  double sum = 0;
  for_directions(steps, [&](Vec3 direction, double solid_angle) { sum += f(direction) * solid_angle; });
  return sum;
}

Vec3 y_up(Vec3 a) { return {a.x, a.z, a.y}; }

}  // namespace

TEST_CASE("GGX: projected areas of the microfacets add up") {
  const float alpha = GENERATE(0.1F, 0.3F, 1.0F);
  CHECK(integral(600, [&](Vec3 h) { return ggx::distribution(h, alpha) * h.z; }) == Approx(1).epsilon(1e-3));
  for (const float cosine : {1.0F, 0.6F, 0.15F}) {
    const Vec3 v = {std::sqrt(1 - cosine * cosine), 0, cosine};
    const auto visible = [&](Vec3 h) {
      return ggx::masking(v, alpha) * ggx::distribution(h, alpha) * std::max(0.0F, dot(v, h));
    };
    CHECK(integral(600, visible) == Approx(cosine).epsilon(3e-3));
  }
}

TEST_CASE("GGX: visible microfacets are drawn with their density") {
  constexpr int kCells = 12;
  constexpr int kCount = 40000;
  const float alpha = GENERATE(0.2F, 0.7F);
  const float cosine = GENERATE(0.95F, 0.3F);
  const Vec3 v = {std::sqrt(1 - cosine * cosine), 0, cosine};
  const auto cell = [](Vec3 h) {  // of the normal's projection onto the plane
    const auto part = [](float a) { return std::min(kCells - 1, static_cast<int>((a + 1) / 2 * kCells)); };
    return static_cast<std::size_t>(part(h.y) * kCells + part(h.x));
  };
  std::vector<double> expected(kCells * kCells);
  double total = 0;
  for_directions(800, [&](Vec3 h, double solid_angle) {
    const double facing = std::max(0.0F, dot(v, h)) / v.z;
    const double part = ggx::masking(v, alpha) * ggx::distribution(h, alpha) * facing * solid_angle;
    expected[cell(h)] += part;
    total += part;
  });
  CHECK(total == Approx(1).epsilon(1e-3));
  std::vector<int> drawn(expected.size());
  Random random(1, 0, 0);
  for (int i = 0; i < kCount; ++i) ++drawn[cell(ggx::sample_visible(v, alpha, random.uniform2()))];
  double chi2 = 0;
  double freedom = -1;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double n = expected[i] * kCount;
    if (n < 10) continue;
    chi2 += (drawn[i] - n) * (drawn[i] - n) / n;
    ++freedom;
  }
  CHECK(freedom > 5);
  CHECK(chi2 < freedom + 4 * std::sqrt(2 * freedom) + 0.01 * freedom);
}

TEST_CASE("materials: samples, densities and values belong together") {
  const Material material = GENERATE(diffuse(Colour(0.8F)), coated(Colour(0.5F), 0.4F), metal(Colour(0.9F), 0.6F));
  for (const float cosine : {0.95F, 0.5F, 0.2F}) {
    const SurfacePoint point = facing_up(material);
    const Bsdf bsdf(point, tilted(cosine));
    Random random(2, 0, 0);
    Statistics scattered, above;
    for (int i = 0; i < 20000; ++i) {
      const Scattered s = bsdf.sample(random);
      scattered.add(s.weight.y);
      above.add(s.pdf > 0 ? 1 : 0);
      if (s.weight == Colour()) continue;
      REQUIRE(s.pdf == Approx(bsdf.pdf(s.direction)));
      REQUIRE(s.weight.x * s.pdf == Approx(bsdf.value_cosine(s.direction).x).epsilon(1e-4));
    }
    CHECK(scattered.mean() == Approx(integral(400, [&](Vec3 d) {
                                return bsdf.value_cosine(y_up(d)).y;
                              })).margin(4 * scattered.standard_error() + 2e-3));
    CHECK(above.mean() ==
          Approx(integral(400, [&](Vec3 d) { return bsdf.pdf(y_up(d)); })).margin(4 * above.standard_error() + 2e-3));
    CHECK(bsdf.pdf({0, -1, 0}) == 0);
    CHECK(bsdf.value_cosine({0, -1, 0}) == Colour());
  }
}

TEST_CASE("GGX: a white surface of full roughness reflects 1 - ln 2 of what comes from the front") {
  const Material material = metal(Colour(1), 1);
  const SurfacePoint point = facing_up(material);
  const Bsdf bsdf(point, {0, 1, 0});
  CHECK(integral(400, [&](Vec3 d) { return bsdf.value_cosine(y_up(d)).x; }) == Approx(1 - std::log(2)).epsilon(1e-3));
}

TEST_CASE("materials: light may go either way") {
  const Material material = GENERATE(diffuse(Colour(0.8F)), coated(Colour(0.5F), 0.4F), metal(Colour(0.9F), 0.3F));
  const SurfacePoint point = facing_up(material);
  Random random(3, 0, 0);
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = y_up(cosine_hemisphere(random.uniform2()));
    const Vec3 b = y_up(cosine_hemisphere(random.uniform2()));
    CHECK(Bsdf(point, a).value_cosine(b).x / b.y == Approx(Bsdf(point, b).value_cosine(a).x / a.y).epsilon(1e-3));
  }
}

TEST_CASE("materials: no surface sends out more than it gets") {
  const float roughness = GENERATE(0.05F, 0.2F, 0.5F, 1.0F);
  const float front = GENERATE(0.02F, 0.04F, 0.3F, 1.0F);
  const Material material = coated(Colour(1), roughness, Colour(front));
  for (const float cosine : {1.0F, 0.7F, 0.3F, 0.05F}) {
    const SurfacePoint point = facing_up(material);
    const Bsdf bsdf(point, tilted(cosine));
    Random random(4, 0, 0);
    Statistics scattered;
    for (int i = 0; i < 10000; ++i) scattered.add(bsdf.sample(random).weight.x);
    INFO("roughness " << roughness << ", front " << front << ", cosine " << cosine);
    CHECK(scattered.mean() < 1 + 4 * scattered.standard_error() + 1e-4);
    CHECK(scattered.mean() > 0.2);
  }
}

TEST_CASE("materials: white mirrors and glass lose nothing") {
  const Material material = GENERATE(mirror(Colour(1)), glass(Colour(1)));
  Random random(5, 0, 0);
  for (const Vec3 viewer : {tilted(0.9F), tilted(0.1F), -tilted(0.8F), -tilted(0.2F)}) {
    const SurfacePoint point = facing_up(material);
    const Bsdf bsdf(point, viewer);
    for (int i = 0; i < 20; ++i) {
      const Scattered s = bsdf.sample(random);
      CHECK(s.weight == Colour(1));
      CHECK(length(s.direction) == Approx(1).epsilon(1e-4));
    }
  }
}

TEST_CASE("glass: Fresnel's and Snell's laws") {
  CHECK(dielectric_reflectance(1, 1 / 1.5F) == Approx(0.04));
  CHECK(dielectric_reflectance(1, 1.5F) == Approx(0.04));
  CHECK(dielectric_reflectance(0.0001F, 1 / 1.5F) == Approx(1).epsilon(1e-3));
  CHECK(dielectric_reflectance(0.5F, 1.5F) == 1);  // beyond the critical angle
  const float brewster = std::cos(std::atan(1.5F));
  const float p = (1.5F * 1.5F - 1) / (1.5F * 1.5F + 1);
  CHECK(dielectric_reflectance(brewster, 1 / 1.5F) == Approx(p * p / 2));

  const Material material = glass(Colour(1));
  const SurfacePoint point = facing_up(material);
  const Vec3 viewer = tilted(0.6F);
  Random random(6, 0, 0);
  Statistics reflected;
  for (int i = 0; i < 10000; ++i) {
    const Vec3 d = Bsdf(point, viewer).sample(random).direction;
    reflected.add(d.y > 0 ? 1 : 0);
    REQUIRE(d.x == Approx(d.y > 0 ? -0.8 : -0.8 / 1.5).epsilon(1e-4));
  }
  CHECK(reflected.agrees_with(dielectric_reflectance(0.6F, 1 / 1.5F)));
}

TEST_CASE("materials: an interpolated normal that faces away is not used") {
  const Material material = diffuse(Colour(1));
  SurfacePoint point = facing_up(material);
  point.normal = normalised({1, 0.2F, 0});
  const Bsdf bsdf(point, normalised({-1, 0.1F, 0}));
  CHECK(bsdf.normal() == Vec3(0, 1, 0));
  CHECK(Bsdf(point, {0, 1, 0}).value_cosine(normalised({1, -0.1F, 0})) == Colour());  // below the true surface
}
