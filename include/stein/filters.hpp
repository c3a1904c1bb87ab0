// SPDX-License-Identifier: Apache-2.0
//
// The filters: one aggregate of parameters each, and FilterSpec, the list of all of them. The command line, the
// documentation's table, the benchmarks and the conformance tests are driven by this list.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#pragma GCC visibility push(default)
namespace stein {

/// How strongly a feature guides: sigma_f of SBF Eq. 4, in units of the normalised distance D of Eq. 6.
struct FeatureSigma {
  std::string name;
  float sigma = 0;  ///< > 0; 0: the feature is not used
};

/// Which features guide a filter, and the smoothing of its risk: the feature terms of SBF Eq. 4 and 6.
struct FeatureGuides {
  /// sigma_f by feature name. A feature of the frame that is not listed uses `other_feature_sigma`.
  std::vector<FeatureSigma> feature_sigmas = {{"normal", 0.8F},   {"albedo", 0.25F},   {"depth", 0.6F},
                                              {"position", 0.0F}, {"position2", 0.0F}, {"normal2", 0.0F}};
  float other_feature_sigma = 0.6F;  ///< >= 0; 0: features that are not listed are not used

  /// Lower bound of the sum of two per-sample variances in Eq. 6. [1e-6..1]
  float min_feature_variance = 0.01F;

  /// Features are smoothed before they guide: each by non-local means of its own 3x3 patches, over a window of this
  /// radius. [0..5] px; 0: they guide as they are. Banks that are guided so have no closed derivative.
  int smoothing_radius = 0;

  /// The sigma that a feature of this name guides with; 0: not at all.
  [[nodiscard]] float sigma_of(std::string_view feature) const;
  /// @throws Error kInvalidArgument naming `owner`, the parameter, its value and its range.
  void check(const std::string& owner) const;
};

/// Cross-bilateral bank, SBF (Li, Wu, Chuang 2012) Eq. 4-8 and 13: one candidate per spatial scale.
struct CrossBilateralParams {
  static constexpr std::string_view kName = "cross-bilateral";
  static constexpr bool kHasDerivative = true;  ///< the risk has a closed form
  static constexpr bool kCountsEvents = true;   ///< which takes noise of few events as such with Risk::kAuto

  /// sigma_s of the candidates, ascending, each [0.5..16] px, at most 8.
  std::vector<float> spatial_sigmas = {1.0F, 1.41421356F, 2.0F, 2.82842712F, 4.0F, 5.65685425F, 8.0F};

  /// sigma_r: range term on the colour, in units of radiance; 0: off (as in the paper's results).
  float range_sigma = 0.0F;

  FeatureGuides guides;

  void check() const;                                              ///< see stein::check
  [[nodiscard]] std::vector<std::string> candidate_names() const;  ///< without the unfiltered input
};

/// The three scales that the paper uses between sampling iterations (SBF sec. 5.1).
[[nodiscard]] CrossBilateralParams intermediate_cross_bilateral();

/// How cross non-local means measures the distance of two pixels of a patch.
enum class PatchDistance : std::uint8_t {
  kAbsolute,            ///< squared difference of the colours, SBF Eq. 10; sigma_r is in units of radiance
  kVarianceNormalised,  ///< what exceeds the difference that noise explains, over the noise; independent of exposure
};

/// Cross non-local means bank, SBF sec. 5.4, Eq. 10 and 14: one candidate per range sigma.
struct CrossNlmParams {
  static constexpr std::string_view kName = "cross-nlm";
  static constexpr bool kHasDerivative = true;
  static constexpr bool kCountsEvents = true;

  /// sigma_r of the candidates, ascending, each [1e-6..1e6], at most 12; in units of radiance with absolute distances.
  /// Steps of sqrt(2), to a millionth, are the fastest: a weight is the square of the next wider candidate's.
  std::vector<float> range_sigmas = {0.5F, 0.70710678F, 1.0F, 1.41421356F, 2.0F, 2.82842712F, 4.0F};

