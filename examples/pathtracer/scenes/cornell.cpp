// SPDX-License-Identifier: Apache-2.0
#include "scenes/scenes.hpp"

namespace pathtracer {
namespace {

const Colour kWhite = {0.73F, 0.72F, 0.68F};
const Colour kRed = {0.62F, 0.07F, 0.05F};
const Colour kGreen = {0.12F, 0.46F, 0.10F};

constexpr float kHalfWidth = 1.34F;  // fills an image of 4:3

// Open towards the camera: y in [0, 2], z in [-1, 1]; the lamp hangs just below the ceiling.
Geometry empty_box(const Material& floor) {
  Geometry box;
  constexpr float kW = kHalfWidth;
  box.add(quad({-kW, 0, 1}, {2 * kW, 0, 0}, {0, 0, -2}), floor);
  box.add(quad({-kW, 2, -1}, {2 * kW, 0, 0}, {0, 0, 2}), diffuse(kWhite));
  box.add(quad({-kW, 0, -1}, {2 * kW, 0, 0}, {0, 2, 0}), diffuse(kWhite));
  box.add(quad({-kW, 0, 1}, {0, 0, -2}, {0, 2, 0}), diffuse(kRed));
  box.add(quad({kW, 0, -1}, {0, 0, 2}, {0, 2, 0}), diffuse(kGreen));
  box.add(quad({-0.6F, 1.995F, -0.55F}, {1.2F, 0, 0}, {0, 0, 1}), lamp({5, 4.1F, 2.9F}));
  return box;
}

Camera box_camera() { return {.eye = {0, 1, 3.9F}, .target = {0, 1, 0}, .height_degrees = 37.5F}; }

}  // namespace

Scene cornell() {
  Geometry box = empty_box(diffuse(kWhite));
  box.add(block({-0.55F, 0, -0.35F}, {0.58F, 1.2F, 0.58F}, 18), diffuse(kWhite));
  box.add(block({0.6F, 0, 0.05F}, {0.58F, 0.45F, 0.58F}, -18), coated(Colour(0.18F, 0.32F, 0.62F), 0.25F));
  box.add({0.6F, 0.76F, 0.05F}, 0.31F, metal({0.92F, 0.68F, 0.50F}, 0.35F));
  box.add({-0.42F, 0.28F, 0.5F}, 0.28F, glass(Colour(1)));
  return {std::move(box), {}, box_camera()};
}

Scene cornell_defocus() {
  Geometry box = empty_box(diffuse({stone_tiles_image(), 1}));
  const Colour colours[] = {
      {0.75F, 0.15F, 0.1F}, {0.8F, 0.5F, 0.1F}, {0.75F, 0.72F, 0.2F}, {0.2F, 0.55F, 0.25F}, {0.15F, 0.35F, 0.7F}};
  float z = 0.72F;
  float x = -0.88F;
  for (const Colour colour : colours) {
    box.add({x, 0.24F, z}, 0.24F, coated(colour, 0.2F));
    x += 0.36F;
    z -= 0.38F;
  }
  box.add(block({0.82F, 0, 0.3F}, {0.42F, 0.8F, 0.42F}, 30), diffuse({Checker{Colour(0.75F), Colour(0.08F)}, 6}));
  Camera camera = box_camera();
  camera.lens_radius = 0.12F;
  camera.focus_distance = 3.5F;
  return {std::move(box), {}, camera};
}

}  // namespace pathtracer
