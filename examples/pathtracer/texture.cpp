// SPDX-License-Identifier: Apache-2.0
#include "texture.hpp"

#include <cstddef>
#include <cstdint>
#include <utility>

namespace pathtracer {
namespace {

int wrap(int i, int period) {
  const int r = i % period;
  return r < 0 ? r + period : r;
}

float smooth(float t) { return t * t * (3 - 2 * t); }

// A fixed pseudo-random number in [0, 1) for a lattice point.
float lattice(int x, int y) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8DA6B343U ^ static_cast<std::uint32_t>(y) * 0xD8163841U;
  h = (h ^ (h >> 15U)) * 0x2C1B3C6DU;
  h = (h ^ (h >> 12U)) * 0x297A2D39U;
  return static_cast<float>((h ^ (h >> 15U)) >> 8U) * 0x1p-24F;
}

float noise_octave(float x, float y, int period) {
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const float tx = smooth(x - static_cast<float>(x0));
  const float ty = smooth(y - static_cast<float>(y0));
  const auto corner = [&](int dx, int dy) { return lattice(wrap(x0 + dx, period), wrap(y0 + dy, period)); };
  const float top = corner(0, 0) * (1 - tx) + corner(1, 0) * tx;
  const float bottom = corner(0, 1) * (1 - tx) + corner(1, 1) * tx;
  return top * (1 - ty) + bottom * ty;
}

// In [0, 1], with a period of `period` lattice cells in both directions; each octave adds a finer copy.
float tileable_noise(float x, float y, int period, int octaves) {
  float sum = 0;
  float weight = 0.5F;
  float total = 0;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * noise_octave(x, y, period);
    total += weight;
    x *= 2;
    y *= 2;
    period *= 2;
    weight /= 2;
  }
  return sum / total;
}

template <class Paint>
std::shared_ptr<const Image> painted(int size, Paint paint) {
  auto image = std::make_shared<Image>(Image{size, size, {}});
  image->pixels.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const auto at = [size](int i) { return (static_cast<float>(i) + 0.5F) / static_cast<float>(size); };
      image->pixels.push_back(paint(at(x), at(y)));
    }
  }
  return image;
}

// Bricks or tiles: the number of the cell, and how far the point is from the cell's edge, in cells.
struct Cell {
  int column = 0;
  int row = 0;
  float edge = 0;
};

Cell find_cell(float u, float v, int columns, int rows, float shift) {
  const float y = v * static_cast<float>(rows);
  const int row = static_cast<int>(y);
  const float x = u * static_cast<float>(columns) + (row % 2 != 0 ? shift : 0);
  const int column = static_cast<int>(x);
  const float fx = x - static_cast<float>(column);
  const float fy = y - static_cast<float>(row);
  const float aspect = static_cast<float>(rows) / static_cast<float>(columns);
  return {column % columns, row, std::min(std::min(fx, 1 - fx) * aspect, std::min(fy, 1 - fy))};
}

}  // namespace

Colour Image::at(Vec2 uv) const {
  const float x = uv.x * static_cast<float>(width) - 0.5F;
  const float y = uv.y * static_cast<float>(height) - 0.5F;
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const auto pixel = [&](int px, int py) {
    return pixels[static_cast<std::size_t>(wrap(py, height)) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(wrap(px, width))];
  };
  const float tx = x - static_cast<float>(x0);
  return lerp(lerp(pixel(x0, y0), pixel(x0 + 1, y0), tx), lerp(pixel(x0, y0 + 1), pixel(x0 + 1, y0 + 1), tx),
              y - static_cast<float>(y0));
}

Colour Texture::at(Vec2 uv) const {
  if (const auto* colour = std::get_if<Colour>(&pattern_)) return *colour;
  const Vec2 scaled = {uv.x * scale_, uv.y * scale_};
  if (const auto* checker = std::get_if<Checker>(&pattern_)) {
    const int square = static_cast<int>(std::floor(scaled.x)) + static_cast<int>(std::floor(scaled.y));
    return wrap(square, 2) == 0 ? checker->even : checker->odd;
  }
  return std::get<std::shared_ptr<const Image>>(pattern_)->at(scaled);
}

std::shared_ptr<const Image> wood_image() {
  constexpr int kPlanks = 6;
  return painted(512, [](float u, float v) {
    const Cell plank = find_cell(u, v, 1, kPlanks, 0.37F);
    const float tone = lattice(plank.row, 7);
    const float bend = tileable_noise(u * 4, v * 24 + tone * 8, 64, 3);
    const float grain = 0.5F + 0.5F * std::sin(2 * kPi * (8 * bend + 3 * tone));
    const float fibre = tileable_noise(u * 8, v * 256, 256, 2);
    const Colour wood = lerp(Colour(0.30F, 0.15F, 0.065F), Colour(0.52F, 0.30F, 0.14F), 0.6F * grain + 0.4F * fibre);
    return wood * (0.75F + 0.4F * tone) * (plank.edge < 0.02F ? 0.35F : 1.0F);
  });
}

std::shared_ptr<const Image> stone_tiles_image() {
  return painted(512, [](float u, float v) {
    const Cell tile = find_cell(u, v, 4, 4, 0);
    const float tone = lattice(tile.column, tile.row + 11);
    const float cloud = tileable_noise(u * 16, v * 16, 16, 4);
    const bool is_dark = (tile.column + tile.row) % 2 != 0;
    const Colour stone = is_dark ? Colour(0.30F, 0.22F, 0.17F) : Colour(0.66F, 0.60F, 0.50F);
    return stone * (0.7F + 0.2F * tone + 0.3F * cloud) * (tile.edge < 0.025F ? 0.45F : 1.0F);
  });
}

std::shared_ptr<const Image> marble_image(Colour light, Colour vein) {
  return painted(512, [=](float u, float v) {
    const float bend = tileable_noise(u * 8, v * 8, 8, 5);
    const float wave = std::abs(std::sin(kPi * (3 * u + 2 * v + 3 * bend)));
    const float speck = tileable_noise(u * 32, v * 32, 32, 3);
    return lerp(vein, light, std::min(1.0F, 0.25F + 0.9F * std::sqrt(wave))) * (0.85F + 0.15F * speck);
  });
}

std::shared_ptr<const Image> brick_image() {
  return painted(512, [](float u, float v) {
    const Cell brick = find_cell(u, v, 4, 10, 0.5F);
    const float tone = lattice(brick.column + 3, brick.row);
    const float grit = tileable_noise(u * 32, v * 32, 32, 3);
    if (brick.edge < 0.06F) return Colour(0.55F, 0.52F, 0.47F) * (0.7F + 0.3F * grit);
    return lerp(Colour(0.45F, 0.17F, 0.10F), Colour(0.62F, 0.30F, 0.18F), tone) * (0.65F + 0.5F * grit);
  });
}

}  // namespace pathtracer
