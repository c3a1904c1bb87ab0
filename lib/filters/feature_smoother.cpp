// SPDX-License-Identifier: Apache-2.0
#include "filters/feature_smoother.hpp"

#include <algorithm>
#include <numbers>

#include "filters/guide_rows.hpp"

namespace stein {
namespace {

constexpr float kExponent = static_cast<float>(std::numbers::log2e);  // 1 / (2 sigma_r^2) = 1

// Planes of a tile.
enum Plane : int { kMask, kNoise, kMean, kPlanes = kMean + kernels::kMostFeatureChannels };

}  // namespace

FeatureSmoother::FeatureSmoother(const Source& source, const NlmWindow& window, int tile_width, int tile_height)
    : source_(source), layout_(tile_width, tile_height, halo(window)) {
  rows_.pitch = layout_.pitch;
  rows_.window_radius = window.radius;
  rows_.patch_radius = window.patch_radius;
  rows_.exponent = kExponent;
}

void FeatureSmoother::run(std::size_t feature, const Rect& tile, exec::TileScratch& scratch, const exec::RowRing& to,
                          int first_mean, int first_kept) const {
  scratch.tile.reserve(layout_, kPlanes);
  const std::size_t kernel_floats = kernels::feature_nlm_scratch(tile.width());
  kernels::FeatureNlmRows rows = rows_;
  rows.scratch = scratch.lines.reserve(kernel_floats + static_cast<std::size_t>(layout_.pitch));
  load(feature, tile, scratch, rows.scratch + kernel_floats);
  rows.channels = static_cast<int>(source_.frame().features[feature].mean.size());
  rows.count = tile.width();
  for (int y = 0; y < tile.height(); y += kernels::kFeatureNlmRows) {
    rows.rows = std::min(kernels::kFeatureNlmRows, tile.height() - y);
    rows.mask = scratch.tile.row(kMask, y);
    rows.noise = scratch.tile.row(kNoise, y);
    for (int k = 0; k < rows.channels; ++k) rows.channel[k] = scratch.tile.row(kMean + k, y);
    for (int r = 0; r < rows.rows; ++r) {
      const int image_y = tile.y0 + y + r;
      for (int k = 0; k < rows.channels; ++k) {
        rows.result[r][k] = to.row(first_mean + k, image_y) + tile.x0;
        if (first_kept != kNone) rows.kept[r][k] = to.row(first_kept + k, image_y) + tile.x0;
      }
    }
    kernels::feature_nlm_rows(rows);
  }
}

void FeatureSmoother::load(std::size_t feature, const Rect& tile, exec::TileScratch& scratch, float* line) const {
  const Frame& frame = source_.frame();
  const std::size_t channels = frame.features[feature].mean.size();
  const int planes = kMean + static_cast<int>(channels);
  load_tile(tile, frame.width, frame.height, scratch.tile, 0, planes, [&](int y, int x, int n, float* const* rows) {
    source_.feature_mean_rows(feature, 1.0F, y, x, n, rows + kMean);
    source_.mask_row(y, x, n, rows[kMask]);
    std::fill_n(rows[kNoise], n, 0.0F);
    for (std::size_t k = 0; k < channels; ++k) {
      source_.feature_variance_row(feature, k, y, x, n, line);
      for (int i = 0; i < n; ++i) {
        if (line[i] >= Source::kNoInformation) rows[kMask][i] = 0.0F;
        rows[kNoise][i] += line[i];
      }
    }
  });
}

}  // namespace stein
