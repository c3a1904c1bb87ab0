// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/guides.hpp"

namespace stein::kernels {

inline constexpr int kAtrousTaps = 5;      ///< in x, and at most as many rows
inline constexpr int kAtrousPixels = 128;  ///< that sums are held of at a time

/// One row of one level of an edge-avoiding à-trous transform: c becomes the weighted mean c' of its 5x5 taps `step`
/// pixels apart, and the detail c - c' is shrunk and added to the result.
///
/// "Noise" is the variance of c, summed over the colour channels. The weight of a tap is
///   B3 spline * mask * 2^-(d + value_factor |c_p - c_q|^2 / (n_p + min(n_p, n_q)))
/// with d the distance of the guides and n the noise; at a pixel of mask 0 the value term is off.
///
/// Rows are given by their own pointers, each to the pixel above, on or below the first target pixel; 2 * step pixels
/// to the left of it and to the right of the last one must be readable.
struct AtrousRow {
  Guides centre;
  const float* centre_colour[3];
  const float* centre_noise = nullptr;
  Guides around[kAtrousTaps];
  const float* colour[kAtrousTaps][3];
  const float* noise[kAtrousTaps];
  float spline[kAtrousTaps];  ///< of each row
  int rows = 0;
  int step = 1;
  int count = 0;  ///< target pixels; rows are read and written up to the next multiple of kMaxLanes

  float value_factor = 0;
  /// Mean correlation of the noise of two taps, for uniform noise and weights of the spline alone.
  float correlation = 0;

  // The factor to the detail: fixed, or where that is below 0 what minimises (1 - w)^2 E + 2 w margin N, with E the
  // weighted mean of |c - c'|^2 over the taps and N its share of noise; 0 where the mask is 0.
  float fixed_weight = 0;
  float margin = 1;
  int weight_steps = 0;  ///< weights are rounded to multiples of 1 / weight_steps; 0: any in [0, 1]

  bool is_first = false;  ///< the result starts here
  bool is_last = false;   ///< c' is added to the result; next_noise is not written
  float* next_colour[3];  ///< out: c'; c where no tap has weight; or null
  float* next_noise = nullptr;
  float* result[3];  ///< in and out
  /// Values at [row * count + channel], and behind those of kAtrousTaps rows the centre's; results at [channel], in and
  /// out, and, unless next_colour is null, behind them c'; with atrous_layer_scratch(count) floats.
  LayerChannels layers;
};

[[nodiscard]] constexpr std::size_t atrous_layer_scratch(int channels) noexcept {
  return std::size_t{kAtrousPixels} * static_cast<std::size_t>(channels);
}

void atrous_row(const AtrousRow& row);

}  // namespace stein::kernels
