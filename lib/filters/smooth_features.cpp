// SPDX-License-Identifier: Apache-2.0
#include "filters/smooth_features.hpp"

#include <algorithm>

namespace stein {

SmoothFeatures::SmoothFeatures(const Source& source, const FeatureGuides& guides, int tile_width, int tile_height,
                               int rows)
    : source_(source), smoother_(source, kWindow, tile_width, tile_height) {
  const std::vector<Feature>& features = source.frame().features;
  for (std::size_t f = 0; f < features.size(); ++f) {
    if (guides.sigma_of(features[f].name) <= 0) continue;
    for (std::size_t k = 0; k < features[f].mean.size(); ++k) channels_.push_back({f, k});
  }
  ring_ = exec::RowRing(3 * channels(), source.frame().width, rows, source.memory());
}

// Of the mean of alike pixels as much noise is left as of a step of the pixel itself.
void SmoothFeatures::prepare(const Rect& tile, exec::TileScratch& scratch) const {
  const int n = tile.width();
  for (int k = 0; k < channels(); ++k) {
    const Channel& channel = channels_[static_cast<std::size_t>(k)];
    if (channel.k == 0) smoother_.run(channel.feature, tile, scratch, ring_, k, 2 * channels() + k);
    for (int y = tile.y0; y < tile.y1; ++y) {
      const float* kept = ring_.row(2 * channels() + k, y) + tile.x0;
      float* variance = ring_.row(channels() + k, y) + tile.x0;
      source_.feature_variance_row(channel.feature, channel.k, y, tile.x0, n, variance);
      for (int i = 0; i < n; ++i) {
        if (variance[i] < Source::kNoInformation) variance[i] *= kept[i];
      }
    }
  }
}

bool SmoothFeatures::has_covariance() const noexcept {
  return std::any_of(channels_.begin(), channels_.end(), [&](const Channel& channel) {
    return !source_.frame().features[channel.feature].colour_covariance.empty();
  });
}

void SmoothFeatures::covariance_rows(int y, int x, int count, float* const* rows) const {
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    const float* kept = ring_.row(2 * channels() + static_cast<int>(k), y) + x;
    for (std::size_t c = 0; c < 3; ++c) {
      float* out = rows[c * channels_.size() + k];
      source_.feature_covariance_row(c, channels_[k].feature, channels_[k].k, 1.0F, y, x, count, out);
      for (int i = 0; i < count; ++i) out[i] *= kept[i];
    }
  }
}

}  // namespace stein
