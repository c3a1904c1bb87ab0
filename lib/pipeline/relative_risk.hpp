// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "filters/filter.hpp"
#include "risk/sure.hpp"

namespace stein {

/// Pixels of a row that are summed together, so that sums do not depend on tiles, which are made of whole blocks.
inline constexpr int kSumBlock = 16;

inline constexpr int kRelativeRiskLines = 6;  ///< of scratch memory

/// out[e][i]: relative risk of entry e at pixel (x0 + i, y), SURE (SBF Eq. 2) of each channel over G^2 + 0.01, mean
/// over the channels. Entry 0 is the unfiltered input. G is the same for all entries, the result of candidate `common`
/// as far as the pixel's mean and variance allow it: weights of their own would favour entries that are too bright, and
/// a noisy G correlates with the risk it weighs.
/// `lines`: kRelativeRiskLines rows of scratch, `pitch` apart.
void relative_risk_rows(const Source& source, const CandidateRows& candidates, int entries, int common,
                        const Rect& tile, int y, float* lines, std::ptrdiff_t pitch, float* const* out);

}  // namespace stein
