// SPDX-License-Identifier: Apache-2.0
//
// Single pixels in which a feature is unusable, as on the rim of a lamp: without it nothing would hold the light of
// such a pixel back from its neighbours.
#pragma once

#include <array>
#include <optional>

#include "stein/frame.hpp"

namespace stein {

inline constexpr float kMostSamples = 1e9F;  ///< that are reckoned with

/// What a feature is taken to be, in the frame's units.
struct FeatureFill {
  std::array<float, 4> mean{};   ///< per channel
  float sample_variance = 0.0F;  ///< of the group, the mean over its channels
};

/// The pixels (x + i, y), i in [0, count), of a feature.
class FeatureHoles {
 public:
  static constexpr int kMostPixels = 512;
  FeatureHoles(const Frame& frame, const Feature& feature, int y, int x, int count);

  /// Whether pixel i is unusable.
  [[nodiscard]] bool is_hole(int i) const noexcept { return usable_[1][i + 1] == 0.0F; }
  /// The mean of the pixels around it and their variance, their differences included; none where the feature is
  /// unusable in more than half of them.
  [[nodiscard]] std::optional<FeatureFill> fill(int i) const;

 private:
  [[nodiscard]] bool is_inside(int x, int y) const noexcept {
    return x >= 0 && x < frame_.width && y >= 0 && y < frame_.height;
  }

  const Frame& frame_;
  const Feature& feature_;
  int x_;
  int y_;
  float usable_[3][kMostPixels + 2] = {};  // of the rows above, at and below, from x - 1 on; 0 beyond the image
};

}  // namespace stein
