// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/guides.hpp"

namespace stein::kernels {

inline constexpr int kMaxMaps = 32;
inline constexpr int kWindow = 5;  ///< taps in x, and at most as many rows

/// One row of an edge-aware weighted mean of several maps that share the weights 2^-d * spatial. The window has kWindow
/// taps in x, `step` pixels apart, in each of `rows` rows. Rows are given by their own pointers, each to the pixel
/// above, on or below the first target pixel; 2 * step pixels to the left of it and to the right of the last one must
/// be readable.
struct GuidedSmoothRow {
  Guides centre;
  const float* centre_map[kMaxMaps];
  Guides around[kWindow];
  const float* map[kWindow][kMaxMaps];
  float spatial[kWindow][kWindow];  ///< [row][tap]
  int rows = 0;
  int maps = 0;
  int step = 1;
  int count = 0;  ///< target pixels; rows are read and written up to the next multiple of kMaxLanes

  float* result[kMaxMaps];  ///< out: the weighted mean; the pixel's own value where no neighbour has weight

  /// If given: the inverse of an effective count, the variance of what the maps hold were they means of noise of
  /// variance 1. It becomes overlap' * sum w^2 v / (sum w)^2, with overlap' from 1, where one neighbour has all the
  /// weight, to `overlap`, where all have the same: means of overlapping windows are correlated.
  const float* inverse_count[kWindow];
  const float* centre_inverse_count = nullptr;
  float overlap = 1;
  float* inverse_count_result = nullptr;
};

void guided_smooth_row(const GuidedSmoothRow& row);

}  // namespace stein::kernels
