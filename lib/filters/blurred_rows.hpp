// SPDX-License-Identifier: Apache-2.0
//
// The colours that patches are compared by: a little less noisy than those that are averaged.
#pragma once

#include "prefilter/source.hpp"

namespace stein {

inline constexpr int kBlurRadius = 1;
inline constexpr int kBlurredPlanes = 5;

/// For pixels [x, x + count) of row y: the mean of the 3x3 valid colours with weights 1, `blur` and blur^2, to
/// rows[0..3); one over the sum of the weights, to rows[3]; and the variance of that mean, summed over the channels, to
/// rows[4]. Where no pixel is valid all are 0.
void blurred_row(const Source& source, float blur, int y, int x, int count, float* const* rows);

}  // namespace stein
