// SPDX-License-Identifier: Apache-2.0
//
// What polynomials are fitted in: features with less noise (AOS sec. 6), and what noise they have left.
#pragma once

#include <cstddef>
#include <vector>

#include "exec/buffers.hpp"
#include "exec/rect.hpp"
#include "filters/feature_smoother.hpp"
#include "prefilter/source.hpp"
#include "stein/filters.hpp"

namespace stein {

class SmoothFeatures {
 public:
  static constexpr NlmWindow kWindow = {5, 2};
  static constexpr int kHalo = FeatureSmoother::halo(kWindow);  ///< of prepare()

  /// The frame's features that `guides` gives a sigma, in a window of `rows` rows.
  SmoothFeatures(const Source& source, const FeatureGuides& guides, int tile_width, int tile_height, int rows);

  /// Fills the tile's pixels.
  void prepare(const Rect& tile, exec::TileScratch& scratch) const;

  [[nodiscard]] int channels() const noexcept { return static_cast<int>(channels_.size()); }
  /// The smoothed mean of a channel, normalised, and its variance; Source::kNoInformation where nothing is known of it.
  [[nodiscard]] const float* mean(int channel, int y) const noexcept { return ring_.row(channel, y); }
  [[nodiscard]] const float* variance(int channel, int y) const noexcept { return ring_.row(channels() + channel, y); }

  /// Covariances of the means of colour channel c and the smoothed channel k, pixel by pixel, to
  /// rows[c * channels() + k].
  [[nodiscard]] bool has_covariance() const noexcept;
  void covariance_rows(int y, int x, int count, float* const* rows) const;

 private:
  struct Channel {
    std::size_t feature = 0;
    std::size_t k = 0;  // of the feature's
  };

  const Source& source_;
  std::vector<Channel> channels_;
  FeatureSmoother smoother_;
  exec::RowRing ring_;  // means, variances, what is kept of steps
};

}  // namespace stein
