// SPDX-License-Identifier: Apache-2.0
//
// What was taken from outliers before filtering, given back to their surroundings afterwards.
#pragma once

#include <vector>

#include "prefilter/layer_source.hpp"
#include "prefilter/source.hpp"

namespace stein {

/// What an outlier lost, spread by a Gaussian that is cut at kReach standard deviations and at the image's borders, and
/// has the sum 1 there.
class OutlierEnergy {
 public:
  static constexpr float kReach = 2.5F;

  /// `sigma` in pixels; 0: nothing is given back. `source` and `layers` must outlive this; `source` has all its
  /// replaced pixels.
  OutlierEnergy(const Source& source, const LayerSource& layers, float sigma);

  /// Adds `factor` times what falls on pixels [x, x + count) of row y, in a channel of the colour.
  void add_colour(int channel, int y, int x, int count, float factor, float* out) const;
  /// Adds `factor` times what that makes of the covariance of the result with the pixel's own noise: of an outlier,
  /// with what it gets back of itself.
  void add_divergence(int channel, int y, int x, int count, float factor, float* out) const;
  /// As add_colour, in a channel of the layers.
  void add_layer(int channel, int y, int x, int count, float factor, float* out) const;

 private:
  struct Outlier {
    const ReplacedPixel* pixel;
    float inverse_sum;  // of the Gaussian within the image
  };
  [[nodiscard]] float gaussian(int distance) const noexcept {
    return gaussian_[static_cast<std::size_t>(distance + radius_)];
  }
  template <class Lost>
  void add(const Lost& lost, int y, int x, int count, float factor, float* out) const;

  const Source& source_;
  const LayerSource& layers_;
  int radius_;
  std::vector<float> gaussian_;  // at distances -radius_ to radius_
  std::vector<Outlier> outliers_;
  std::vector<std::size_t> first_in_row_;  // height + 1 indices into outliers_
};

}  // namespace stein
