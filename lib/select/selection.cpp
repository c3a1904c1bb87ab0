// SPDX-License-Identifier: Apache-2.0
#include "select/selection.hpp"

#include <algorithm>
#include <cmath>

namespace stein {

void standard_error_row(const float* mean, const float* square, const float* inverse_count, int count, float* out) {
  for (int i = 0; i < count; ++i) out[i] = std::max(square[i] - mean[i] * mean[i], 0.0F) * inverse_count[i];
}

void shrink_row(const float* mean, const float* variance, float prior, int count, float* out) {
  for (int i = 0; i < count; ++i) {
    const float evidence = mean[i] - prior;
    const float squared = evidence * evidence;
    out[i] = prior + (squared > variance[i] ? evidence * (1.0F - variance[i] / squared) : 0.0F);
  }
}

void optimism_row(const float* const* risks, const float* const* variances, int entries, int count, float* out) {
  constexpr float kDensityAtZero = 0.398942280F;  // of the standard normal distribution
  for (int x = 0; x < count; ++x) {
    int best = 0;
    int second = -1;
    for (int e = 1; e < entries; ++e) {
      if (risks[e][x] < risks[best][x]) {
        second = best;
        best = e;
      } else if (second < 0 || risks[e][x] < risks[second][x]) {
        second = e;
      }
    }
    out[x] = 0.0F;
    if (second < 0) continue;
    const float variance = variances[best][x] + variances[second][x];
    const float gap = risks[second][x] - risks[best][x];
    if (variance > 0.0F) out[x] = std::sqrt(variance) * kDensityAtZero * std::exp(-0.5F * gap * gap / variance);
  }
}

void argmin_row(float* const* maps, int entries, int count) {
  for (int x = 0; x < count; ++x) {
    int best = 0;
    for (int e = 1; e < entries; ++e) best = maps[e][x] < maps[best][x] ? e : best;
    for (int e = 0; e < entries; ++e) maps[e][x] = e == best ? 1.0F : 0.0F;
  }
}

void largest_row(const float* const* weights, int entries, int count, float* index) {
  for (int x = 0; x < count; ++x) {
    int best = 0;
    for (int e = 1; e < entries; ++e) best = weights[e][x] > weights[best][x] ? e : best;
    index[x] = static_cast<float>(best);
  }
}

}  // namespace stein
