// SPDX-License-Identifier: Apache-2.0
//
// From risk maps to weights of the candidates, a row at a time.
#pragma once

namespace stein {

inline constexpr int kMaxEntries = 13;  ///< the unfiltered input and the candidates of a bank

/// Relative risk is clipped to +-kRiskLimit before it is smoothed: a single pixel's vote is bounded. For the choice
/// only; the error that is reported is not clipped.
inline constexpr float kRiskLimit = 1.0F;

/// Replaces the risks of `entries` maps by weights: 1 for the entry of least risk (the first of equals), 0 for the
/// others.
void argmin_row(float* const* maps, int entries, int count);

/// Index of the largest weight (the first of equals), as float.
void largest_row(const float* const* weights, int entries, int count, float* index);

}  // namespace stein
