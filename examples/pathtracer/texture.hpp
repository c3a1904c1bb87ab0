// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "vec3.hpp"

namespace pathtracer {

/// Two colours in squares, one square per unit of (u, v).
struct Checker {
  Colour even;
  Colour odd;
};

/// Pixels over [0, 1)^2, repeated beyond, interpolated bilinearly.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Colour> pixels;  ///< row-major

  [[nodiscard]] Colour at(Vec2 uv) const;
};

/// A colour at every (u, v) of a surface.
class Texture {
 public:
  Texture() = default;
  // NOLINTBEGIN(google-explicit-constructor): a colour is a texture
  Texture(Colour colour) : pattern_(colour) {}
  Texture(const Checker& checker, float scale) : pattern_(checker), scale_(scale) {}
  Texture(std::shared_ptr<const Image> image, float scale) : pattern_(std::move(image)), scale_(scale) {}
  // NOLINTEND(google-explicit-constructor)

  [[nodiscard]] Colour at(Vec2 uv) const;

 private:
  std::variant<Colour, Checker, std::shared_ptr<const Image>> pattern_;
  float scale_ = 1;  // repetitions per unit of (u, v)
};

/// Procedural images; all repeat without a seam.
[[nodiscard]] std::shared_ptr<const Image> wood_image();
[[nodiscard]] std::shared_ptr<const Image> stone_tiles_image();
[[nodiscard]] std::shared_ptr<const Image> marble_image(Colour light, Colour vein);
[[nodiscard]] std::shared_ptr<const Image> brick_image();

}  // namespace pathtracer
