// SPDX-License-Identifier: Apache-2.0
#include "prefilter/outlier_energy.hpp"

#include <algorithm>
#include <cmath>

namespace stein {
namespace {

// Sum of a Gaussian around `centre` over the pixels of a line.
float sum_within(const std::vector<float>& gaussian, int centre, int length) {
  const int radius = static_cast<int>(gaussian.size()) / 2;
  float sum = 0;
  for (int i = std::max(centre - radius, 0); i <= std::min(centre + radius, length - 1); ++i)
    sum += gaussian[static_cast<std::size_t>(i - centre + radius)];
  return sum;
}

}  // namespace

OutlierEnergy::OutlierEnergy(const Source& source, const LayerSource& layers, float sigma)
    : source_(source), layers_(layers), radius_(static_cast<int>(std::ceil(kReach * sigma))) {
  if (sigma <= 0.0F) return;
  for (int i = -radius_; i <= radius_; ++i) {
    const float distance = static_cast<float>(i) / sigma;
    gaussian_.push_back(std::exp(-0.5F * distance * distance));
  }
  const Frame& frame = source.frame();
  first_in_row_.assign(static_cast<std::size_t>(frame.height) + 1, 0);
  for (const ReplacedPixel& pixel : source.replaced().list()) {
    if (!pixel.is_source) continue;
    const float sum = sum_within(gaussian_, pixel.x, frame.width) * sum_within(gaussian_, pixel.y, frame.height);
    outliers_.push_back({&pixel, 1.0F / sum});
    ++first_in_row_[static_cast<std::size_t>(pixel.y) + 1];
  }
  for (std::size_t y = 1; y < first_in_row_.size(); ++y) first_in_row_[y] += first_in_row_[y - 1];
}

template <class Lost>
void OutlierEnergy::add(const Lost& lost, int y, int x, int count, float factor, float* out) const {
  if (outliers_.empty()) return;
  const int height = static_cast<int>(first_in_row_.size()) - 1;
  const auto first = first_in_row_[static_cast<std::size_t>(std::max(y - radius_, 0))];
  const auto last = first_in_row_[static_cast<std::size_t>(std::min(y + radius_ + 1, height))];
  for (std::size_t i = first; i < last; ++i) {
    const ReplacedPixel& pixel = *outliers_[i].pixel;
    const int x0 = std::max(pixel.x - radius_, x);
    const int x1 = std::min(pixel.x + radius_ + 1, x + count);
    if (x0 >= x1) continue;
    const float peak = factor * lost(pixel) * outliers_[i].inverse_sum * gaussian(y - pixel.y);
    const float* line = gaussian_.data() + (x0 - pixel.x + radius_);
    float* to = out + (x0 - x);
    for (int u = 0; u < x1 - x0; ++u) to[u] += peak * line[u];
  }
}

void OutlierEnergy::add_colour(int channel, int y, int x, int count, float factor, float* out) const {
  const auto c = static_cast<std::size_t>(channel);
  const ConstPlaneView& plane = source_.frame().colour[c];
  add([&](const ReplacedPixel& pixel) { return plane.at(pixel.x, pixel.y) - pixel.colour[c]; }, y, x, count, factor,
      out);
}

void OutlierEnergy::add_divergence(int channel, int y, int x, int count, float factor, float* out) const {
  if (outliers_.empty()) return;
  const ConstPlaneView& variance = source_.frame().colour_variance[static_cast<std::size_t>(channel)];
  const auto row = static_cast<std::size_t>(y);
  for (std::size_t i = first_in_row_[row]; i < first_in_row_[row + 1]; ++i) {
    const ReplacedPixel& pixel = *outliers_[i].pixel;
    if (pixel.x < x || pixel.x >= x + count) continue;
    const float share = outliers_[i].inverse_sum * gaussian(0) * gaussian(0);
    out[pixel.x - x] += factor * share * (1.0F - pixel.response) * variance.at(pixel.x, y);
  }
}

void OutlierEnergy::add_layer(int channel, int y, int x, int count, float factor, float* out) const {
  const auto lost = [&](const ReplacedPixel& pixel) {
    float own = 0;
    float filtered = 0;
    layers_.input_row(channel, pixel.y, pixel.x, 1, &own);
    layers_.row(channel, pixel.y, pixel.x, 1, &filtered);
    return own - filtered;
  };
  add(lost, y, x, count, factor, out);
}

}  // namespace stein
