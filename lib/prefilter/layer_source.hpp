// SPDX-License-Identifier: Apache-2.0
//
// The frame's layers as the filters see them: changed where the colour is, and as the colour is.
#pragma once

#include <cstddef>
#include <vector>

#include "prefilter/replaced_pixels.hpp"
#include "prefilter/source.hpp"
#include "stein/frame.hpp"

namespace stein {

/// All channels of all layers, one after the other. Where parts of the colour are given as layers, what is done here
/// keeps their sum: they are filled where the colour is, and scaled down with it. A pixel that is unusable in a layer
/// alone is filled as well, which adds to the sum.
class LayerSource {
 public:
  /// Views `frame` and `source`, which must outlive this; `source` has all its replaced pixels.
  /// @throws Error kInvalidFrame for a layer without a usable pixel.
  LayerSource(const Frame& frame, const FrameReport& report, const Source& source);

  [[nodiscard]] int channels() const noexcept { return static_cast<int>(channels_.size()); }

  /// Of each channel: the colour channel that it is light of, or -1.
  [[nodiscard]] const int* colours() const noexcept { return colours_.data(); }

  /// What is filtered.
  void row(int channel, int y, int x, int count, float* out) const;
  /// The frame's own; filled, but with outliers as they are.
  void input_row(int channel, int y, int x, int count, float* out) const;

 private:
  struct Channel {
    ConstPlaneView plane;
    std::size_t layer = 0;
    std::size_t index = 0;  // within the layer
  };

  const Source& source_;
  std::vector<Channel> channels_;
  std::vector<int> colours_;
  std::vector<ReplacedPixels> filled_;  // per layer
};

}  // namespace stein
