// SPDX-License-Identifier: Apache-2.0
#include "scenes/scenes.hpp"

namespace pathtracer {
namespace {

constexpr float kSpacing = 1.6F;
constexpr int kColumns = 7;  // of a row
constexpr float kLength = kSpacing * kColumns;

void add_column(Geometry& shapes, Vec3 base, const Material& stone) {
  const Vec2 shaft[] = {{0.30F, 0.16F}, {0.27F, 0.20F}, {0.24F, 0.26F}, {0.235F, 1.0F},
                        {0.21F, 2.05F}, {0.22F, 2.12F}, {0.29F, 2.2F},  {0.29F, 2.22F}};
  shapes.add(placed(lathe(shaft, 48), base), stone);
  shapes.add(block(base, {0.66F, 0.16F, 0.66F}, 0), stone);
  shapes.add(block(base + Vec3(0, 2.2F, 0), {0.62F, 0.12F, 0.62F}, 0), stone);
}

}  // namespace

// A hall along -z: a brick wall to the left, columns and the open to the right, from where the sun comes in.
Scene colonnade() {
  Geometry shapes;
  const Material stone = diffuse({marble_image({0.72F, 0.66F, 0.56F}, {0.42F, 0.36F, 0.29F}), 1});
  const Material bricks = diffuse({brick_image(), 1});
  shapes.add(quad({-1.7F, 0, 1.5F}, {4.5F, 0, 0}, {0, 0, -4.5F}), coated({stone_tiles_image(), 1.5F}, 0.35F));
  for (int i = 1; i < 4; ++i) {
    const float z = 1.5F - 4.5F * static_cast<float>(i);
    shapes.add(quad({-1.7F, 0, z}, {4.5F, 0, 0}, {0, 0, -4.5F}), coated({stone_tiles_image(), 1.5F}, 0.35F));
  }
  for (int i = 0; i < 5; ++i) {
    shapes.add(quad({-1.6F, 0, 1.5F - 3 * static_cast<float>(i)}, {0, 0, -3}, {0, 3, 0}), bricks);
  }
  shapes.add(quad({-1.7F, 0, -kLength - 1}, {4.5F, 0, 0}, {0, 4.5F, 0}), stone);
  for (int i = 0; i < kColumns; ++i) {
    const float z = 0.4F - kSpacing * static_cast<float>(i);
    add_column(shapes, {1.3F, 0, z}, stone);
    shapes.add(block({-1.55F, 0, z}, {0.25F, 2.32F, 0.45F}, 0), stone);
  }
  shapes.add(block({1.3F, 2.32F, -kLength / 2 + 1}, {0.7F, 0.4F, kLength + 3}, 0), stone);
  shapes.add(block({0, 2.72F, -kLength / 2 + 1}, {3.6F, 0.2F, kLength + 3}, 0), diffuse(Colour(0.62F, 0.55F, 0.46F)));
  shapes.add(placed(floor_square(120), {0, -0.02F, 0}), diffuse(Colour(0.34F, 0.36F, 0.20F)));
  Environment sky;
  sky.zenith = {0.35F, 0.55F, 1.0F};
  sky.horizon = {0.85F, 0.95F, 1.10F};
  sky.ground = {0.72F, 0.72F, 0.42F};  // about what the lawn sends back
  set_sun(sky, 33, 62, 1.2F, {9, 8, 6.2F});
  return {std::move(shapes), sky, {.eye = {-0.45F, 1.25F, 1.9F}, .target = {0.25F, 1.22F, -3}, .height_degrees = 52}};
}

}  // namespace pathtracer
