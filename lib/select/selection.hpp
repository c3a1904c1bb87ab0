// SPDX-License-Identifier: Apache-2.0
//
// From risk maps to weights of the candidates, a row at a time.
#pragma once

namespace stein {

inline constexpr int kMaxEntries = 13;  ///< the unfiltered input and the candidates of a bank

/// Squared standard errors of weighted means of a map: `square` is the same mean of its squares, and `inverse_count`
/// makes of the variance that of the mean.
void standard_error_row(const float* mean, const float* square, const float* inverse_count, int count, float* out);

/// How far local evidence moves an estimate from what the image as a whole says: out = prior + lambda (mean - prior)
/// with lambda = max(0, 1 - s^2 / (mean - prior)^2), the positive-part James-Stein rule; `variance` is s^2.
void shrink_row(const float* mean, const float* variance, float prior, int count, float* out);

/// What an estimate with a prior >= 0 has against it when shrink_row() lets it compete with 0: that of mean m comes out
/// below 0 where m < -h, h = 2 s^2 / (p + sqrt(p^2 + 4 s^2)) with the prior p and the variance s^2. out = score + h: by
/// these the entries compete on equal terms.
void handicap_row(const float* score, const float* variance, float prior, int count, float* out);

/// How much too low the least of `entries` estimates is on average, since it may have come out least for its noise:
/// -E[noise of the least of r_k + noise_k], with independent normal noise of the `variances`. Of two, whose difference
/// has the standard deviation s, that is s phi(difference / s), phi the standard normal density; with more, Clark's
/// approximation.
void optimism_row(const float* const* risks, const float* const* variances, int entries, int count, float* out);

/// Replaces the risks of `entries` maps by weights: 1 for the entry of least risk (the first of equals), 0 for the
/// others.
void argmin_row(float* const* maps, int entries, int count);

/// Index of the largest weight (the first of equals), as float.
void largest_row(const float* const* weights, int entries, int count, float* index);

}  // namespace stein
