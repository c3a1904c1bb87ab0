// SPDX-License-Identifier: Apache-2.0
#include "select/selection.hpp"

#include <algorithm>

namespace stein {

void shrink_row(const float* mean, const float* square, const float* inverse_count, float prior, int count,
                float* out) {
  for (int i = 0; i < count; ++i) {
    const float evidence = mean[i] - prior;
    const float variance = std::max(square[i] - mean[i] * mean[i], 0.0F) * inverse_count[i];
    const float squared = evidence * evidence;
    out[i] = prior + (squared > variance ? evidence * (1.0F - variance / squared) : 0.0F);
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
