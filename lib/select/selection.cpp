// SPDX-License-Identifier: Apache-2.0
#include "select/selection.hpp"

#include <algorithm>
#include <cmath>

namespace stein {
namespace {

// The least of several estimates once their noise is drawn anew: its mean and variance, and the mean of what the one
// that came out least was without noise.
struct Least {
  float mean;
  float variance;
  float expected;
};

// Of two: Clark, "The greatest of a finite set of random variables", Operations Research 9 (1961), Eq. 2 to 5, with
// the signs of a least. All relative to the mean of a, so that little is lost where means are large against their
// difference.
Least lesser(const Least& a, const Least& b) {
  constexpr float kFar = 4.0F;  // standard deviations: the greater plays no part
  const float variance = a.variance + b.variance;
  const float difference = b.mean - a.mean;
  if (difference * difference >= kFar * kFar * variance) return difference >= 0.0F ? a : b;
  constexpr float kDensityAtZero = 0.398942280F;
  constexpr float kSqrtHalf = 0.707106781F;
  const float deviation = std::sqrt(variance);
  const float alpha = difference / deviation;
  const float density = deviation * kDensityAtZero * std::exp(-0.5F * alpha * alpha);
  const float of_b = 0.5F * std::erfc(alpha * kSqrtHalf);  // probability that it is b
  const float mean = difference * of_b - density;
  const float square =
      a.variance * (1.0F - of_b) + (difference * difference + b.variance) * of_b - difference * density;
  return {a.mean + mean, std::max(square - mean * mean, 0.0F), a.expected + of_b * (b.expected - a.expected)};
}

}  // namespace

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

void handicap_row(const float* score, const float* variance, float prior, int count, float* out) {
  for (int i = 0; i < count; ++i) {
    const float v = variance[i];
    out[i] = score[i] + (v > 0.0F ? 2.0F * v / (prior + std::sqrt(prior * prior + 4.0F * v)) : 0.0F);
  }
}

void optimism_row(const float* const* risks, const float* const* variances, int entries, int count, float* out) {
  for (int x = 0; x < count; ++x) {
    Least least = {risks[0][x], variances[0][x], risks[0][x]};
    for (int e = 1; e < entries; ++e) least = lesser(least, {risks[e][x], variances[e][x], risks[e][x]});
    out[x] = std::max(least.expected - least.mean, 0.0F);
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
