// SPDX-License-Identifier: Apache-2.0
//
// From an error estimate to the next samples (SBF sec. 4.3).
#pragma once

#include <cstdint>
#include <vector>

#include "stein/plane.hpp"

#pragma GCC visibility push(default)
namespace stein {

/// What a density says.
enum class DensityRule : std::uint8_t {
  /// Of the next batch: estimated error plus variance of a sample, over the squared luminance (SBF Eq. 9).
  kNextSamples,
  /// Of all samples, those that a pixel has included: the root of the relative variance that a single one of the
  /// pixel's samples would leave in the result. Least noise of the whole result for a budget (docs/adaptive.md).
  kAllSamples,
  /// Of the next batch: by how much a sample lowers the estimated error of a local regression, n^(-4 / (d + 4)), over
  /// the squared luminance (AOS: Yuan, Zheng, Zheng, Liu 2017, sec. 5).
  kErrorReduction,
};

struct DensityParams {
  DensityRule rule = DensityRule::kNextSamples;
  float epsilon = 0.001F;  ///< Eq. 9, added to the squared luminance; > 0. Not read for kAllSamples
  /// d, what the regression depends on, position included; [1..100]. Read for kErrorReduction
  float dimensions = 10.0F;
};

struct AllocationParams {
  std::int64_t budget = 0;                   ///< samples to hand out in all, >= 0
  std::uint32_t min_per_pixel = 0;           ///< every pixel gets at least this many
  std::uint32_t max_per_pixel = UINT32_MAX;  ///< and at most this many
};

/// Integer samples per pixel, proportional to `density` (>= 0, finite; values below 0 count as 0) as far as the bounds
/// allow. Where `existing` is given, samples that pixels already have count (none where it is negative or not finite):
/// the sums of both become proportional, as far as that can be without taking any back. The sum is exactly `budget`;
/// equal inputs give equal outputs. Row-major, width * height. O(pixels log pixels).
/// @throws Error kInvalidArgument if the bounds leave no room for the budget, kInvalidFrame naming a non-finite
/// density, or if the two planes differ in size.
[[nodiscard]] std::vector<std::uint32_t> allocate_samples(ConstPlaneView density, const AllocationParams& params,
                                                          ConstPlaneView existing = {});

}  // namespace stein
#pragma GCC visibility pop
