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

#pragma GCC visibility push(default)
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

/// What becomes of a sample that still differs from its pixel's mean by more than a standard deviation (or as many as
/// are set) after a pass.
enum class RpfSpikes : std::uint8_t {
  kKeep,   ///< nothing
  kReset,  ///< it gets the mean (sec. 4.5.2); what it held beyond that is lost
  kShare,  ///< it gets the mean, and all samples of the pixel share what that took away: the pixel's mean stays
};

/// What differences of filtered colours are measured in.
enum class RpfColourUnit : std::uint8_t {
  kFiltered,  ///< standard deviations of the neighbourhood's filtered colours (sec. 4.3.2)
  kRendered,  ///< of its colours as they were rendered: differences fade as the noise does
};

/// RPF (Sen, Darabi 2012); section and equation numbers are the paper's. Defaults are the paper's where it gives a
/// number that held in measurements (docs/filters/rpf.md); paper_rpf() has all as printed.
struct RpfParams {
  static constexpr std::string_view kName = "rpf";

  /// Widths of the passes' boxes, odd, each [3..127] px; 1 to 4 passes. Sec. 4.2
  std::vector<int> boxes = {55, 35, 17, 7};
  /// Samples of the neighbourhood, the pixel's own included, as a fraction of all that a box has; one per box, (0..1].
  std::vector<float> shares = {0.015F, 0.03F, 0.12F, 0.4F};

  /// sigma_8^2 of sec. 4.5.1 for colours and for features, [1e-6..100]: see kRpfNoisy and kRpfDetail. The paper
  /// has one for both.
  float colour_variance = 0.2F;
  float feature_variance = 0.002F;
  /// Least 1 - W_c^r that divides the variance of the features, but for those in `unclustered`, [0..1]; 0: the paper's.
  float least_feature_share = 0.3F;

  /// Standard deviations of the pixel's own samples within which a neighbour's features must lie, [0.1..1e6]; the
  /// second is for features that vary over any surface (position, depth). The paper has 3. Sec. 4.3.1
  float cluster_deviations = 2.0F;
  float location_deviations = 20.0F;
  /// What other features may differ by in any case, [0..1e6].
  float least_deviation = 0.2F;
  /// Features of what a path meets later. They are random themselves, so they reject no neighbour: what is rare in them
  /// would be rejected.
  std::vector<std::string> unclustered = {"position2", "normal2", "visibility"};

  /// How much of the mutual information that independent vectors of as many samples have on average is taken off,
  /// [0..1]; 0: the paper's.
  float information_floor = 1.0F;
  /// Growth of the random parameters' part in alpha and beta from pass to pass, [0..1]. The paper gives no number.
  /// Sec. 4.4.2
  float pass_growth = 0.0F;
  RpfColourUnit colour_unit = RpfColourUnit::kRendered;
  RpfSpikes spikes = RpfSpikes::kShare;
  float spike_deviations = 1.0F;  ///< [0..100] standard deviations beyond which a sample is a spike. Sec. 4.5.2

  /// Names of the features and of the random parameters to use; empty: all.
  std::vector<std::string> features;
  std::vector<std::string> randoms;
  /// Whether the direction from `position` to `position2` stands in for what chose it, where the samples have no random
  /// parameter beside those of pixel, lens and time.
  bool first_bounce = true;

  /// Frames before and after (sec. 6.4): how far from a pixel its like is looked for in them. [0..32] px
  int search_radius = 8;

  std::uint64_t seed = 1;  ///< of the neighbours that are drawn, and of the perturbations
  /// Runs on perturbed samples that the estimated error is made of, [0..16]; 0: no error is estimated.
  int draws = 0;
  float step = 0.05F;  ///< of the perturbation, [1e-3..1] standard deviations of a pixel's noise

  /// The passes lose light where few samples hold most of it. What a pixel lost is estimated from the pixels around it,
  /// under a Gaussian of this deviation, and given back. [0..16] px; 0: lost it is, as in the paper.
  float return_sigma = 5.0F;

  /// @throws Error kInvalidArgument naming the parameter, its value and its range.
  void check() const;
};

/// The two settings of sigma_8^2 in the paper.
inline constexpr float kRpfDetail = 0.002F;
inline constexpr float kRpfNoisy = 0.02F;  ///< "noisy scenes", such as indoor path tracing

/// Everything as printed. `variance`: kRpfDetail or kRpfNoisy.
[[nodiscard]] RpfParams paper_rpf(float variance);

/// Rows of the result, from the top. Views are valid during the call.
struct RpfBand {
  int y = 0;  ///< of the views' first row
  std::array<ConstPlaneView, 3> colour;
  /// Estimated squared error of `colour`, smoothed; can be below 0, which keeps its mean unbiased. Absent unless asked
  /// for.
  std::array<ConstPlaneView, 3> error;
};

struct RpfReport {
  std::int64_t samples = 0;            ///< that were used, adjacent frames' not counted
  std::int64_t rejected = 0;           ///< whose colour is not finite (or beyond 1e15)
  std::int64_t repaired = 0;           ///< with a feature or random parameter that is not finite: it counts as 0
  std::int64_t empty_pixels = 0;       ///< without samples: they get the mean of those nearest to them
  std::int64_t single_pixels = 0;      ///< with one sample: nothing is known of their noise
  std::vector<std::string> features;   ///< that were used
  std::vector<std::string> randoms;    ///< random parameters that were used
  std::array<double, 3> mean_error{};  ///< mean over the image of the estimated error before it is smoothed
  std::int64_t scratch_bytes = 0;      ///< most that lay in scratch files at a time: Execution::memory
  std::vector<std::string> warnings;   ///< in words, for people
};

using RpfSink = std::function<void(const RpfBand& band)>;

/// Filters samples. Reads rows as it goes and hands out results as they are done, so that memory holds a window of rows
/// (about the sum of the boxes' widths), not the image; under a limit (Execution::memory) rows that do not fit lie in
/// scratch files. Bit-identical for any number of threads, and with any limit. `adjacent`: the frames before and after,
/// of the same size and with the same groups; what they have rendered helps where it looks alike.
/// @throws Error kInvalidArgument, kInvalidFrame, kCancelled; what the sources and the sink throw.
RpfReport filter_samples(const SampleSource& source, const RpfParams& params, const Execution& execution,
                         const RpfSink& sink, const std::vector<SampleSource>& adjacent = {});

}  // namespace stein
#pragma GCC visibility pop
