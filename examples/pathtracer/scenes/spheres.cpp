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
  shapes.add({0.15F, 0.6F, -1.6F}, 0.6F, mirror(Colour(0.9F)));
  shapes.add({-3.6F, 4.4F, 1.0F}, 0.8F, lamp({30, 26, 20}));
  Environment sky;
  sky.zenith = {0.10F, 0.15F, 0.26F};
  sky.horizon = {0.26F, 0.28F, 0.32F};
  sky.ground = {0.24F, 0.26F, 0.28F};
  return {std::move(shapes), sky, {.eye = {0.3F, 3, 5.3F}, .target = {0.1F, 0.42F, 0}, .height_degrees = 33}};
}

}  // namespace pathtracer
