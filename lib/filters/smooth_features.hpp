// SPDX-License-Identifier: Apache-2.0
//
// Features with less noise: non-local means of each feature by its own patches (AOS sec. 6).
#pragma once

#include <cstddef>
#include <vector>

#include "exec/buffers.hpp"
#include "exec/rect.hpp"
#include "filters/filter.hpp"
#include "kernels/cross_nlm.hpp"
#include "prefilter/source.hpp"

namespace stein {

/// AOS: Yuan, Zheng, Zheng, Liu, "Adaptive Rendering based on Adaptive Order Selection", 2017.
class SmoothFeatures {
 public:
  static constexpr int kHalo = 7;  ///< of prepare(): the window and the patches

  /// The frame's features that `guides` gives a sigma, in a window of `rows` rows.
  SmoothFeatures(const Source& source, const FeatureGuides& guides, int tile_width, int tile_height, int rows);

  /// Fills the tile's pixels.
  void prepare(const Rect& tile, FilterScratch& scratch) const;

  [[nodiscard]] int channels() const noexcept { return static_cast<int>(channels_.size()); }
  /// The smoothed mean of a channel, normalised, and its variance; Source::kNoInformation where nothing is known of it.
  [[nodiscard]] const float* mean(int channel, int y) const noexcept { return ring_.row(2 * channel, y); }
  [[nodiscard]] const float* variance(int channel, int y) const noexcept { return ring_.row(2 * channel + 1, y); }

  /// Covariances of the means of colour channel c and the smoothed channel k, pixel by pixel, to
  /// rows[c * channels() + k]. `line`: scratch of `count` floats.
  [[nodiscard]] bool has_covariance() const noexcept;
  void covariance_rows(int y, int x, int count, float* line, float* const* rows) const;

 private:
  struct Channel {
    std::size_t feature = 0;
    std::size_t k = 0;  // of the feature's
  };
  static constexpr std::size_t kTogether = 3;  // channels of a feature that share their weights
  // Some of them, a tile, and lines of scratch of its pitch.
  struct Work {
    std::size_t first = 0;
    std::size_t count = 0;
    const Rect& tile;
    exec::TilePlanes& planes;
    float* lines;
  };

  [[nodiscard]] std::size_t together_from(std::size_t first) const;
  void load(const Work& work) const;
  void set_block(const Work& work, int y, kernels::CrossNlmRows& rows) const;
  void finish(const Work& work) const;

  const Source& source_;
  std::vector<Channel> channels_;
  exec::TileLayout layout_;
  std::vector<std::ptrdiff_t> taps_;
  kernels::CrossNlmRows rows_;
  exec::RowRing ring_;
};

}  // namespace stein
