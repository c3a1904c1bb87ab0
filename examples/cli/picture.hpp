// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stein::cli {

/// 8 bits per channel, sRGB-encoded. The layout of PNG rows.
struct Pixel {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
};
static_assert(sizeof(Pixel) == 3);

inline constexpr Pixel kWhite{255, 255, 255};
inline constexpr Pixel kNonFinite{255, 0, 255};  ///< magenta

class Picture {
 public:
  Picture(int width, int height)
      : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] const Pixel* data() const noexcept { return pixels_.data(); }
  [[nodiscard]] Pixel& at(int x, int y) noexcept {
    return pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
  }

 private:
  int width_;
  int height_;
  std::vector<Pixel> pixels_;
};

}  // namespace stein::cli
