// SPDX-License-Identifier: Apache-2.0
#include "scenes/scenes.hpp"

namespace pathtracer {
namespace {

constexpr int kSegments = 64;

// Centred on the origin, standing at height 0; the spout points to +x.
void add_teapot(Geometry& shapes, Vec3 position, float turn, const Material& glaze) {
  const Vec2 body[] = {{0, 0},         {0.42F, 0},     {0.47F, 0.03F}, {0.68F, 0.22F}, {0.76F, 0.45F},
                       {0.66F, 0.70F}, {0.44F, 0.85F}, {0.36F, 0.88F}, {0.33F, 0.87F}};
  const Vec2 lid[] = {{0.36F, 0.87F}, {0.36F, 0.89F}, {0.25F, 0.94F}, {0.08F, 0.98F},
                      {0.06F, 1.01F}, {0.11F, 1.06F}, {0.09F, 1.12F}, {0, 1.14F}};
  const Vec3 spout[] = {{0.60F, 0.30F, 0}, {0.86F, 0.36F, 0}, {0.98F, 0.58F, 0}, {1.12F, 0.82F, 0}, {1.22F, 0.86F, 0}};
  const float spout_radii[] = {0.20F, 0.15F, 0.10F, 0.08F, 0.085F};
  const Vec3 handle[] = {{-0.52F, 0.74F, 0}, {-0.80F, 0.84F, 0}, {-1.06F, 0.74F, 0},
                         {-1.04F, 0.46F, 0}, {-0.84F, 0.28F, 0}, {-0.62F, 0.24F, 0}};
  const float handle_radii[] = {0.05F, 0.055F, 0.06F, 0.06F, 0.055F, 0.05F};
  for (const Mesh& part :
       {lathe(body, kSegments), lathe(lid, kSegments), tube(spout, spout_radii, 24), tube(handle, handle_radii, 16)}) {
    shapes.add(placed(part, position, turn), glaze);
  }
}

void add_cup(Geometry& shapes, Vec3 position, float turn, const Material& glaze, const Material& tea) {
  const Vec2 saucer[] = {{0, 0},          {0.22F, 0},     {0.26F, 0.02F}, {0.46F, 0.07F},
                         {0.47F, 0.085F}, {0.26F, 0.04F}, {0, 0.035F}};
  const Vec2 cup[] = {{0, 0.04F},      {0.15F, 0.04F}, {0.17F, 0.07F}, {0.27F, 0.18F}, {0.31F, 0.38F},
                      {0.315F, 0.40F}, {0.30F, 0.39F}, {0.25F, 0.19F}, {0.14F, 0.09F}, {0, 0.08F}};
  const Vec2 surface[] = {{0, 0.31F}, {0.15F, 0.31F}, {0.28F, 0.31F}};
  const Vec3 handle[] = {{0.28F, 0.33F, 0}, {0.38F, 0.36F, 0}, {0.45F, 0.29F, 0}, {0.39F, 0.18F, 0}, {0.26F, 0.15F, 0}};
  const float radii[] = {0.022F, 0.025F, 0.025F, 0.025F, 0.022F};
  for (const Mesh& part : {lathe(saucer, kSegments), lathe(cup, kSegments), tube(handle, radii, 12)}) {
    shapes.add(placed(part, position, turn), glaze);
  }
  shapes.add(placed(lathe(surface, kSegments), position, turn), tea);
}

}  // namespace

Scene tea_table() {
  Geometry shapes;
  shapes.add(placed(floor_square(14), {0, 0, 0}, 24), coated({wood_image(), 3}, 0.28F));
  const auto marble = marble_image({0.06F, 0.20F, 0.42F}, {0.80F, 0.82F, 0.80F});
  const Material blue = coated({marble, 2}, 0.12F);
  const Material white = coated(Colour(0.78F, 0.76F, 0.72F), 0.12F);
  const Material tea = coated(Colour(0.22F, 0.07F, 0.015F), 0.06F);
  add_teapot(shapes, {-0.25F, 0, -0.35F}, 205, blue);
  add_cup(shapes, {0.95F, 0, 0.35F}, -40, white, tea);
  add_cup(shapes, {-0.75F, 0, 0.95F}, 215, white, tea);
  const Vec2 bowl[] = {{0, 0},         {0.18F, 0},     {0.2F, 0.03F},  {0.36F, 0.2F}, {0.42F, 0.32F},
                       {0.41F, 0.33F}, {0.33F, 0.21F}, {0.17F, 0.06F}, {0, 0.05F}};
  shapes.add(placed(lathe(bowl, kSegments), {1.15F, 0, -0.75F}), metal({0.93F, 0.72F, 0.45F}, 0.28F));
  for (const Vec3 sugar : {Vec3(1.08F, 0.06F, -0.72F), Vec3(1.24F, 0.06F, -0.83F), Vec3(1.16F, 0.19F, -0.74F)}) {
    shapes.add(block(sugar, Vec3(0.14F), 100 * sugar.x), diffuse(Colour(0.85F)));
  }
  shapes.add(quad({-12, -2, -4.5F}, {24, 0, 0}, {0, 8, 0}), diffuse(Colour(0.30F, 0.36F, 0.34F)));
  // A tall window to the left, a lamp to the right, and a dim room around.
  shapes.add(quad({-4.2F, 0.6F, 1.6F}, {0, 0, -3.2F}, {0, 3.2F, 0}), lamp({9, 9.6F, 10.5F}));
  shapes.add(quad({3.5F, 3.5F, 2.5F}, {-0.8F, 0, 0}, {0, 0, -0.8F}), lamp({20, 14, 8}));
  Environment room;
  room.zenith = {0.16F, 0.14F, 0.12F};
  room.horizon = {0.26F, 0.23F, 0.20F};
  return {std::move(shapes),
          room,
          {.eye = {0.5F, 2.5F, 4.3F},
           .target = {0.12F, 0.38F, 0},
           .height_degrees = 32,
           .lens_radius = 0.03F,
           .focus_distance = 4.6F}};
}

}  // namespace pathtracer