  PatchDistance distance = PatchDistance::kVarianceNormalised;
  int window_radius = 20;  ///< [1..32] px
  int patch_radius = 2;    ///< [0..4] px
  /// Patches are compared by colours blurred over 3x3 pixels with weights 1, patch_blur and patch_blur^2. [0..1]
  float patch_blur = 1.0F;

  FeatureGuides guides;

  void check() const;                                              ///< see stein::check
  [[nodiscard]] std::vector<std::string> candidate_names() const;  ///< without the unfiltered input
};

/// The smaller window for use between sampling iterations.
[[nodiscard]] CrossNlmParams intermediate_cross_nlm();

/// What the candidates of a regression are judged by.
enum class OrderError : std::uint8_t {
  kRisk,    ///< SURE, from the equivalent kernel and its derivative
  kTaylor,  ///< AOS Eq. 16: variance, and the bias that a fit of two orders more sees
};

/// Local polynomial regression on features, AOS (Yuan, Zheng, Zheng, Liu 2017) Eq. 6-16: one candidate per order and
/// range sigma.
struct AdaptiveOrderParams {
  static constexpr std::string_view kName = "adaptive-order";
  static constexpr bool kHasDerivative = true;

  /// Of the partial polynomials (AOS Eq. 7), ascending, of 0, 1 and 3; 0 is a weighted mean.
  std::vector<int> orders = {0, 1, 3};
  OrderError error = OrderError::kRisk;

  /// sigma_r of weights by patches of the colour, as CrossNlmParams' with normalised distances; empty: weights do not
  /// depend on the colour.
  std::vector<float> range_sigmas = {0.71F, 1.41F, 2.83F};
  float spatial_sigma = 0.0F;  ///< h of AOS Eq. 8, [0.5..100] px; 0: all of the window counts alike
  int window_radius = 9;       ///< [1..20] px
  int patch_radius = 2;        ///< as for CrossNlmParams
  float patch_blur = 1.0F;     ///< as for CrossNlmParams

  /// Directions of feature space count whose variance over the window is this many times that of their noise. [1..1e6]
  float noise_threshold = 2.0F;
  /// Pixels that speak against any slope: with a weight sum near this, polynomials come close to their mean. [0..1e6]
  float ridge = 0.3F;
  /// The same for powers 2 and 3. None: 30, but `ridge` with OrderError::kTaylor, whose bias is what higher powers see.
  std::optional<float> curvature_ridge;

  /// The features with a sigma are what is regressed on, at most 12 channels, smoothed in a way of their own; only the
  /// smoothing of the risk makes use of the sigma's value and of smoothing_radius.
  FeatureGuides guides;

  void check() const;                                              ///< see stein::check
  [[nodiscard]] std::vector<std::string> candidate_names() const;  ///< without the unfiltered input
};

/// The smaller window for use between sampling iterations (AOS sec. 6).
[[nodiscard]] AdaptiveOrderParams intermediate_adaptive_order();

/// Isotropic Gaussian bank, SBF sec. 5.4: no features, one candidate per spatial scale. A baseline.
struct GaussianParams {
  static constexpr std::string_view kName = "gaussian";
  static constexpr bool kHasDerivative = true;

  /// sigma_s of the candidates, ascending, each [0.5..16] px, at most 8.
  std::vector<float> spatial_sigmas = {1.0F, 1.41421356F, 2.0F, 2.82842712F, 4.0F, 5.65685425F, 8.0F};

  void check() const;                                              ///< see stein::check
  [[nodiscard]] std::vector<std::string> candidate_names() const;  ///< without the unfiltered input
};

/// The feature terms of the à-trous filters: smoothed, and wider than those of the cross-bilateral bank, as every level
/// weighs edges anew and the sigmas fall by a factor of 0.8 from level to level.
[[nodiscard]] FeatureGuides atrous_guides();

/// Edge-avoiding à-trous filter, SURE-À-Trous sec. 2.1: one candidate.
struct AtrousParams {
  static constexpr std::string_view kName = "atrous";
  static constexpr bool kHasDerivative = false;

