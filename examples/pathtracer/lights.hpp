// SPDX-License-Identifier: Apache-2.0
//
// Choosing points on lights: emitting triangles and spheres, and the environment.
#pragma once

#include <cstdint>
#include <vector>

#include "environment.hpp"
#include "geometry.hpp"

namespace pathtracer {

struct LightSample {
  Vec3 direction;
  float distance = kInfinity;
  Colour radiance;
  float pdf = 0;  ///< per solid angle, the choice of the light included; 0: this light does not reach the point
  std::uint32_t shape = kNoShape;  ///< of the light
};

class Lights {
 public:
  Lights() = default;
  /// Lists the emitting shapes of `geometry` and numbers them there. Both must outlive this.
  Lights(Geometry& geometry, const Environment& environment);

  /// A direction towards a light: lamps are chosen by power, the environment half of the time. One number of `u` serves
  /// for the choice as well.
  [[nodiscard]] LightSample sample(Vec3 from, float time, Vec2 u) const;

  /// The density of `sample` for a ray from `from` that met the light `point`.
  [[nodiscard]] float pdf(const SurfacePoint& point, Vec3 from, float time) const;
  /// The same for one that met nothing.
  [[nodiscard]] float environment_pdf(Vec3 direction) const;

 private:
  [[nodiscard]] std::size_t choose(float& u) const;
  [[nodiscard]] LightSample sample_triangle(const Triangle& t, Vec3 from, float time, Vec2 u) const;
  [[nodiscard]] LightSample sample_sphere(const Sphere& s, Vec3 from, float time, Vec2 u) const;
  [[nodiscard]] float probability(std::size_t light) const {
    return upper_[light] - (light > 0 ? upper_[light - 1] : 0);
  }

  const Geometry* geometry_ = nullptr;
  const Environment* environment_ = nullptr;
  std::vector<std::uint32_t> shapes_;  // the shape of each light; the environment, if it is one, comes after them
  std::vector<float> upper_;           // cumulated probabilities of lights and environment
};

}  // namespace pathtracer
