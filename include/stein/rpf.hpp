// SPDX-License-Identifier: Apache-2.0
//
// Random parameter filtering: the one filter that sees samples, not pixels. It asks how much the colour and the
// features of the samples around a pixel depend on what the renderer drew at random, and how much on where they are in
// the image, and averages over what is random. docs/filters/rpf.md.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "stein/execution.hpp"
#include "stein/plane.hpp"

namespace stein {

/// Channels of a sample that belong together.
struct SampleGroup {
  enum class Kind : std::uint8_t {
    kFeature,  ///< "normal", "position2", ...
    kRandom,   ///< what the sample was drawn with: "random.lens"; "random.pixel" is the position within the pixel
    kIgnored,  ///< skipped
  };
  Kind kind = Kind::kFeature;
  std::string name;
  int channels = 0;  ///< >= 1
};

/// Raw samples, row by row from the top. A sample is R, G, B and then the channels of the groups, in their order.
struct SampleSource {
  int width = 0;
  int height = 0;
  std::vector<SampleGroup> groups;
  /// The next row: how many samples each of its `width` pixels has, and those of the first pixel, of the next, ...
  /// Called `height` times, one call at a time. May throw.
  std::function<void(std::vector<std::uint32_t>& counts, std::vector<float>& samples)> next_row;
};

/// RPF (Sen, Darabi 2012); section and equation numbers are the paper's.
struct RpfParams {
  static constexpr std::string_view kName = "rpf";

  /// Widths of the passes' boxes, odd, each [3..63] px; 1 to 4 passes. Sec. 4.2
  std::vector<int> boxes = {55, 35, 17, 7};
  /// Neighbours that are drawn in each pass, as a fraction of the box's samples; one per box, [0.001..1].
  std::vector<float> shares = {0.02F, 0.04F, 0.3F, 0.5F};
  /// sigma_8^2 of sec. 4.5.1, [1e-6..10]: kRpfDetail or kRpfNoisy.
  float variance = 0.02F;
  /// Standard deviations of the pixel's own samples within which a neighbour's features must lie, [0.1..1000]; the
  /// second is for features that vary over any surface (position, depth). Sec. 4.3.1
  float cluster_deviations = 3.0F;
  float location_deviations = 30.0F;
  /// What other features may differ by in any case, [0..1e6].
  float least_deviation = 0.1F;
  /// Growth of the random parameters' part in alpha and beta from pass to pass, [0..1]. Sec. 4.4.2
  float pass_growth = 0.1F;
  /// Names of the features and of the random parameters to use; empty: all.
  std::vector<std::string> features;
  std::vector<std::string> randoms;

  std::uint64_t seed = 1;  ///< of the neighbours that are drawn

  /// @throws Error kInvalidArgument naming the parameter, its value and its range.
  void check() const;
};

/// Settings of RpfParams::variance.
inline constexpr float kRpfDetail = 0.002F;
inline constexpr float kRpfNoisy = 0.02F;  ///< indoor path tracing

/// Rows of the result, from the top.
struct RpfBand {
  int y = 0;  ///< of the views' first row
  std::array<ConstPlaneView, 3> colour;
};

struct RpfReport {
  std::int64_t samples = 0;       ///< that were used
  std::int64_t rejected = 0;      ///< whose colour is not finite
  std::int64_t repaired = 0;      ///< with a feature or random parameter that is not finite: it counts as 0
  std::int64_t empty_pixels = 0;  ///< without samples: they get the mean of their surroundings
  std::vector<std::string> features;
  std::vector<std::string> randoms;
};

using RpfSink = std::function<void(const RpfBand& band)>;

/// @throws Error kInvalidArgument, kInvalidFrame, kCancelled; what the source and the sink throw.
RpfReport filter_samples(const SampleSource& source, const RpfParams& params, const Execution& execution,
                         const RpfSink& sink);

}  // namespace stein
