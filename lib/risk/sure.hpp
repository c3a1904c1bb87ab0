// SPDX-License-Identifier: Apache-2.0
//
// Stein's unbiased risk estimate, a row at a time. Joint SURE: Li, "Joint Stein's Unbiased Risk Estimation for Adaptive
// Sampling and Reconstruction", 2017.
#pragma once

namespace stein {

inline constexpr float kRelativeEpsilon = 0.01F;  ///< of relative MSE, SBF sec. 5.2

/// out = (F - y)^2 + 2 D - v: SBF Eq. 2 for one channel. y: input mean; v: its variance (of the mean); D: the filter's
/// divergence term (filters/filter.hpp). Which risk this is depends on D alone: plain SURE where D is v dF/dy, joint
/// SURE where it holds the covariances too, Monte Carlo where it was measured by perturbing the input.
inline void sure_row(const float* F, const float* D, const float* y, const float* v, int count, float* out) {
  for (int i = 0; i < count; ++i) {
    const float difference = F[i] - y[i];
    out[i] = difference * difference + 2.0F * D[i] - v[i];
  }
}

/// Monte Carlo SURE: D += factor b (F(y + step b) - F(y)) for one draw, with factor 1 / (step draws). With b of the
/// joint covariance of colour and features the expectation of the mean over the draws is the sum of both derivative
/// terms of Joint SURE Eq. 2. Where b is 0 nothing moved, and F_moved may hold anything.
inline void add_draw_row(const float* b, const float* F_moved, const float* F, float factor, int count, float* D) {
  for (int i = 0; i < count; ++i) D[i] += b[i] != 0.0F ? factor * b[i] * (F_moved[i] - F[i]) : 0.0F;
}

}  // namespace stein
