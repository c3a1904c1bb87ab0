// SPDX-License-Identifier: Apache-2.0
//
// From an error estimate to the next samples (SBF sec. 4.3).
#pragma once

#include <cstdint>
#include <vector>

#include "stein/plane.hpp"

namespace stein {

struct DensityParams {
  float epsilon = 0.001F;  ///< Eq. 9, added to the squared luminance; > 0
};

struct AllocationParams {
  std::int64_t budget = 0;                   ///< samples to hand out in all, >= 0
  std::uint32_t min_per_pixel = 0;           ///< every pixel gets at least this many
  std::uint32_t max_per_pixel = UINT32_MAX;  ///< and at most this many
};

/// Integer samples per pixel, proportional to `density` (>= 0, finite; values below 0 count as 0) as far as the bounds
/// allow. The sum is exactly `budget`; equal inputs give equal outputs. Row-major, width * height. O(pixels log
/// pixels).
/// @throws Error kInvalidArgument if the bounds leave no room for the budget, kInvalidFrame naming a non-finite
/// density.
[[nodiscard]] std::vector<std::uint32_t> allocate_samples(ConstPlaneView density, const AllocationParams& params);

}  // namespace stein
