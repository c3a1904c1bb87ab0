// SPDX-License-Identifier: Apache-2.0
//
// Cross non-local means as the equations say, in double, one pixel and one sigma_r at a time.
#pragma once

#include "support/cross_bilateral_reference.hpp"

namespace stein::test {

/// SBF Eq. 10 and 5, with either distance.
std::array<double, 3> cross_nlm_reference(const CrossNlmParams& params, const Source& source, double sigma_r, int x,
                                          int y, const Nudge& nudge = {});

/// Joint SURE Eq. 2 by central differences of the above.
std::array<double, 3> divergence_reference(const CrossNlmParams& params, const Source& source, double sigma_r, int x,
                                           int y, Divergence divergence);

}  // namespace stein::test
