// SPDX-License-Identifier: Apache-2.0
#include "scenes/scenes.hpp"

namespace pathtracer {
namespace {

constexpr float kRadius = 0.3F;

void add_ball(Geometry& shapes, Vec2 place, Colour colour, Vec2 way = {}) {
  shapes.add({place.x, kRadius, place.y}, kRadius, coated(colour, 0.1F), {way.x, 0, way.y});
}

}  // namespace

Scene motion() {
  Geometry shapes;
  const auto marble = marble_image({0.10F, 0.36F, 0.20F}, {0.05F, 0.20F, 0.11F});
  shapes.add(quad({-3.4F, 0, 6}, {9.4F, 0, 0}, {0, 0, -8.5F}), diffuse({marble, 4}));
  shapes.add(placed(floor_square(40), {0, -0.9F, 0}), diffuse({stone_tiles_image(), 6}));
  const Material rail = coated({wood_image(), 1}, 0.25F);
  shapes.add(block({0, 0, -2.5F}, {9, 0.42F, 0.5F}, 0), rail);
  shapes.add(block({-3.4F, 0, 0}, {0.5F, 0.42F, 9}, 0), rail);
  add_ball(shapes, {-1.7F, 0.9F}, Colour(0.82F, 0.80F, 0.72F), {0.9F, -0.35F});
  add_ball(shapes, {-0.35F, -0.35F}, {0.75F, 0.10F, 0.06F}, {0.35F, -0.3F});
  add_ball(shapes, {0.75F, 0.5F}, {0.80F, 0.55F, 0.05F});
  add_ball(shapes, {1.35F, -0.75F}, {0.08F, 0.16F, 0.60F}, {0.6F, 0.1F});
  add_ball(shapes, {0.35F, -1.5F}, {0.30F, 0.08F, 0.38F});
  add_ball(shapes, {-1.9F, -1.2F}, {0.03F, 0.03F, 0.03F}, {-0.25F, -0.15F});
  add_ball(shapes, {1.75F, 1.15F}, {0.06F, 0.42F, 0.18F}, {-0.15F, 0.45F});
  for (const float x : {-2.0F, 1.2F}) {
    shapes.add(quad({x, 3.2F, -0.6F}, {1.2F, 0, 0}, {0, 0, 1.2F}), lamp({24, 21, 16}));
  }
  Environment room;
  room.zenith = {0.05F, 0.055F, 0.065F};
  room.horizon = {0.11F, 0.11F, 0.12F};
  return {std::move(shapes), room, {.eye = {0.2F, 3.1F, 4.9F}, .target = {0, 0.1F, -0.15F}, .height_degrees = 36}};
}

}  // namespace pathtracer
