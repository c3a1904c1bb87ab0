// SPDX-License-Identifier: Apache-2.0
#include "scale_bar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string_view>

namespace stein::cli {
namespace {

constexpr int kGlyphWidth = 3;
constexpr int kGlyphHeight = 5;
constexpr int kGlyphScale = 2;
constexpr int kAdvance = (kGlyphWidth + 1) * kGlyphScale;
constexpr int kTextHeight = kGlyphHeight * kGlyphScale;
constexpr int kMargin = 8;
constexpr int kBarWidth = 16;
constexpr int kLabelWidth = 10 * kAdvance;  // the longest number: "-1.234e-05"
constexpr int kSideWidth = 4 * kMargin + kBarWidth + kLabelWidth;
constexpr int kMinHeight = 120;

// Each row of a glyph is an octal digit, the top row first; the highest bit is the left pixel.
constexpr std::string_view kCharacters = "0123456789.-+e";
constexpr std::array<int, kCharacters.size()> kGlyphs = {075557, 026227, 071747, 071717, 055711, 074717, 074757,
                                                         071111, 075757, 075717, 000002, 000700, 002720, 007743};

void fill(Picture& picture, int left, int top, int width, int height, Pixel colour) {
  for (int y = std::max(top, 0); y < std::min(top + height, picture.height()); ++y) {
    for (int x = std::max(left, 0); x < std::min(left + width, picture.width()); ++x) {
      picture.at(x, y) = colour;
    }
  }
}

void draw_glyph(Picture& picture, int left, int top, int rows) {
  for (int y = 0; y < kGlyphHeight; ++y) {
    for (int x = 0; x < kGlyphWidth; ++x) {
      const int bit = kGlyphWidth * (kGlyphHeight - 1 - y) + (kGlyphWidth - 1 - x);
      if (((rows >> bit) & 1) != 0) {
        fill(picture, left + x * kGlyphScale, top + y * kGlyphScale, kGlyphScale, kGlyphScale, kWhite);
      }
    }
  }
}

// A copy with a black strip at the right, and high enough for it.
Picture with_side_strip(Picture& picture) {
  Picture result(picture.width() + kSideWidth, std::max(picture.height(), kMinHeight));
  for (int y = 0; y < picture.height(); ++y) {
    std::copy_n(&picture.at(0, y), picture.width(), &result.at(0, y));
  }
  return result;
}

}  // namespace

void draw_number(Picture& picture, int x, int y, double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  for (const char c : std::string_view(text.data())) {
    const std::size_t glyph = kCharacters.find(c);
    if (glyph != std::string_view::npos) {
      draw_glyph(picture, x, y, kGlyphs[glyph]);
    }
    x += kAdvance;
  }
}

Picture with_scale_bar(Picture picture, ValueRange range) {
  constexpr int kTicks = 5;
  const int left = picture.width() + kMargin;
  Picture result = with_side_strip(picture);
  const int top = kMargin + kTextHeight / 2;
  const int height = result.height() - 2 * top;
  for (int y = 0; y < height; ++y) {
    fill(result, left, top + y, kBarWidth, 1, false_colour(1 - static_cast<double>(y) / (height - 1)));
  }
  for (int tick = 0; tick < kTicks; ++tick) {
    const double t = static_cast<double>(tick) / (kTicks - 1);
    const int y = top + static_cast<int>(std::lround((1 - t) * (height - 1)));
    fill(result, left + kBarWidth, y, kMargin / 2, 1, kWhite);
    draw_number(result, left + kBarWidth + kMargin, y - kTextHeight / 2, std::lerp(range.low, range.high, t));
  }
  return result;
}

Picture with_category_key(Picture picture, int last) {
  const int left = picture.width() + kMargin;
  Picture result = with_side_strip(picture);
  for (int i = 0; i <= last; ++i) {
    const int y = kMargin + i * (kTextHeight + kMargin / 2);
    fill(result, left, y, kBarWidth, kTextHeight, category_colour(i));
    draw_number(result, left + kBarWidth + kMargin, y, i);
  }
  return result;
}

}  // namespace stein::cli
