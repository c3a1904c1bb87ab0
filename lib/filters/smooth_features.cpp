// SPDX-License-Identifier: Apache-2.0
#include "filters/smooth_features.hpp"

#include <algorithm>
#include <numbers>

#include "filters/nlm_block.hpp"
#include "filters/nlm_taps.hpp"

namespace stein {
namespace {

constexpr NlmWindow kWindow = {5, 2};
static_assert(SmoothFeatures::kHalo == kWindow.radius + kWindow.patch_radius);
constexpr float kExponent = static_cast<float>(std::numbers::log2e);  // 1 / (2 sigma_r^2) = 1
constexpr float kSlope = 2.0F;

// Lines of scratch: means that are not wanted and the group's variance; where the kernel's unused outputs go.
constexpr std::size_t kLines = 5;

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
  set_window(kWindow, taps_, layout_, rows_);
  rows_.is_normalised = true;
  rows_.candidates = 1;
  rows_.exponent[0] = kExponent;
  rows_.slope[0] = kSlope;
  ring_ = exec::RowRing(2 * channels(), source.frame().width, rows, source.memory());
}

// How many channels of a feature to smooth at a time.
std::size_t SmoothFeatures::together_from(std::size_t first) const {
  std::size_t count = 1;
  while (count < kTogether && first + count < channels_.size() &&
         channels_[first + count].feature == channels_[first].feature) {
    ++count;
  }
  return count;
}

void SmoothFeatures::prepare(const Rect& tile, FilterScratch& scratch) const {
  scratch.tile.reserve(layout_, kPlanes);
  const std::size_t kernel_floats = kernels::cross_nlm_scratch(rows_.candidates);
  kernels::CrossNlmRows rows = rows_;
  rows.count = tile.width();
  rows.scratch = scratch.lines.reserve(kernel_floats + kLines * static_cast<std::size_t>(layout_.pitch));
  for (std::size_t first = 0; first < channels_.size();) {
    const Work work{first, together_from(first), tile, scratch.tile, rows.scratch + kernel_floats};
    load(work);
    for (int y = 0; y < tile.height(); y += kernels::kNlmBlockRows) {
      rows.rows = std::min(kernels::kNlmBlockRows, tile.height() - y);
      set_block(work, y, rows);
      kernels::cross_nlm_rows(rows);
    }
    finish(work);
    first += work.count;
  }
}

void SmoothFeatures::load(const Work& work) const {
  const Frame& frame = source_.frame();
  const std::size_t feature = channels_[work.first].feature;
  const auto line = [&](std::size_t k) { return work.lines + static_cast<std::ptrdiff_t>(k) * layout_.pitch; };
  load_tile(work.tile, frame.width, frame.height, work.planes, 0, kPlanes,
            [&](int y, int x, int n, float* const* rows) {
              float* means[4] = {line(0), line(1), line(2), line(3)};
              for (std::size_t k = 0; k < work.count; ++k) means[channels_[work.first + k].k] = rows[kMean + k];
              source_.feature_row(feature, 1.0F, y, x, n, means, line(4));
              source_.mask_row(y, x, n, rows[kMask]);
              std::fill_n(rows[kGain], n, 1.0F);
              std::fill_n(rows[kZero], n, 0.0F);
              std::fill_n(rows[kNoise], n, 0.0F);
              for (std::size_t k = 0; k < work.count; ++k) {
                source_.feature_variance_row(feature, channels_[work.first + k].k, y, x, n, rows[kVariance + k]);
                for (int i = 0; i < n; ++i) {
                  if (rows[kVariance + k][i] >= Source::kNoInformation) rows[kMask][i] = 0.0F;
                  rows[kNoise][i] += rows[kVariance + k][i];
                }
              }
            });
}

// Rows of the tile from y on, to the kernel.
void SmoothFeatures::set_block(const Work& work, int y, kernels::CrossNlmRows& rows) const {
  rows.guides.mask = work.planes.row(kMask, y);
  rows.gain = work.planes.row(kGain, y);
  rows.noise = work.planes.row(kNoise, y);
  for (int c = 0; c < 3; ++c) {
    const bool is_used = static_cast<std::size_t>(c) < work.count;
    rows.colour[c] = rows.blurred[c] = work.planes.row(is_used ? kMean + c : kZero, y);
    rows.colour_covariance[c] = work.planes.row(is_used ? kVariance + c : kZero, y);
    rows.colour_covariance[3 + c] = work.planes.row(kZero, y);
    const int plane = 2 * (static_cast<int>(work.first) + c);
    for (int r = 0; r < rows.rows; ++r) {
      const int image_y = work.tile.y0 + y + r;
      rows.result[r][0][c] = is_used ? ring_.row(plane, image_y) + work.tile.x0 : work.lines;
      rows.divergence[r][0][c] = is_used ? ring_.row(plane + 1, image_y) + work.tile.x0 : work.lines;
    }
  }
}

// The kernel left V dz~/dz where the variance goes. Of an average it is what noise is left, when the average is of
// alike pixels.
void SmoothFeatures::finish(const Work& work) const {
  const int n = work.tile.width();
  const float* before = work.lines;
  for (std::size_t k = 0; k < work.count; ++k) {
    const Channel& channel = channels_[work.first + k];
    for (int y = work.tile.y0; y < work.tile.y1; ++y) {
      source_.feature_variance_row(channel.feature, channel.k, y, work.tile.x0, n, work.lines);
      float* variance = ring_.row(2 * static_cast<int>(work.first + k) + 1, y) + work.tile.x0;
      for (int i = 0; i < n; ++i) {
        variance[i] = before[i] >= Source::kNoInformation ? before[i] : std::clamp(variance[i], 0.0F, before[i]);
      }
    }
  }
}

bool SmoothFeatures::has_covariance() const noexcept {
  return std::any_of(channels_.begin(), channels_.end(), [&](const Channel& channel) {
    return !source_.frame().features[channel.feature].colour_covariance.empty();
  });
}

void SmoothFeatures::covariance_rows(int y, int x, int count, float* line, float* const* rows) const {
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    source_.feature_variance_row(channels_[k].feature, channels_[k].k, y, x, count, line);
    const float* after = variance(static_cast<int>(k), y) + x;
    for (std::size_t c = 0; c < 3; ++c) {
      float* out = rows[c * channels_.size() + k];
      source_.feature_covariance_row(c, channels_[k].feature, channels_[k].k, 1.0F, y, x, count, out);
      for (int i = 0; i < count; ++i) {
        const float before = line[i];
        out[i] = before > 0.0F && before < Source::kNoInformation ? out[i] * (after[i] / before) : 0.0F;
      }
    }
  }
}

}  // namespace stein
