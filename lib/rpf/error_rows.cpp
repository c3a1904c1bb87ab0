// SPDX-License-Identifier: Apache-2.0
//
// Joint SURE: Li, "Joint Stein's Unbiased Risk Estimation for Adaptive Sampling and Reconstruction", 2017.
#include "rpf/error_rows.hpp"

#include <algorithm>
#include <cmath>

#include "risk/sure.hpp"

namespace stein::rpf {

ErrorRows::ErrorRows(int width, int height, const RecordLayout& layout, int ring_rows, Memory* memory)
    : width_(width), height_(height), layout_(layout), blurred_(kPlanes, width, ring_rows, memory) {
  for (int i = -kRadius; i <= kRadius; ++i) {
    taps_[static_cast<std::size_t>(i + kRadius)] = std::exp(static_cast<float>(-i * i) / (2.0F * kSigma * kSigma));
  }
  for (auto& plane : risk_) plane.resize(static_cast<std::size_t>(width));
}

// R = (F - y)^2 + 2 D - v with D = b (F(moved) - F) / step, the mean over the draws.
void ErrorRows::risk_of_pixel(const SampleRow& row, const std::vector<const SampleRows*>& moved, int pass, float step,
                              int x) {
  const auto pixel = static_cast<std::size_t>(x);
  const std::size_t first = row.first[pixel];
  const std::size_t n = row.first[pixel + 1] - first;
  risk_[kWeight][pixel] = n < 2 ? 0.0F : 1.0F;
  for (std::size_t c = 0; c < 3; ++c) {
    risk_[c][pixel] = 0;
    if (n < 2) continue;
    const auto stride = static_cast<std::size_t>(layout_.stride);
    const float* colour = row.records + first * stride + static_cast<std::size_t>(layout_.colour()) + c;
    double mean = 0;
    for (std::size_t i = 0; i < n; ++i) mean += colour[i * stride] / static_cast<double>(n);
    double variance = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double e = colour[i * stride] - mean;
      variance += e * e / (static_cast<double>(n) * static_cast<double>(n - 1));
    }
    const std::size_t value = 3 * pixel + c;
    const float F = row.pixels[static_cast<std::size_t>(pass)][value];
    float D = 0;
    for (const SampleRows* draw : moved) {
      const SampleRow& other = draw->row(rows_added_);
      const float b = other.directions[value];
      D += b * (other.pixels[static_cast<std::size_t>(pass)][value] - F) / (step * static_cast<float>(moved.size()));
    }
    const auto y = static_cast<float>(mean);
    const auto v = static_cast<float>(variance);
    sure_row(&F, &D, &y, &v, 1, &risk_[c][pixel]);
    sum_[c] += static_cast<double>(risk_[c][pixel]);
  }
  known_ += n < 2 ? 0 : 1;
}

void ErrorRows::blur_row() {
  for (int plane = 0; plane < kPlanes; ++plane) {
    const std::vector<float>& in = risk_[static_cast<std::size_t>(plane)];
    float* out = blurred_.row(plane, rows_added_);
    for (int x = 0; x < width_; ++x) {
      out[x] = 0;
      for (int nx = std::max(x - kRadius, 0); nx <= std::min(x + kRadius, width_ - 1); ++nx) {
        out[x] += taps_[static_cast<std::size_t>(nx - x + kRadius)] * in[static_cast<std::size_t>(nx)];
      }
    }
  }
}

void ErrorRows::add_row(const SampleRows& rows, const std::vector<const SampleRows*>& moved, int last_pass,
                        float step) {
  for (int x = 0; x < width_; ++x) risk_of_pixel(rows.row(rows_added_), moved, last_pass, step, x);
  blur_row();
  ++rows_added_;
}

void ErrorRows::smooth_row(int channel, int y, float* out) const {
  for (int x = 0; x < width_; ++x) {
    float sum = 0;
    float weight = 0;
    for (int ny = std::max(y - kRadius, 0); ny <= std::min(y + kRadius, height_ - 1); ++ny) {
      const float tap = taps_[static_cast<std::size_t>(ny - y + kRadius)];
      sum += tap * blurred_.row(channel, ny)[x];
      weight += tap * blurred_.row(kWeight, ny)[x];
    }
    out[x] = weight > 0 ? sum / weight : 0.0F;
  }
}

std::array<double, 3> ErrorRows::mean() const {
  std::array<double, 3> mean = sum_;
  for (double& value : mean) value /= static_cast<double>(std::max<std::int64_t>(known_, 1));
  return mean;
}

}  // namespace stein::rpf
