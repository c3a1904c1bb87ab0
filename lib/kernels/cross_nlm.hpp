// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/guides.hpp"

namespace stein::kernels {

inline constexpr int kMaxRangeSigmas = 12;
inline constexpr int kMaxPatchRadius = 4;
inline constexpr int kNlmBlockRows = 8;    ///< target rows at a time: they share the patches' sums of columns
inline constexpr int kNlmBlockWidth = 32;  ///< target pixels of a row at a time
inline constexpr int kNlmTapGroup = 32;    ///< neighbours whose distances are held at a time

/// A few rows of a cross non-local means bank. Candidate s has weights 2^-(d + exponent[s] p) over the taps, with d the
/// guides' distance and p that of the patches.
///
/// Row y of every input is y * pitch further than the first one. Planes of neighbours lie in a tile with a halo of
/// window_radius plus patch_radius, but at least 1; the pixel's own terms are read at target pixels only.
struct CrossNlmRows {
  Guides guides;
  const float* colour[3];   ///< what is averaged
  const float* blurred[3];  ///< what patches are compared by: gain times the sum of the sources among 3x3 colours with
                            ///< weights 1, blur or blur^2
  const float* gain = nullptr;   ///< one over the sum of those weights
  const float* noise = nullptr;  ///< variance of `blurred`, sum over the channels; read if is_normalised
  float blur = 0;
  bool is_normalised = false;  ///< distances are over the noise
  std::ptrdiff_t pitch = 0;
  int count = 0;         ///< target pixels in a row; read and written up to the next multiple of kMaxLanes
  int rows = 0;          ///< at most kNlmBlockRows
  int patch_radius = 0;  ///< at most kMaxPatchRadius
  int window_radius = 0;

  /// Offsets of the neighbours in the window, the pixel itself included. First come those near enough for their patches
  /// to depend on the pixel, row by row: the square of near_radius. Padded with 0 to a multiple of kTapBatch.
  const std::ptrdiff_t* taps = nullptr;
  int tap_count = 0;
  int near_radius = 0;

  int candidates = 0;
  float exponent[kMaxRangeSigmas];  ///< log2(e) / (2 sigma_r^2), descending
  float slope[kMaxRangeSigmas];     ///< 1 / sigma_r^2
  /// Whether the exponent is twice that of the next candidate: then the weights need no exponential of their own. Each
  /// of these in a row doubles the rounding error.
  bool is_square[kMaxRangeSigmas] = {};

  const float* colour_covariance[6];                    ///< of the mean, with a row's pitch: RR, GG, BB, RG, RB, GB
  bool has_guide_covariance = false;                    ///< whether guides move with the colour's noise
  const float* guide_covariance[3][kMaxGuideChannels];  ///< as CrossBilateralRow::covariance

  float* scratch = nullptr;  ///< cross_nlm_scratch(candidates) floats, aligned to 64 bytes

  float* result[kNlmBlockRows][kMaxRangeSigmas][3];      ///< out: F; the pixel's own colour where nothing has weight
  float* divergence[kNlmBlockRows][kMaxRangeSigmas][3];  ///< out: as CrossBilateralRow::divergence
  /// Results at [(y * candidates + candidate) * count + channel]; with nlm_layer_scratch(candidates, count) floats.
  LayerChannels layers;
};

/// Sums of a candidate: weights w, w x_c for each colour channel, and with the slopes s_c also w s_c and w s_c e_c,
/// where e is the difference to the neighbour.
inline constexpr int kNlmSums = 10;

inline constexpr std::size_t kNlmBlockPixels = std::size_t{kNlmBlockRows} * kNlmBlockWidth;
inline constexpr std::size_t kNlmPatchWidth = kNlmBlockWidth + kMaxLanes;  ///< whole vectors, for a rim of patch_radius
static_assert(2 * kMaxPatchRadius <= kMaxLanes);
inline constexpr std::size_t kNlmPatchFloats = kNlmPatchWidth * std::size_t{kNlmBlockRows + 2 * kMaxPatchRadius};

inline constexpr std::size_t kNlmPatchFields = 7;  ///< of that size

[[nodiscard]] constexpr std::size_t cross_nlm_scratch(int candidates) noexcept {
  return kNlmBlockPixels * (std::size_t{4} * kNlmTapGroup + kNlmSums * static_cast<std::size_t>(candidates)) +
         kNlmPatchFields * kNlmPatchFloats;
}

/// Sums of a block, and one batch of neighbours of its longest vectors.
[[nodiscard]] constexpr std::size_t nlm_layer_scratch(int candidates, int channels) noexcept {
  return static_cast<std::size_t>(channels) *
         (kNlmBlockPixels * static_cast<std::size_t>(candidates) + std::size_t{kMaxLanes} * kTapBatch);
}

void cross_nlm_rows(const CrossNlmRows& rows);

/// F alone, of all candidates at one pixel of the block, `pixel` from its first: for single pixels that are looked at
/// with other inputs than those they have.
void cross_nlm_pixel(const CrossNlmRows& rows, std::ptrdiff_t pixel, float (&result)[kMaxRangeSigmas][3]);

}  // namespace stein::kernels
