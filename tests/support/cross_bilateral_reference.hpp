// SPDX-License-Identifier: Apache-2.0
//
// The cross-bilateral filter as the paper prints it, in double, one pixel and one scale at a time.
#pragma once

#include <array>

#include "prefilter/source.hpp"
#include "stein/filters.hpp"

namespace stein::test {

struct PixelResult {
  std::array<double, 3> result{};
  std::array<double, 3> derivative{};  ///< dF_c / dc_c of the pixel itself
};

/// SBF Eq. 4 to 8. `nudge` is added to the colour of the pixel itself: for finite differences.
PixelResult cross_bilateral_reference(const CrossBilateralParams& params, const Source& source, double sigma_s, int x,
                                      int y, const std::array<double, 3>& nudge = {});

}  // namespace stein::test
