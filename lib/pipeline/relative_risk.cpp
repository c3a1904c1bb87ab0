// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
#include "pipeline/relative_risk.hpp"

#include <algorithm>

#include "risk/sure.hpp"

namespace stein {
namespace {

// A pixel is not brighter than its mean by more than this many standard deviations, whatever a filter makes of it.
// Beside a lamp a wide candidate without guides is, by orders of magnitude, and its error would count next to nothing.
constexpr float kDeviationsOfDoubt = 20.0F;

float squared_brightness(float scale, float mean, float variance) {
  return std::min(scale * scale, mean * mean + kDeviationsOfDoubt * kDeviationsOfDoubt * variance);
}

}  // namespace

void relative_risk_rows(const Source& source, const CandidateRows& candidates, int entries, int common,
                        const Rect& tile, int y, float* lines, std::ptrdiff_t pitch, float* const* out) {
  const int n = tile.width();
  float* mean = lines;
  float* variance = lines + pitch;
  float* colour = lines + 2 * pitch;
  float* own_variance = lines + 3 * pitch;
  float* weight = lines + 4 * pitch;
  float* risk = lines + 5 * pitch;
  for (int e = 0; e < entries; ++e) std::fill_n(out[e], n, 0.0F);
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    source.input_row(channel, y, tile.x0, n, mean, variance);
    source.colour_row(channel, y, tile.x0, n, colour);
    source.colour_covariance_row(channel, channel, y, tile.x0, n, own_variance);
    const float* scale = candidates.result(common, c, y) + tile.x0;
    for (int i = 0; i < n; ++i) {
      weight[i] = 1.0F / (3.0F * (squared_brightness(scale[i], mean[i], variance[i]) + kRelativeEpsilon));
    }
    for (int e = 0; e < entries; ++e) {
      const float* F = e == 0 ? colour : candidates.result(e - 1, c, y) + tile.x0;
      const float* D = e == 0 ? own_variance : candidates.divergence(e - 1, c, y) + tile.x0;
      sure_row(F, D, mean, variance, n, risk);
      for (int i = 0; i < n; ++i) out[e][i] += risk[i] * weight[i];
    }
  }
}

}  // namespace stein
