// SPDX-License-Identifier: Apache-2.0
#include "rpf/light_return.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stein::rpf {
namespace {

constexpr int kSpan = LightReturn::kSpan;
constexpr float kReach = 2.0F;  // in standard deviations of the Gaussian
// Squared difference of two colours, in units of the mean of their squares, at which they have nothing in common.
constexpr float kLargestDifference = 1.5F;
// Times its variance: what of a squared mean is taken for noise.
constexpr float kDoubt = 2.0F;
constexpr float kTiny = std::numeric_limits<float>::min();

enum : int { kColour = 0, kLost = 3, kKnown = 6, kPlanes = 7 };  // of SampleRow::balance

using Span = std::array<float, static_cast<std::size_t>(kSpan)>;

/// Sums over the pixels around, w the weight and d what was lost.
struct Sums {
  Span w{};
  Span ww{};
  std::array<Span, 3> wd{};
  std::array<Span, 3> wwd{};
  std::array<Span, 3> wwdd{};
};

/// Adds the neighbours that lie as far from each pixel of the span. Loops over pixels become vectors.
void add_neighbours(const float* centre, const float* other, std::ptrdiff_t pitch, float tap, Sums& sums) {
  for (std::size_t i = 0; i < kSpan; ++i) {
    float difference = 0;
    float size = kTiny;
    for (std::ptrdiff_t c = 0; c < 3; ++c) {
      const float a = centre[c * pitch + static_cast<std::ptrdiff_t>(i)];
      const float b = other[c * pitch + static_cast<std::ptrdiff_t>(i)];
      difference += (a - b) * (a - b);
      size += a * a + b * b;
    }
    const float like = std::max(0.0F, 1.0F - 2.0F / kLargestDifference * difference / size);
    const float w = tap * like * like * other[kKnown * pitch + static_cast<std::ptrdiff_t>(i)];
    sums.w[i] += w;
    sums.ww[i] += w * w;
    for (std::size_t c = 0; c < 3; ++c) {
      const float d = other[(kLost + static_cast<std::ptrdiff_t>(c)) * pitch + static_cast<std::ptrdiff_t>(i)];
      sums.wd[c][i] += w * d;
      sums.wwd[c][i] += w * w * d;
      sums.wwdd[c][i] += w * w * d * d;
    }
  }
}

/// The mean, times how much of its square its variance does not explain.
std::array<float, 3> returned(const Sums& sums, std::size_t i) {
  std::array<float, 3> mean{};
  if (sums.w[i] <= 0) return mean;
  float square = 0;
  float variance = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const float m = sums.wd[c][i] / sums.w[i];
    const float spread = sums.wwdd[c][i] - 2 * m * sums.wwd[c][i] + m * m * sums.ww[i];
    variance += std::max(spread, 0.0F) / (sums.w[i] * sums.w[i]);
    square += m * m;
    mean[c] = m;
  }
  const float share = square > kDoubt * variance ? 1.0F - kDoubt * variance / square : 0.0F;
  for (float& value : mean) value *= share;
  return mean;
}

}  // namespace

LightReturn::LightReturn(float sigma) : radius_(static_cast<int>(std::ceil(kReach * sigma))) {
  for (int d = -radius_; d <= radius_; ++d) {
    taps_.push_back(std::exp(static_cast<float>(-d * d) / (2.0F * sigma * sigma)));
  }
}

std::size_t LightReturn::row_floats(int width) const noexcept {
  return static_cast<std::size_t>(kPlanes * pitch(width));
}

void LightReturn::note_pixel(const RecordLayout& layout, int last, int x, SampleRow& row) const {
  const auto pixel = static_cast<std::size_t>(x);
  const std::size_t first = row.first[pixel];
  const std::size_t n = row.first[pixel + 1] - first;
  const auto stride = static_cast<std::size_t>(layout.stride);
  const auto plane = static_cast<std::size_t>(pitch(static_cast<int>(row.first.size()) - 1));
  float* out = row.balance + radius_ + x;
  out[kKnown * plane] = n > 0 ? 1.0F : 0.0F;
  for (std::size_t c = 0; c < 3; ++c) {
    const float filtered = row.pixels[static_cast<std::size_t>(last)][3 * pixel + c];
    const float* colour = row.records + first * stride + static_cast<std::size_t>(layout.colour()) + c;
    float mean = 0;
    for (std::size_t i = 0; i < n; ++i) mean += colour[i * stride] / static_cast<float>(n);
    out[(kColour + c) * plane] = filtered;
    out[(kLost + c) * plane] = n > 0 ? mean - filtered : 0.0F;
  }
}

void LightReturn::run(int stage, int x0, int y, SampleRows& rows) const {
  const std::ptrdiff_t pitch = this->pitch(rows.width());
  const float* centre = rows.row(y).balance + radius_ + x0;
  Sums sums;
  for (int ny = std::max(y - radius_, 0); ny <= std::min(y + radius_, rows.height() - 1); ++ny) {
    const float* across = rows.row(ny).balance + x0;
    const float down = taps_[static_cast<std::size_t>(ny - y + radius_)];
    for (std::size_t k = 0; k < taps_.size(); ++k) add_neighbours(centre, across + k, pitch, down * taps_[k], sums);
  }
  float* out = rows.row(y).pixels[static_cast<std::size_t>(stage)] + static_cast<std::ptrdiff_t>(3) * x0;
  for (int i = 0; i < std::min(kSpan, rows.width() - x0); ++i) {
    const std::array<float, 3> light = returned(sums, static_cast<std::size_t>(i));
    for (std::ptrdiff_t c = 0; c < 3; ++c) {
      const float filtered = centre[c * pitch + i];
      // Where there was no negative light there will be none.
      out[3 * i + c] = std::max(filtered + light[static_cast<std::size_t>(c)], std::min(filtered, 0.0F));
    }
  }
}

}  // namespace stein::rpf
