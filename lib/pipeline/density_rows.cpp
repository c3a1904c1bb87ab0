// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
#include "pipeline/density_rows.hpp"

#include <algorithm>
#include <cmath>

#include "core/validity.hpp"
#include "pipeline/relative_risk.hpp"

namespace stein {

void add_kept_noise(const float* F, const float* D, int count, float* noise) {
  for (int i = 0; i < count; ++i) noise[i] += std::max(D[i], 0.0F) / (F[i] * F[i] + kRelativeEpsilon);
}

// For given weights w_ij of a linear filter and samples of variance s_j, the noise left in the image is
// sum_i W_i sum_j w_ij^2 s_j / n_j, least for a sum of all n_j where n_j^2 is proportional to s_j sum_i W_i w_ij^2.
// Weights change little over a window: that sum is about W_j w_jj, and s_j w_jj = n_j D_j.
void all_samples_row(const Source& source, const Rect& tile, int y, const float* noise, float* samples,
                     float* density) {
  const int n = tile.width();
  sample_count_row(source.frame(), y, tile.x0, n, samples);
  for (int i = 0; i < n; ++i) density[i] = std::sqrt(noise[i] * samples[i]);
}

// SBF Eq. 9: S = (SURE + sigma^2) / (I^2 + eps), with the mean over the channels of the estimated error and of the
// per-sample variance, and I the luminance of the result; AOS sec. 5: MSE n^(-4 / (d + 4)) / (I^2 + eps). Sums below 0
// count as 0.
void next_samples_row(const Source& source, const DenoiseParams& params, const DenoiseResult& result, const Rect& tile,
                      int y, float* lines, std::ptrdiff_t pitch, float* density) {
  const int n = tile.width();
  float* samples = lines;
  float* mean = lines + pitch;
  float* variance = lines + 2 * pitch;
  float* luminance = lines + 3 * pitch;
  const bool is_reduction = params.density.rule == DensityRule::kErrorReduction;
  sample_count_row(source.frame(), y, tile.x0, n, samples);
  std::fill_n(luminance, n, 0.0F);
  std::fill_n(density, n, 0.0F);
  for (std::size_t c = 0; c < 3; ++c) {
    source.input_row(c, y, tile.x0, n, mean, variance);
    const float* error = result.error[c].row(y) + tile.x0;
    const float* F = result.colour[c].row(y) + tile.x0;
    for (int i = 0; i < n; ++i) {
      const float sample_variance = variance[i] > 0.0F && !is_reduction ? variance[i] * samples[i] : 0.0F;
      density[i] += (error[i] + sample_variance) / 3.0F;
      luminance[i] += params.luminance_weights[c] * F[i];
    }
  }
  if (is_reduction) {
    const float exponent = -4.0F / (params.density.dimensions + 4.0F);
    for (int i = 0; i < n; ++i) density[i] *= samples[i] > 0.0F ? std::pow(samples[i], exponent) : 1.0F;
  }
  const float epsilon = params.density.epsilon;
  for (int i = 0; i < n; ++i) density[i] = std::max(density[i], 0.0F) / (luminance[i] * luminance[i] + epsilon);
}

}  // namespace stein
