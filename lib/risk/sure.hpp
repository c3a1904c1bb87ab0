// SPDX-License-Identifier: Apache-2.0
//
// Stein's unbiased risk estimate, a row at a time.
#pragma once

namespace stein {

/// out = (F - y)^2 + 2 D - v: SBF Eq. 2 for one channel. y: input mean; v: its variance (of the mean); D: the filter's
/// divergence term (filters/filter.hpp). Which risk this is depends on D alone: plain SURE where D is v dF/dy, joint
/// SURE where it holds the covariances too, Monte Carlo where it was measured by perturbing the input.
inline void sure_row(const float* F, const float* D, const float* y, const float* v, int count, float* out) {
  for (int i = 0; i < count; ++i) {
    const float difference = F[i] - y[i];
    out[i] = difference * difference + 2.0F * D[i] - v[i];
  }
}

}  // namespace stein
