// SPDX-License-Identifier: Apache-2.0
//
// The scenes that the program knows; docs/pathtracer.md shows them.
#pragma once

#include "scene.hpp"

namespace pathtracer {

[[nodiscard]] Scene cornell();
[[nodiscard]] Scene cornell_defocus();
[[nodiscard]] Scene spheres();
[[nodiscard]] Scene tea_table();
[[nodiscard]] Scene motion();
[[nodiscard]] Scene colonnade();

// What several of them use.

[[nodiscard]] inline Material diffuse(Texture colour) { return {.colour = std::move(colour)}; }

[[nodiscard]] inline Material coated(Texture base, float roughness, Colour coat = Colour(0.04F)) {
  return {.surface = Surface::kGlossy, .colour = std::move(base), .specular = coat, .roughness = roughness};
}

[[nodiscard]] inline Material metal(Colour reflectance, float roughness) {
  return coated(Colour(), roughness, reflectance);
}

[[nodiscard]] inline Material mirror(Colour tint) { return {.surface = Surface::kMirror, .colour = tint}; }

[[nodiscard]] inline Material glass(Colour tint) { return {.surface = Surface::kGlass, .colour = tint}; }

/// Black but for the light that it sheds.
[[nodiscard]] inline Material lamp(Colour radiance) { return {.colour = Colour(), .emission = radiance}; }

/// A square floor around the origin, at height 0.
[[nodiscard]] inline Mesh floor_square(float side) {
  return quad({-side / 2, 0, side / 2}, {side, 0, 0}, {0, 0, -side});
}

}  // namespace pathtracer
