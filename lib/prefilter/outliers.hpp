// SPDX-License-Identifier: Apache-2.0
//
// Single pixels whose brightness nothing supports: neither their neighbours nor their own samples ("fireflies").
#pragma once

#include <vector>

#include "exec/runner.hpp"
#include "prefilter/source.hpp"
#include "stein/denoise.hpp"

namespace stein {

struct OutlierReport {
  std::vector<ReplacedPixel> pixels;  ///< in row order
  double removed = 0;                 ///< sum over pixels and channels of what was taken away, in units of radiance
};

/// A valid pixel is an outlier if its mean over the channels exceeds
///   - the largest m of its valid neighbours' (8-neighbourhood) by more than `excess` of that neighbour's standard
///   errors, and
///   - m by less than `support` of its own standard errors: its samples do not agree that it is brighter.
///     Standard errors of few degrees of freedom d (Frame::degrees_of_freedom) count 1 + 2 / d times.
/// It is scaled down to m, which takes less than `support` of its own standard errors away: with more samples that
/// vanishes.
[[nodiscard]] OutlierReport find_outliers(const Source& source, const OutlierParams& params, exec::Runner& runner);

}  // namespace stein
