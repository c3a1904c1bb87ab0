// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stein/frame.hpp"

namespace stein::fuzz {

/// Every pixel of every plane is read once: the sanitizers see what was never written or lies outside.
inline void look_at(const ConstPlaneView& view) {
  volatile float sum = 0;
  for (int y = 0; y < view.height(); ++y) {
    for (int x = 0; x < view.width(); ++x) sum = sum + view.at(x, y);
  }
}

inline void look_at(const Frame& frame) {
  for (std::size_t c = 0; c < 3; ++c) {
    look_at(frame.colour[c]);
    look_at(frame.colour_variance[c]);
  }
  for (const Feature& feature : frame.features) {
    for (const auto* views : {&feature.mean, &feature.variance, &feature.colour_covariance}) {
      for (const ConstPlaneView& view : *views) look_at(view);
    }
  }
}

}  // namespace stein::fuzz
