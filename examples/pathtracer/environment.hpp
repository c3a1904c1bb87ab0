// SPDX-License-Identifier: Apache-2.0
//
// Light from infinitely far away: a sky between two colours, ground below, and a sun.
#pragma once

#include "vec3.hpp"

namespace pathtracer {

struct EnvironmentSample {
  Vec3 direction;
  Colour radiance;
  float pdf = 0;  ///< per solid angle
};

struct Environment {
  Colour zenith;
  Colour horizon;
  Colour ground;
  Vec3 to_sun = Vec3(0, 1, 0);  ///< unit length
  float sun_height = 0;         ///< 1 - cosine of the sun's half angle; 0: no sun
  Colour sun;                   ///< radiance, on top of the sky's

  [[nodiscard]] bool is_black() const;
  [[nodiscard]] Colour radiance(Vec3 direction) const;
  [[nodiscard]] Colour mean_radiance() const;  ///< over the sphere

  [[nodiscard]] EnvironmentSample sample(Vec2 u) const;
  [[nodiscard]] float pdf(Vec3 direction) const;

 private:
  [[nodiscard]] Colour sky(Vec3 direction) const;
  [[nodiscard]] bool in_sun(Vec3 direction) const;
  [[nodiscard]] float sun_probability() const;
};

[[nodiscard]] inline Environment constant_environment(Colour colour) {
  Environment environment;
  environment.zenith = environment.horizon = environment.ground = colour;
  return environment;
}

/// A sun from an elevation and an azimuth (0: from +z, 90: from +x) that alone lights a surface facing it with
/// `irradiance`.
void set_sun(Environment& environment, float elevation_degrees, float azimuth_degrees, float half_angle_degrees,
             Colour irradiance);

}  // namespace pathtracer
