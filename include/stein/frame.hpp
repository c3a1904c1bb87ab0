// SPDX-License-Identifier: Apache-2.0
//
// What a renderer hands over. All variances and covariances here are OF THE MEAN (sample variance / n).
// Colours are linear, scene-referred, unbounded above, and may be negative.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "stein/plane.hpp"

#pragma GCC visibility push(default)
namespace stein {

/// A named group of 1..4 channels of the G-buffer: normal 3, albedo 3, depth 1, position 3, visibility 1, or any other.
struct Feature {
  std::string name;
  std::vector<ConstPlaneView> mean;      ///< 1..4 channels
  std::vector<ConstPlaneView> variance;  ///< of the mean, one per channel; empty: the feature is taken as free of noise
  /// Covariance of the means of colour channel c and channel k of this feature at [c * mean.size() + k]; empty if
  /// unknown.
  std::vector<ConstPlaneView> colour_covariance;
};

/// Further planes of the image that are to be filtered as the colour is: with the weights that were found for it.
///
/// Three channels are light: what the parts of the colour (diffuse and specular, light groups) sum up to before, they
/// do after. One channel is alpha or another share of the pixel's samples. Colour and layers are premultiplied.
struct Layer {
  std::string name;  ///< of the planes, too: "key" has key.R, key.G and key.B; one channel is "A" itself
  std::vector<ConstPlaneView> mean;  ///< 3 channels, or 1
};

/// One noisy image with everything that is known about its noise. All planes have the size width x height.
struct Frame {
  int width = 0;
  int height = 0;
  std::array<ConstPlaneView, 3> colour;           ///< R, G, B mean
  std::array<ConstPlaneView, 3> colour_variance;  ///< of the mean, >= 0
  /// Cov(R,G), Cov(R,B), Cov(G,B) of the means; absent if unknown.
  std::array<ConstPlaneView, 3> colour_covariance;
  ConstPlaneView sample_count;     ///< n per pixel, 0 = no data; absent: `uniform_sample_count` holds for every pixel
  float uniform_sample_count = 0;  ///< used where `sample_count` is absent; must then be >= 1
  /// Of the variances and covariances, where they do not come from single samples: K - 1 for the spread of K renders.
  /// 0: n - 1 in each pixel.
  float degrees_of_freedom = 0;
  std::vector<Feature> features;
  std::vector<Layer> layers;
  std::string origin;  ///< where it came from (a file name); only used in messages
};

/// The first value found that cannot be used.
struct BadValue {
  std::string plane;  ///< such as "variance.G"
  int x = 0;
  int y = 0;
  float value = 0;
};

/// What `inspect` counted.
struct FrameReport {
  /// Pixels without usable colour: non-finite mean or variance (or a mean beyond 1e15, a variance beyond 1e30),
  /// negative variance, or no samples. They have no weight as sources and are filled from their neighbours.
  std::int64_t invalid_pixels = 0;
  BadValue first_invalid;  ///< in row order; meaningful if invalid_pixels > 0
  /// Per feature: pixels where the mean or variance is unusable; the feature is left out of distances of those pixels.
  std::vector<std::int64_t> bad_feature_pixels;
  std::vector<BadValue> first_bad_feature;  ///< per feature; meaningful if its count is > 0
  /// Pixels with a covariance that is no number, though colour and feature are usable; it counts as 0 there.
  std::int64_t bad_covariance_pixels = 0;
  BadValue first_bad_covariance;  ///< meaningful if bad_covariance_pixels > 0
  /// Per layer: pixels where it is unusable though the colour is usable. They are filled from the layer's neighbours.
  std::vector<std::int64_t> bad_layer_pixels;
  std::vector<BadValue> first_bad_layer;  ///< per layer; meaningful if its count is > 0
  std::int64_t single_sample_pixels = 0;  ///< n = 1: a variance given there cannot come from the samples
};

/// Checks the structure of a frame: sizes, presence of required planes, channel counts, unique names.
/// @throws Error kInvalidFrame naming the plane and what to do.
void check(const Frame& frame);

/// `check`, then scans every plane that the filters read. O(pixels * planes).
[[nodiscard]] FrameReport inspect(const Frame& frame);

/// `inspect`, then throws on the first pixel or feature value that would be repaired.
/// @throws Error kInvalidFrame naming plane, pixel and value.
void check_strict(const Frame& frame);

/// Every plane that the frame has, under its name in files (docs/inputs.md).
[[nodiscard]] std::vector<std::pair<std::string, ConstPlaneView>> named_planes(const Frame& frame);

/// "normal.variance.X" and the like.
[[nodiscard]] std::string plane_name(const Feature& feature, std::size_t channel, bool is_variance);

/// "key.G", or the layer's name where it has one channel.
[[nodiscard]] std::string plane_name(const Layer& layer, std::size_t channel);

}  // namespace stein
#pragma GCC visibility pop
