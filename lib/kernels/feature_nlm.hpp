// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "kernels/guides.hpp"

namespace stein::kernels {

inline constexpr int kMostFeatureChannels = 4;
inline constexpr int kMostFeaturePatch = 2;  ///< radius
inline constexpr int kFeatureNlmRows = 8;    ///< target rows at a time: they share the patches' sums of columns

/// A few rows of non-local means of one feature by its own patches (AOS sec. 6): weights 2^-(exponent p) over the
/// window, where p is the mean over the patch of (|a - b|^2 - (v_a + min(v_a, v_b))) / (v_a + v_b), at least 0.
///
/// Row y of every input is y * pitch further than the first one. Planes lie in a tile with a halo of window_radius plus
/// patch_radius.
struct FeatureNlmRows {
  const float* mask = nullptr;  ///< 1 where the pixel may be averaged, or 0
  const float* channel[kMostFeatureChannels] = {};
  int channels = 0;
  const float* noise = nullptr;  ///< v: variance of the mean, sum over the channels
  std::ptrdiff_t pitch = 0;
  int count = 0;  ///< target pixels in a row; written up to the next multiple of kMaxLanes
  int rows = 0;   ///< at most kFeatureNlmRows
  int window_radius = 0;
  int patch_radius = 0;  ///< 1 or 2
  float exponent = 0;

  float* scratch = nullptr;  ///< feature_nlm_scratch(count) floats, aligned to 64 bytes

  /// out: the mean; the pixel's own value where nothing has weight
  float* result[kFeatureNlmRows][kMostFeatureChannels] = {};
  /// out, if given: the derivative of a channel's mean by the pixel's own value, the weights' included, cut off at 0
  /// and 1; of the mean of n alike pixels that is near 1 / n, as is the variance that is left. 0 where mask is 0.
  float* kept[kFeatureNlmRows][kMostFeatureChannels] = {};
};

[[nodiscard]] std::size_t feature_nlm_scratch(int count) noexcept;

void feature_nlm_rows(const FeatureNlmRows& rows);

}  // namespace stein::kernels
