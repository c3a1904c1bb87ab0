// SPDX-License-Identifier: Apache-2.0
#include "scenes/scenes.hpp"

namespace pathtracer {

Scene spheres() {
  Geometry shapes;
  shapes.add(floor_square(60), diffuse({Checker{{0.62F, 0.60F, 0.56F}, {0.40F, 0.39F, 0.37F}}, 40}));
  shapes.add({-1.15F, 0.75F, -0.5F}, 0.75F, diffuse(Colour(0.70F, 0.16F, 0.12F)));
  shapes.add({0.55F, 0.6F, 0.15F}, 0.6F, coated(Colour(0.12F, 0.28F, 0.66F), 0.15F));
  shapes.add({1.75F, 0.8F, -1.1F}, 0.8F, diffuse(Colour(0.75F, 0.62F, 0.20F)));
  shapes.add({-0.25F, 0.3F, 1.0F}, 0.3F, diffuse(Colour(0.20F, 0.55F, 0.22F)));
  shapes.add({1.45F, 0.35F, 0.75F}, 0.35F, metal(Colour(0.90F, 0.62F, 0.42F), 0.3F));
  shapes.add({-1.55F, 0.25F, 0.75F}, 0.25F, diffuse(Colour(0.6F, 0.55F, 0.75F)));
  shapes.add({0.1F, 0.5F, -1.6F}, 0.5F, diffuse(Colour(0.7F)));
  shapes.add({-2.6F, 4.2F, 2.2F}, 0.9F, lamp({15, 13.5F, 11}));
  Environment sky;
  sky.zenith = {0.16F, 0.24F, 0.42F};
  sky.horizon = {0.42F, 0.45F, 0.50F};
  sky.ground = {0.36F, 0.38F, 0.42F};
  return {std::move(shapes), sky, {.eye = {0.3F, 2.1F, 5.6F}, .target = {0.1F, 0.45F, 0}, .height_degrees = 33}};
}

}  // namespace pathtracer
