// SPDX-License-Identifier: Apache-2.0
#include "environment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sampling.hpp"

namespace pathtracer {
namespace {

constexpr float kSphere = 4 * kPi;

float radians(float degrees) { return degrees * kPi / 180; }

}  // namespace

bool Environment::is_black() const { return mean_radiance() == Colour(); }

Colour Environment::sky(Vec3 direction) const {
  if (direction.y < 0) return ground;
  return lerp(horizon, zenith, std::sqrt(direction.y));
}

// |a - b|^2 = 2 (1 - cos) without the cancellation.
bool Environment::in_sun(Vec3 direction) const {
  const Vec3 apart = direction - to_sun;
  return dot(apart, apart) < 2 * sun_height;
}

Colour Environment::radiance(Vec3 direction) const { return in_sun(direction) ? sky(direction) + sun : sky(direction); }

// The mean of sqrt(y) over the upper half is 2/3.
Colour Environment::mean_radiance() const {
  return (ground + lerp(horizon, zenith, 2.0F / 3)) * 0.5F + sun * (sun_height / 2);
}

float Environment::sun_probability() const {
  return sun_height > 0 ? mean(sun * (sun_height / 2)) / mean(mean_radiance()) : 0.0F;
}

EnvironmentSample Environment::sample(Vec2 u) const {
  const float probability = sun_probability();
  EnvironmentSample sample;
  if (u.x < probability) {
    sample.direction = Basis(to_sun).to_world(uniform_cone({u.x / probability, u.y}, sun_height));
  } else {
    sample.direction = uniform_cone({(u.x - probability) / (1 - probability), u.y}, 2);
    std::swap(sample.direction.y, sample.direction.z);
  }
  sample.radiance = radiance(sample.direction);
  sample.pdf = pdf(sample.direction);
  return sample;
}

float Environment::pdf(Vec3 direction) const {
  const float probability = sun_probability();
  const float in_sky = (1 - probability) / kSphere;
  return in_sun(direction) ? in_sky + probability * uniform_cone_pdf(sun_height) : in_sky;
}

void set_sun(Environment& environment, float elevation_degrees, float azimuth_degrees, float half_angle_degrees,
             Colour irradiance) {
  const float up = radians(elevation_degrees);
  const float around = radians(azimuth_degrees);
  environment.to_sun = {std::cos(up) * std::sin(around), std::sin(up), std::cos(up) * std::cos(around)};
  const float half_sine = std::sin(radians(half_angle_degrees) / 2);
  const float sine = std::sin(radians(half_angle_degrees));
  environment.sun_height = 2 * half_sine * half_sine;
  environment.sun = irradiance / (kPi * sine * sine);
}

}  // namespace pathtracer
