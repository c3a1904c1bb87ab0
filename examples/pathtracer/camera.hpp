// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sampling.hpp"
#include "shapes.hpp"
#include "vec3.hpp"

namespace pathtracer {

/// What chooses one ray of the camera; all in [0, 1).
struct CameraSample {
  Vec2 pixel;  ///< position within the pixel
  Vec2 lens;
  float time = 0;
};

/// A thin lens. The shutter is open from time 0 to 1.
struct Camera {
  Vec3 eye;
  Vec3 target;
  float height_degrees = 40;  ///< vertical angle of view
  float lens_radius = 0;      ///< 0: everything is sharp
  float focus_distance = 1;   ///< of the plane that is sharp, along the view; only matters with a lens

  /// (x, y) in pixels from the upper left corner of an image of that size.
  [[nodiscard]] Ray ray(int x, int y, int width, int height, const CameraSample& u) const {
    const Vec3 forward = normalised(target - eye);
    const Vec3 right = normalised(cross(forward, Vec3(0, 1, 0)));
    const Vec3 up = cross(right, forward);
    const float pixel_size = 2 * std::tan(height_degrees * kPi / 360) / static_cast<float>(height);
    const float across = (static_cast<float>(x) + u.pixel.x - 0.5F * static_cast<float>(width)) * pixel_size;
    const float down = (static_cast<float>(y) + u.pixel.y - 0.5F * static_cast<float>(height)) * pixel_size;
    const Vec3 in_focus = (forward + right * across - up * down) * focus_distance;
    const Vec2 disc = uniform_disc(u.lens);
    const Vec3 on_lens = (right * disc.x + up * disc.y) * lens_radius;
    return {eye + on_lens, normalised(in_focus - on_lens), u.time};
  }
};

}  // namespace pathtracer
