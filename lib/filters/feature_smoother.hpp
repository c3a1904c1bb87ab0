// SPDX-License-Identifier: Apache-2.0
//
// Features with less noise: non-local means of each feature by its own patches.
#pragma once

#include <cstddef>

#include "exec/buffers.hpp"
#include "exec/rect.hpp"
#include "filters/nlm_taps.hpp"
#include "kernels/feature_nlm.hpp"
#include "prefilter/source.hpp"

namespace stein {

/// AOS: Yuan, Zheng, Zheng, Liu, "Adaptive Rendering based on Adaptive Order Selection", 2017, sec. 6.
class FeatureSmoother {
 public:
  /// Tiles do not exceed tile_width x tile_height.
  FeatureSmoother(const Source& source, const NlmWindow& window, int tile_width, int tile_height);

  static constexpr int kNone = -1;

  /// Pixels around a tile that its smoothed features depend on.
  [[nodiscard]] static constexpr int halo(const NlmWindow& window) { return window.radius + window.patch_radius; }

  /// For the tile: the smoothed means of a feature's channels, in normalised units, to planes of `to` from first_mean
  /// on. And how much of a step of the pixel's own value is left in each, 0 to 1, to planes from first_kept on, if it
  /// is wanted; 0 where the feature is unusable.
  void run(std::size_t feature, const Rect& tile, exec::TileScratch& scratch, const exec::RowRing& to, int first_mean,
           int first_kept = kNone) const;

 private:
  void load(std::size_t feature, const Rect& tile, exec::TileScratch& scratch, float* line) const;

  const Source& source_;
  exec::TileLayout layout_;
  kernels::FeatureNlmRows rows_;  // what all tiles share
};

}  // namespace stein
