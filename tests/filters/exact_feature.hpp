// SPDX-License-Identifier: Apache-2.0
//
// Regressions without ridge on the position and one exact feature.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "support/synthetic.hpp"

namespace stein::test {

inline constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};

/// With weights that do not depend on the colour.
inline AdaptiveOrderParams plain_fit(std::vector<int> orders) {
  AdaptiveOrderParams params;
  params.orders = std::move(orders);
  params.error = OrderError::kRisk;
  params.range_sigmas.clear();
  params.spatial_sigma = 0;
  params.window_radius = 4;
  params.noise_threshold = 10;
  params.ridge = 0;
  params.curvature_ridge = params.ridge;
  return params;
}

/// Of the frame's `visibility`; it has nothing to do with the position.
inline void fill_exact_feature(OwnedFrame& frame, std::uint64_t seed) {
  Random random(seed);
  for (int y = 0; y < frame.frame().height; ++y) {
    for (int x = 0; x < frame.frame().width; ++x) {
      frame.at("visibility.V", x, y) = static_cast<float>(random.uniform());
      frame.at("visibility.variance.V", x, y) = 0;
    }
  }
}

}  // namespace stein::test
