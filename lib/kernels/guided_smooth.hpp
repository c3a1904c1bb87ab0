// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/guides.hpp"

namespace stein::kernels {

inline constexpr int kMaxMaps = 16;

/// One row of an edge-aware weighted mean of several maps that share the weights 2^-d * spatial[tap].
struct GuidedSmoothRow {
  Guides guides;
  const float* map[kMaxMaps];  ///< as the guides: the row's first target pixel, neighbours at the taps' offsets
  int maps = 0;
  int count = 0;  ///< target pixels; rows are read and written up to the next multiple of kMaxLanes

  const std::ptrdiff_t* taps = nullptr;  ///< offsets of the neighbours, the pixel itself included
  const float* spatial = nullptr;        ///< one factor per tap
  int tap_count = 0;                     ///< a multiple of kTapBatch

  float* result[kMaxMaps];  ///< out: the weighted mean; the pixel's own value where no neighbour has weight
};

void guided_smooth_row(const GuidedSmoothRow& row);

}  // namespace stein::kernels
