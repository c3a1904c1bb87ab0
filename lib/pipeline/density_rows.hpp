// SPDX-License-Identifier: Apache-2.0
//
// The density of samples, before it is scaled to mean 1.
#pragma once

#include "filters/filter.hpp"
#include "stein/denoise.hpp"

namespace stein {

/// Adds a channel's part of the noise that the result keeps of each pixel's own: D over F^2 + 0.01.
void add_kept_noise(const float* F, const float* D, int count, float* noise);

/// DensityRule::kAllSamples, from the smoothed noise of `add_kept_noise`. `samples`: a row of scratch.
void all_samples_row(const Source& source, const Rect& tile, int y, const float* noise, float* samples, float* density);

/// DensityRule::kNextSamples, from colour and error of the result. `lines`: 4 rows of scratch, `pitch` apart.
void next_samples_row(const Source& source, const DenoiseParams& params, const DenoiseResult& result, const Rect& tile,
                      int y, float* lines, std::ptrdiff_t pitch, float* density);

}  // namespace stein
