// SPDX-License-Identifier: Apache-2.0
#include "filters/smooth_features.hpp"

#include <algorithm>
#include <numbers>

#include "filters/nlm_taps.hpp"

namespace stein {
namespace {

constexpr NlmWindow kWindow = {5, 2};
static_assert(SmoothFeatures::kHalo == kWindow.radius + kWindow.patch_radius);
constexpr float kExponent = static_cast<float>(std::numbers::log2e);  // 1 / (2 sigma_r^2) = 1
constexpr float kSlope = 2.0F;

// Planes of a tile.
enum Plane : int { kMask, kGain, kZero, kNoise, kMean, kVariance = kMean + 3, kPlanes = kVariance + 3 };

}  // namespace

SmoothFeatures::SmoothFeatures(const Source& source, const FeatureGuides& guides, int tile_width, int tile_height,
                               int rows)
    : source_(source), layout_(tile_width, tile_height, kHalo), taps_(nlm_taps(kWindow, layout_)) {
  const std::vector<Feature>& features = source.frame().features;
  for (std::size_t f = 0; f < features.size(); ++f) {
    if (guides.sigma_of(features[f].name) <= 0) continue;
    for (std::size_t k = 0; k < features[f].mean.size(); ++k) channels_.push_back({f, k});
  }
  rows_.taps = taps_.data();
  rows_.tap_count = (2 * kWindow.radius + 1) * (2 * kWindow.radius + 1);
  rows_.near_radius = near_radius(kWindow);
  rows_.pitch = layout_.pitch;
  rows_.patch_radius = kWindow.patch_radius;
  rows_.window_radius = kWindow.radius;
  rows_.is_normalised = true;
  rows_.candidates = 1;
  rows_.exponent[0] = kExponent;
  rows_.slope[0] = kSlope;
  ring_ = exec::RowRing(2 * channels(), source.frame().width, rows);
}

void SmoothFeatures::prepare(const Rect& tile, FilterScratch& scratch) const {
  exec::TilePlanes& planes = scratch.tile;
  planes.reserve(layout_, kPlanes);
  for (std::size_t first = 0; first < channels_.size();) {
    std::size_t count = 1;
    while (count < kTogether && first + count < channels_.size() &&
           channels_[first + count].feature == channels_[first].feature) {
      ++count;
    }
    load(tile, first, count, planes);
    kernels::CrossNlmRows rows = rows_;
    rows.count = tile.width();
    rows.scratch =
        scratch.lines.reserve(kernels::cross_nlm_scratch(rows.candidates) + static_cast<std::size_t>(layout_.pitch));
    float* unused = rows.scratch + kernels::cross_nlm_scratch(rows.candidates);
    for (int y = 0; y < tile.height(); y += kernels::kNlmBlockRows) {
      rows.rows = std::min(kernels::kNlmBlockRows, tile.height() - y);
      rows.guides.mask = planes.row(kMask, y);
      rows.gain = planes.row(kGain, y);
      rows.noise = planes.row(kNoise, y);
      for (int c = 0; c < 3; ++c) {
        const bool is_used = static_cast<std::size_t>(c) < count;
        rows.colour[c] = rows.blurred[c] = planes.row(is_used ? kMean + c : kZero, y);
        rows.colour_covariance[c] = planes.row(is_used ? kVariance + c : kZero, y);
        rows.colour_covariance[3 + c] = planes.row(kZero, y);
        for (int r = 0; r < rows.rows; ++r) {
          const int channel = 2 * static_cast<int>(first + static_cast<std::size_t>(c));
          const int image_y = tile.y0 + y + r;
          rows.result[r][0][c] = is_used ? ring_.row(channel, image_y) + tile.x0 : unused;
          rows.divergence[r][0][c] = is_used ? ring_.row(channel + 1, image_y) + tile.x0 : unused;
        }
      }
      kernels::cross_nlm_rows(rows);
    }
    finish(tile, first, count);
    first += count;
  }
}

void SmoothFeatures::load(const Rect& tile, std::size_t first, std::size_t count, exec::TilePlanes& planes) const {
  const Frame& frame = source_.frame();
  const std::size_t feature = channels_[first].feature;
  std::vector<float> line(5 * static_cast<std::size_t>(planes.layout().pitch));
  load_tile(tile, frame.width, frame.height, planes, 0, kPlanes, [&](int y, int x, int n, float* const* rows) {
    float* means[4];
    for (std::size_t k = 0; k < 4; ++k) means[k] = line.data() + k * static_cast<std::size_t>(planes.layout().pitch);
    for (std::size_t k = 0; k < count; ++k) means[channels_[first + k].k] = rows[kMean + k];
    float* group_variance = line.data() + 4 * static_cast<std::size_t>(planes.layout().pitch);
    source_.feature_row(feature, 1.0F, y, x, n, means, group_variance);
    source_.mask_row(y, x, n, rows[kMask]);
    std::fill_n(rows[kGain], n, 1.0F);
    std::fill_n(rows[kZero], n, 0.0F);
    std::fill_n(rows[kNoise], n, 0.0F);
    for (std::size_t k = 0; k < count; ++k) {
      source_.feature_variance_row(feature, channels_[first + k].k, y, x, n, rows[kVariance + k]);
      for (int i = 0; i < n; ++i) {
        if (rows[kVariance + k][i] >= Source::kNoInformation) rows[kMask][i] = 0.0F;
        rows[kNoise][i] += rows[kVariance + k][i];
      }
    }
  });
}

// The kernel left V dz~/dz where the variance goes. Of an average it is what noise is left, when the average is of
// alike pixels.
void SmoothFeatures::finish(const Rect& tile, std::size_t first, std::size_t count) const {
  std::vector<float> before(static_cast<std::size_t>(tile.width()));
  for (std::size_t k = 0; k < count; ++k) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      const Channel& channel = channels_[first + k];
      source_.feature_variance_row(channel.feature, channel.k, y, tile.x0, tile.width(), before.data());
      float* variance = ring_.row(2 * static_cast<int>(first + k) + 1, y) + tile.x0;
      for (int i = 0; i < tile.width(); ++i) {
        const float old = before[static_cast<std::size_t>(i)];
        variance[i] = old >= Source::kNoInformation ? old : std::clamp(variance[i], 0.0F, old);
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
  std::vector<float> before(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    source_.feature_variance_row(channels_[k].feature, channels_[k].k, y, x, count, before.data());
    const float* after = variance(static_cast<int>(k), y) + x;
    for (std::size_t c = 0; c < 3; ++c) {
      float* out = rows[c * channels_.size() + k];
      source_.feature_covariance_row(c, channels_[k].feature, channels_[k].k, 1.0F, y, x, count, out);
      for (int i = 0; i < count; ++i) {
        const float old = before[static_cast<std::size_t>(i)];
        out[i] = old > 0.0F && old < Source::kNoInformation ? out[i] * (after[i] / old) : 0.0F;
      }
    }
  }
}

}  // namespace stein
