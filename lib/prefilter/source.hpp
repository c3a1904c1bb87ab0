// SPDX-License-Identifier: Apache-2.0
//
// The frame as the filters see it: invalid pixels filled and masked, features normalised and with per-sample variances.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/validity.hpp"
#include "stein/frame.hpp"

namespace stein {

/// Value of an invalid pixel, taken from the nearest valid ones.
struct FilledPixel {
  int x = 0;
  int y = 0;
  std::array<float, 3> colour{};
};

/// Fills from the rim of every hole inwards: each pixel gets the mean of its already known 8 neighbours. Row order. O(pixels).
/// @throws Error kInvalidFrame if no pixel at all is valid.
[[nodiscard]] std::vector<FilledPixel> fill_invalid(const Frame& frame);

/// What to divide a feature by so that its distances are comparable between scenes: 1 for features that are bounded by
/// nature (normal, albedo, visibility), the 99.9 % quantile for depth, the largest channel's 0.1-99.9 % range for others.
[[nodiscard]] float feature_range(const Feature& feature);

class Source {
 public:
  /// Views `frame`, which must outlive this.
  Source(const Frame& frame, const FrameReport& report);

  [[nodiscard]] const Frame& frame() const noexcept { return frame_; }
  [[nodiscard]] float feature_scale(std::size_t feature) const noexcept { return feature_scales_[feature]; }
  [[nodiscard]] const std::vector<FilledPixel>& filled() const noexcept { return filled_; }

  /// Colour mean, invalid pixels filled.
  void colour_row(std::size_t channel, int y, int x, int count, float* out) const;
  /// Variance of the mean, 0 at invalid pixels.
  void variance_row(std::size_t channel, int y, int x, int count, float* out) const;
  /// 1 at valid pixels, 0 at invalid ones.
  void mask_row(int y, int x, int count, float* out) const;
  /// Feature means times `factor`, one row per channel, and the per-sample variance of the group (the mean over its channels),
  /// all in normalised units. Where the feature is unusable: means 0 and a variance that takes it out of any distance.
  void feature_row(std::size_t feature, float factor, int y, int x, int count, float* const* means, float* variance) const;

 private:
  [[nodiscard]] const FilledPixel* first_filled(int y, int x) const;

  const Frame& frame_;
  std::vector<float> feature_scales_;
  std::vector<FilledPixel> filled_;
  std::vector<std::uint8_t> feature_has_bad_;
};

}  // namespace stein