  int levels = 5;  ///< [1..5]; level i has taps 2^i pixels apart

  /// Edges in the colour: standard deviations of the noise, as left at the level, that a difference may have.
  /// [0.1..100]; 0: only features stop.
  float value_sigma = 3.5F;

  FeatureGuides guides = atrous_guides();

  void check() const;                                              ///< see stein::check
  [[nodiscard]] std::vector<std::string> candidate_names() const;  ///< without the unfiltered input
};

/// The same with what each level removes, its detail, given back in part, SURE-À-Trous sec. 2.2: one candidate.
struct AtrousSureParams {
  static constexpr std::string_view kName = "atrous-sure";
  static constexpr bool kHasDerivative = false;

  int levels = 5;            ///< as for AtrousParams
  float value_sigma = 3.5F;  ///< as for AtrousParams
  FeatureGuides guides = atrous_guides();

  /// The share of the detail that is kept, [0..1], everywhere; none: by SURE for each pixel and level.
  std::optional<float> fixed_weight;

  /// Factor to the noise in SURE. 1: unbiased; above: detail must stand out from the noise to be kept. [0..100]
  float noise_margin = 5.0F;

  /// Shares are multiples of 1 / weight_steps, [0..100]; 0: any. 5 are those of the paper.
  int weight_steps = 0;

  /// Whether the picture without any details, which is that of AtrousParams and at hand, is a second candidate. On in
  /// the mixture of Quality::kDefault.
  bool plain = false;

  void check() const;                                              ///< see stein::check
  [[nodiscard]] std::vector<std::string> candidate_names() const;  ///< without the unfiltered input
};

using FilterSpec = std::variant<CrossBilateralParams, CrossNlmParams, GaussianParams, AtrousParams, AtrousSureParams,
                                AdaptiveOrderParams>;

/// The name of a filter, as on the command line.
[[nodiscard]] std::string_view filter_name(const FilterSpec& spec);

/// All names, in the order of the list.
[[nodiscard]] std::vector<std::string_view> filter_names();

/// A filter with its default parameters. @throws Error kInvalidArgument listing the names if there is no such filter.
[[nodiscard]] FilterSpec make_filter(std::string_view name);

/// Whether the filter knows its derivative, so that its risk has a closed form; where not, it takes Monte Carlo.
[[nodiscard]] bool has_derivative(const FilterSpec& spec);

/// The names of the candidates that a spec gives, the unfiltered input first ("input", "sigma_s=1", ...).
[[nodiscard]] std::vector<std::string> candidate_names(const FilterSpec& spec);
/// Of several: the input, then those of each; where there is more than one filter, with its name before them.
[[nodiscard]] std::vector<std::string> candidate_names(const std::vector<FilterSpec>& specs);

inline constexpr int kMaxFilters = 7;  ///< that are mixed

/// Which filters are worth their time.
enum class Quality : std::uint8_t {
  kFast,     ///< the cheapest one that is any good
  kDefault,  ///< most of what the best one gives at a seventh of the time
  kBest,     ///< whatever adds something; with DenoiseParams::second_pass
};

/// The filters of a quality, with their parameters. docs/performance.md has their times, docs/quality.md their errors.
[[nodiscard]] std::vector<FilterSpec> filters_of(Quality quality);

/// "auto": the filters of Quality::kDefault; else filters with their default parameters, by names with commas between.
/// @throws Error kInvalidArgument if there is no such filter.
[[nodiscard]] std::vector<FilterSpec> make_filters(std::string_view names);

/// @throws Error kInvalidArgument naming the parameter, its value and its range.
void check(const FilterSpec& spec);

}  // namespace stein
#pragma GCC visibility pop
