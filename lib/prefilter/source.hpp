// SPDX-License-Identifier: Apache-2.0
//
// The frame as the filters see it: invalid pixels filled and masked, features normalised and with per-sample variances.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/validity.hpp"
#include "prefilter/replaced_pixels.hpp"
#include "stein/candidate.hpp"
#include "stein/frame.hpp"
#include "stein/memory.hpp"

namespace stein {

/// Fills from the rim of every hole inwards: each pixel gets the mean of its already known 8 neighbours. Row order.
/// O(pixels).
/// @throws Error kInvalidFrame if no pixel at all is valid.
[[nodiscard]] std::vector<ReplacedPixel> fill_invalid(const Frame& frame, Memory* memory = nullptr);

/// The same for a layer, at pixels where it or the colour is unusable.
[[nodiscard]] std::vector<ReplacedPixel> fill_layer(const Frame& frame, const Layer& layer, Memory* memory = nullptr);

/// What to divide a feature by so that its distances are comparable between scenes: 1 for features that are bounded by
/// nature (normal, albedo, visibility), the 99.9 % quantile for depth, the largest channel's 0.1-99.9 % range for
/// others.
[[nodiscard]] float feature_range(const Feature& feature, const Memory* memory = nullptr);

class Source {
 public:
  /// Views `frame`, which must outlive this. `memory`: for what is made of it, see Execution::memory.
  Source(const Frame& frame, const FrameReport& report, Memory* memory = nullptr);

  /// The same frame, with colours and features moved by the perturbation; variances and scales stay what they are.
  [[nodiscard]] Source perturbed(const Perturbation& perturbation) const;

  /// Adds pixels that shall be seen with another colour; `pixels` in row order.
  void replace(const std::vector<ReplacedPixel>& pixels);

  [[nodiscard]] const Frame& frame() const noexcept { return frame_; }
  [[nodiscard]] Memory* memory() const noexcept { return memory_; }
  [[nodiscard]] const ReplacedPixels& replaced() const noexcept { return replaced_; }
  [[nodiscard]] float feature_scale(std::size_t feature) const noexcept { return feature_scales_[feature]; }

  /// Colour mean as the filters are to see it.
  void colour_row(std::size_t channel, int y, int x, int count, float* out) const;
  /// The same of all channels.
  void colour_rows(int y, int x, int count, float* const* out) const;
  /// Variance of the mean, 0 at replaced pixels: how far filters are to take colours for alike.
  void variance_row(std::size_t channel, int y, int x, int count, float* out) const;
  /// What an error estimate takes for the covariance of the colour that the filters see, in channel a, with the mean of
  /// the frame's, in channel b: the frame's own covariance, bounded by the two standard deviations, 0 where it is
  /// unknown; at outliers times their response; 0 at invalid pixels.
  void colour_covariance_row(std::size_t a, std::size_t b, int y, int x, int count, float* out) const;
  /// Covariance of the mean of a colour channel of the frame with the mean of channel k of a feature in normalised
  /// units, times `factor`; 0 and bounded as above, and 0 where the feature is unusable.
  void feature_covariance_row(std::size_t channel, std::size_t feature, std::size_t k, float factor, int y, int x,
                              int count, float* out) const;
  /// The direction b of a perturbed source, in a colour channel of the frame; 0 at invalid pixels.
  void direction_row(std::size_t channel, int y, int x, int count, float* out) const;
  /// The same in all channels.
  void direction_rows(int y, int x, int count, float* const* out) const;
  /// The same for channel k of a feature in normalised units, times `factor`.
  void feature_direction_row(std::size_t feature, std::size_t k, float factor, int y, int x, int count,
                             float* out) const;
  /// The frame's own colour mean and variance of the mean, for the risk; at invalid pixels the fill and 0.
  void input_row(std::size_t channel, int y, int x, int count, float* mean, float* variance) const;
  /// 1 at valid pixels, 0 at invalid ones.
  void mask_row(int y, int x, int count, float* out) const;
  /// Feature means times `factor`, one row per channel, and the per-sample variance of the group (the mean over its
  /// channels), all in normalised units; raised towards its neighbours' where it has few degrees of freedom. Where the
  /// feature is unusable: those of the pixels around (FeatureHoles), or means 0 and a variance that takes it out of any
  /// distance.
  void feature_row(std::size_t feature, float factor, int y, int x, int count, float* const* means,
                   float* variance) const;
  /// The same by themselves.
  void feature_sample_variance_row(std::size_t feature, int y, int x, int count, float* out) const;
  void feature_mean_rows(std::size_t feature, float factor, int y, int x, int count, float* const* means) const;
  /// Variance of the mean of channel k of a feature in normalised units. Where the feature is unusable: that of the
  /// pixels around (FeatureHoles), for all channels alike, or kNoInformation.
  void feature_variance_row(std::size_t feature, std::size_t k, int y, int x, int count, float* out) const;
  /// Variance of what is to count nothing: large against any normalised distance, and does not overflow with it.
  static constexpr float kNoInformation = 1e10F;
  /// To what means of features are cut off: the square of a difference stays finite, and far below kNoInformation.
  static constexpr float kLargestMean = 1e4F;

 private:
  class Directions;

  void input_variance_row(std::size_t channel, int y, int x, int count, float* out) const;
  void input_covariance_row(std::size_t a, std::size_t b, int y, int x, int count, const float* va, const float* vb,
                            float* out) const;
  /// From a change of the frame's colour to one of what the filters see.
  void scale_responses(int y, int x, int count, float* values) const;
  /// Sets to 0 what is where the feature is unusable, of one part of a row.
  void clear_unusable_row(std::size_t feature, int y, int x, int count, float* values) const;
  void group_variance_row(std::size_t feature, int y, int x, int count, float* out) const;
  void raise_variance_row(std::size_t feature, int y, int x, int count, float* variance) const;
  /// Calls visit(i, fill) for each pixel x + i of the row in which the feature is unusable.
  template <class Visit>
  void for_each_hole(std::size_t feature, int y, int x, int count, Visit visit) const;
  /// Calls visit(directions, start, n) for parts [x + start, x + start + n) of the row.
  template <class Visit>
  void for_each_direction(int y, int x, int count, Visit visit) const;
  void add_colour_step(const Directions& directions, std::size_t channel, int y, int x, int count, float* colour) const;
  void add_steps(std::size_t feature, float factor, int y, int x, int count, float* const* means) const;

  const Frame& frame_;
  Memory* memory_;
  std::vector<float> feature_scales_;
  std::vector<std::uint8_t> feature_has_bad_;
  ReplacedPixels replaced_;
  std::optional<Perturbation> perturbation_;
};

}  // namespace stein
