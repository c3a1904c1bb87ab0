// SPDX-License-Identifier: Apache-2.0
//
// The cross-bilateral filter as the paper prints it, in double, one pixel and one scale at a time.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "filters/guide_rows.hpp"
#include "prefilter/source.hpp"
#include "stein/filters.hpp"

namespace stein::test {

/// Added to the pixel's own means: for finite differences.
struct Nudge {
  std::array<double, 3> colour{};
  std::vector<std::vector<double>> features;  ///< [feature][channel], in the frame's units; empty: none
};

bool is_valid(const Frame& frame, int x, int y);

/// D^2 of SBF Eq. 6 over 2 sigma_f^2, summed over the features; the nudge moves pixel i.
double feature_distance(const FeatureGuides& guides, const Source& source, int xi, int yi, int xj, int yj,
                        const Nudge& nudge);

/// SBF Eq. 4 to 6.
std::array<double, 3> cross_bilateral_reference(const CrossBilateralParams& params, const Source& source,
                                                double sigma_s, int x, int y, const Nudge& nudge = {});

/// Joint SURE Eq. 2, both derivative terms of each channel, by central differences of the filter's result at one pixel;
/// the plain form takes each channel's own variance only.
using NudgedFilter = std::function<std::array<double, 3>(const Nudge&)>;
std::array<double, 3> divergence_reference(const Source& source, int x, int y, Divergence divergence,
                                           const NudgedFilter& filter);

/// The same for the filter above.
std::array<double, 3> divergence_reference(const CrossBilateralParams& params, const Source& source, double sigma_s,
                                           int x, int y, Divergence divergence);

}  // namespace stein::test
