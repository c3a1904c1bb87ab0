// SPDX-License-Identifier: Apache-2.0
//
// The main job: a noisy frame in; a clean image, the error it still has, and where samples are worth most, out.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stein/candidate.hpp"
#include "stein/density.hpp"
#include "stein/execution.hpp"
#include "stein/filters.hpp"
#include "stein/frame.hpp"
#include "stein/plane.hpp"

#pragma GCC visibility push(default)
namespace stein {

/// How the candidates' estimated errors become one image.
enum class Selection : std::uint8_t {
  kArgmin,    ///< SBF sec. 4.2: the candidate of least smoothed risk
  kEvidence,  ///< what is best for the image, unless local evidence is stronger than its standard error; and a mixture
              ///< near the borders of two choices
};

/// How the error of a candidate is estimated. All but kAuto are unbiased for noise that is Gaussian and of the
/// variances given.
enum class Risk : std::uint8_t {
  /// The best that filter and frame allow, see FilterShare::risk. Where it is kJoint, the cross-bilateral and the
  /// cross-NLM bank take noise that comes in few large events, as on the rims of lamps, for what it is (docs/risk.md).
  kAuto,
  kPlain,       ///< SURE in closed form, SBF Eq. 2: colour channels and features err independently
  kJoint,       ///< joint SURE in closed form, Joint SURE Eq. 2: with the frame's covariances, which it must have
  kMonteCarlo,  ///< joint SURE from runs of the filter on perturbed input; plain SURE where there are no covariances
};

/// Monte Carlo estimate of a risk: the divergence is the mean over `draws` runs of b (F(y + step b) - F(y)) / step,
/// with b of the frame's own noise.
struct MonteCarloParams {
  int draws = 1;       ///< [1..16] runs of the filter beside its own
  float step = 0.05F;  ///< [1e-3..1] standard deviations of the noise
  std::uint64_t seed = 1;
};

/// Fireflies: single pixels whose brightness neither their neighbours nor their own samples support
/// (docs/filters/outliers.md).
struct OutlierParams {
  bool enabled = true;   ///< false: every valid pixel enters the filters as it is
  float excess = 2.0F;   ///< [0..100] standard errors of the brightest neighbour by which an outlier exceeds it
  float support = 2.0F;  ///< [0.001..100] own standard errors by which a pixel must exceed it to be believed
  /// [0..100] px: standard deviation of the Gaussian by which what an outlier lost is given back to the result around
  /// it, so that the image's sum stays; 0: it is lost.
  float spread = 8.0F;
};

struct DenoiseParams {
  /// One to kMaxFilters. Of each, its candidates are mixed to a picture by `selection`; the pictures of several, and
  /// the input, are mixed to the one of least estimated error (docs/selection.md).
  std::vector<FilterSpec> filters = filters_of(Quality::kDefault);
  /// Images of other denoisers that are mixed with those of the filters; of both together at most kMaxFilters. The
  /// frame can have no layers then, which nobody but stein's own filters knows how to filter alike.
  std::vector<ExternalCandidate> candidates;
  /// One more picture: adaptive order on what the filters of Quality::kDefault make of the frame, with the estimated
  /// error as its variance. Takes about four times the time of those.
  bool second_pass = false;
  Risk risk = Risk::kAuto;
  MonteCarloParams monte_carlo;  ///< read where the risk is estimated that way
  OutlierParams outliers;
  Selection selection = Selection::kEvidence;
  float strength =
      1.0F;  ///< [0..1]: 1 the reconstruction, 0 the input; between: a linear mix. The error is that of the mix.
  /// Throw on the first unusable pixel or feature value instead of repairing and counting it.
  bool strict = false;
  DensityParams density;
  /// Luminance of the frame's RGB; the default is Rec. 709.
  std::array<float, 3> luminance_weights = {0.2126F, 0.7152F, 0.0722F};
  Execution execution;
};

/// Wall-clock seconds of one stage.
struct StageSeconds {
  std::string name;
  double seconds = 0;
};

/// One filter's part in the result.
struct FilterShare {
  std::string name;
  double weight = 0;  ///< mean over the image of its weight in the mixture
  /// Estimated of its picture alone, as DenoiseReport::mean_relative_error of the mixture (docs/risk.md); a lower bound
  /// as far as it has no weight. None where `strength` is not 1.
  std::optional<double> mean_relative_error;
  std::string risk;         ///< the risk estimate that was used, such as "joint SURE"
  std::string risk_reason;  ///< why that one
};

struct DenoiseReport {
  FrameReport frame;
  std::int64_t outlier_pixels = 0;      ///< pixels that were scaled down before filtering
  double outlier_energy = 0;            ///< what that kept out of the filters, as a fraction of the image's sum
  std::vector<std::string> candidates;  ///< entry names; index = value of the choice plane; 0 is the unfiltered input
  std::vector<double> choice_share;     ///< fraction of pixels whose largest weight is that entry's
  std::vector<FilterShare> filters;     ///< one for each filter, then for each external candidate, in their order
  /// Mean over the pixels that have a usable colour of the estimated squared error, per channel, >= 0.
  std::array<double, 3> mean_error{};
  /// The same over all channels, relative to result^2 + 0.01 or, where that is more, to three times the error around:
  /// what relMSE is expected to be (docs/risk.md).
  double mean_relative_error = 0;
  std::vector<std::string> warnings;  ///< in words, for people
  std::vector<StageSeconds> stages;
  std::string instruction_set;     ///< of the kernels, such as "AVX3"
  std::int64_t scratch_bytes = 0;  ///< of scratch files that Execution::memory needed so far
};

/// A layer of the frame after the filter.
struct FilteredLayer {
  std::string name;
  std::vector<Plane> mean;  ///< as many channels as the frame has
};

/// As that of the frame's layer.
[[nodiscard]] std::string plane_name(const FilteredLayer& layer, std::size_t channel);

/// All planes have the frame's size; those of colour and error are each a Plane::triple.
struct DenoiseResult {
  std::array<Plane, 3> colour;
  /// Estimated squared error of `colour`, >= 0: of each pixel the mean over all pixels of the image whose noise is left
  /// to the same degree (docs/risk.md).
  std::array<Plane, 3> error;
  /// Index of the entry with the largest weight, see DenoiseReport::candidates; -1 where the pixel had no usable colour
  /// and was filled.
  Plane choice;
  Plane density;  ///< SBF Eq. 9, relative: >= 0, mean 1 (all 1 where nothing is left to gain anywhere)
  std::vector<FilteredLayer> layers;  ///< those of the frame, in its order
  DenoiseReport report;
};

/// Filters, estimates the risk of every candidate, selects, and derives the density. Deterministic: bit-identical for
/// any thread count, tile size and memory limit on one instruction set. Memory beyond the result: windows of rows, not
/// images (but 4 bytes per pixel while invalid pixels are filled, and of several filters 28 bytes each).
/// @throws Error kInvalidFrame, kInvalidArgument, kCancelled.
[[nodiscard]] DenoiseResult denoise(const Frame& frame, const DenoiseParams& params = {});

/// @throws Error kInvalidArgument naming the parameter, its value and its range.
void check(const DenoiseParams& params);

}  // namespace stein
#pragma GCC visibility pop
