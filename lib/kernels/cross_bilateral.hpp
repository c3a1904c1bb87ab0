// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/guides.hpp"

namespace stein::kernels {

inline constexpr int kMaxScales = 8;

/// One row of a cross-bilateral bank: candidate s has weights 2^-d * spatial[s] over the taps that reach it.
struct CrossBilateralRow {
  Guides guides;
  Guides centre;             ///< what the target pixels look for their like with: `guides`, or others at tap 0
  const float* colour[3];    ///< as the guides: the row's first target pixel, neighbours at the taps' offsets
  const float* variance[3];  ///< of the mean; target pixels only
  int count = 0;             ///< target pixels; rows are read and written up to the next multiple of kMaxLanes

  const std::ptrdiff_t* taps = nullptr;  ///< offsets of the neighbours, the pixel itself included
  int tap_count = 0;                     ///< a multiple of kTapBatch
  /// Batch b of taps uses scales [first_scale[b], scales), with factors spatial[b * scales + s].
  const int* first_scale = nullptr;
  const float* spatial = nullptr;
  int scales = 0;
  /// Whether guides move with the colour's noise. Then covariance[c][k], target pixels only, is 2 ln 2 times the
  /// covariance of colour channel c with guide channel k, in the units of the guides: it moves the logarithm of a
  /// weight by minus itself times (f_i - f_j) / V.
  bool has_covariance = false;
  const float* covariance[3][kMaxGuideChannels];

  float* result[kMaxScales][3];  ///< out: F, SBF Eq. 5; the pixel's own colour where no neighbour has weight
  /// out: sum over the pixel's own inputs x of dF_c/dx Cov(x, x_c): Joint SURE Eq. 2, of which SBF Eq. 7 is a part
  float* divergence[kMaxScales][3];
  LayerChannels layers;  ///< with cross_bilateral_layer_scratch(layers.count) floats
};

[[nodiscard]] constexpr std::size_t cross_bilateral_layer_scratch(int channels) noexcept {
  return std::size_t{kMaxScales} * kMaxLanes * static_cast<std::size_t>(channels);
}

void cross_bilateral_row(const CrossBilateralRow& row);

}  // namespace stein::kernels
