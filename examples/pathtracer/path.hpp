// SPDX-License-Identifier: Apache-2.0
//
// One light path, from the camera to the lights.
#pragma once

#include "random.hpp"
#include "scene.hpp"

namespace pathtracer {

/// How light that comes straight from a light is found. All agree on average.
enum class DirectLight {
  kBoth,       ///< points on lights and scattered rays, weighted by which is likely to be better (Veach 1997)
  kLights,     ///< points on lights only
  kScattered,  ///< scattered rays that happen to meet a light
};

struct PathSettings {
  int max_bounces = 32;
  DirectLight direct_light = DirectLight::kBoth;
};

/// One sample of a pixel. Features are of the first surface that is neither mirror nor glass; all 0 if there is none.
struct PathSample {
  Colour colour;
  Colour albedo;         ///< tinted by the mirrors and glass before it; 0 on lamps
  Vec3 normal;           ///< in world space, facing the viewer
  float depth = 0;       ///< length of the path from the camera
  Vec3 position;         ///< in world space
  float visibility = 0;  ///< 1 if the point chosen on a light is seen from there, else 0
  CameraSample camera;
  Vec2 light;      ///< the random numbers that chose the point on a light
  Vec3 position2;  ///< of the next surface
  Vec3 normal2;
};

[[nodiscard]] PathSample trace_path(const Scene& scene, const Ray& ray, Random& random,
                                    const PathSettings& settings = {});

}  // namespace pathtracer
