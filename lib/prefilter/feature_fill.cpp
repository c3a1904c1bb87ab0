// SPDX-License-Identifier: Apache-2.0
#include "prefilter/feature_fill.hpp"

#include <algorithm>
#include <limits>

#include "core/validity.hpp"

namespace stein {

FeatureHoles::FeatureHoles(const Frame& frame, const Feature& feature, int y, int x, int count)
    : frame_(frame), feature_(feature), x_(x), y_(y) {
  float* own = usable_[1] + 1;
  if (feature_validity_row(feature, y, x, count, own) == 0) return;
  const int first = std::max(x - 1, 0);
  const int end = std::min(x + count + 1, frame.width);
  for (int dy = -1; dy <= 1; ++dy) {
    if (!is_inside(first, y + dy)) continue;
    feature_validity_row(feature, y + dy, first, end - first, usable_[dy + 1] + (first - (x - 1)));
  }
}

std::optional<FeatureFill> FeatureHoles::fill(int i) const {
  const std::size_t channels = feature_.mean.size();
  std::array<double, 4> sum{};
  std::array<double, 4> squares{};
  double variance = 0;
  int around = 0;
  int found = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int x = x_ + i + dx;
      const int y = y_ + dy;
      if ((dx == 0 && dy == 0) || !is_inside(x, y)) continue;
      ++around;
      if (usable_[dy + 1][i + 1 + dx] == 0.0F) continue;
      ++found;
      float n = 0;
      sample_count_row(frame_, y, x, 1, &n);
      n = n > 0.0F ? std::min(n, kMostSamples) : 0.0F;  // 0 where it is no number
      for (std::size_t k = 0; k < channels; ++k) {
        const double value = feature_.mean[k].at(x, y);
        sum[k] += value;
        squares[k] += value * value;
        if (!feature_.variance.empty()) variance += static_cast<double>(feature_.variance[k].at(x, y)) * n;
      }
    }
  }
  if (found == 0 || 2 * found < around) return std::nullopt;
  FeatureFill fill;
  for (std::size_t k = 0; k < channels; ++k) {
    const double mean = sum[k] / found;
    fill.mean[k] = static_cast<float>(mean);
    variance += squares[k] - mean * sum[k];
  }
  constexpr double kMost = std::numeric_limits<float>::max();
  fill.sample_variance = static_cast<float>(std::clamp(variance / found / static_cast<double>(channels), 0.0, kMost));
  return fill;
}

}  // namespace stein
