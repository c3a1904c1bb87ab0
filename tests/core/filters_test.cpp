// SPDX-License-Identifier: Apache-2.0
#include "stein/filters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "catch.hpp"
#include "core/parameter_check.hpp"
#include "stein/error.hpp"

namespace {

using stein::CrossBilateralParams;
using stein::FilterSpec;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The message of the error that check throws; empty if it throws none.
std::string refusal(const FilterSpec& spec) {
  try {
    stein::check(spec);
  } catch (const stein::Error& error) {
    CHECK(error.code() == stein::ErrorCode::kInvalidArgument);
    return error.what();
  }
  return {};
}

/// The same of a filter's usual parameters after a change.
template <class Params>
std::string refusal_after(void (*change)(Params&)) {
  Params params;
  change(params);
  return refusal(params);
}

/// The same with another list of numbers in place of the usual one.
template <class Params, class Number>
std::string refusal_of(std::vector<Number> Params::*list, const std::vector<Number>& numbers) {
  Params params;
  params.*list = numbers;
  return refusal(params);
}

bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

/// Each message must contain its part and the name of the filter.
void check_messages(const std::vector<std::pair<std::string, std::string>>& messages, const std::string& filter) {
  for (const auto& [message, part] : messages) {
    CAPTURE(message, part);
    CHECK(contains(message, part));
    CHECK(contains(message, filter + ": "));
  }
}

}  // namespace

TEST_CASE("Every filter of the list is made by its name, is valid, and names its candidates") {
  const std::vector<std::string_view> names = stein::filter_names();
  CHECK(names.size() == std::variant_size_v<FilterSpec>);
  CHECK(std::set<std::string_view>(names.begin(), names.end()).size() == names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    CAPTURE(names[i]);
    const FilterSpec spec = stein::make_filter(names[i]);
    CHECK(spec.index() == i);
    CHECK(stein::filter_name(spec) == names[i]);
    CHECK(refusal(spec).empty());
    const std::vector<std::string> candidates = stein::candidate_names(spec);
    REQUIRE(candidates.size() >= 2);
    CHECK(candidates.front() == "input");
    CHECK(std::set<std::string>(candidates.begin(), candidates.end()).size() == candidates.size());
  }
}

TEST_CASE("An unknown filter is refused with the names there are") {
  try {
    static_cast<void>(stein::make_filter("cross-bilatera"));
    FAIL("no error");
  } catch (const stein::Error& error) {
    CHECK(error.code() == stein::ErrorCode::kInvalidArgument);
    CHECK(contains(error.what(), "'cross-bilatera'"));
    for (const std::string_view name : stein::filter_names()) CHECK(contains(error.what(), name));
  }
}

TEST_CASE("The cross-bilateral bank has the paper's scales") {
  CHECK(stein::candidate_names(CrossBilateralParams{}) ==
        std::vector<std::string>{"input", "sigma_s=1", "sigma_s=1.41", "sigma_s=2", "sigma_s=2.83", "sigma_s=4",
                                 "sigma_s=5.66", "sigma_s=8"});
  CHECK(stein::candidate_names(stein::intermediate_cross_bilateral()) ==
        std::vector<std::string>{"input", "sigma_s=1", "sigma_s=2", "sigma_s=4"});
}

TEST_CASE("The ends of each range are allowed") {
  using Params = CrossBilateralParams;
  CHECK(refusal_of(&Params::spatial_sigmas, {0.5F, 16.0F}).empty());
  CHECK(refusal_of(&Params::spatial_sigmas, {1, 2, 3, 4, 5, 6, 7, 8}).empty());
  CHECK(refusal_after(+[](Params& p) { p.guides.min_feature_variance = 1e-6F; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.guides.min_feature_variance = 1.0F; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.guides.other_feature_sigma = 0; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.range_sigma = 1e9F; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.guides.feature_sigmas.clear(); }).empty());
}

TEST_CASE("A value out of range is refused with parameter, value and range") {
  using Params = CrossBilateralParams;
  const std::vector<std::pair<std::string, std::string>> messages = {
      {refusal_of(&Params::spatial_sigmas, {0.49F}), "spatial_sigmas[0] is 0.49, must be in [0.5..16] px"},
      {refusal_of(&Params::spatial_sigmas, {1, 16.5F}), "spatial_sigmas[1] is 16.5, must be in [0.5..16]"},
      {refusal_of(&Params::spatial_sigmas, {1, NAN}), "spatial_sigmas[1] is nan"},
      {refusal_of(&Params::spatial_sigmas, {2, 1}), "spatial_sigmas[1] is 1, must be above"},
      {refusal_of(&Params::spatial_sigmas, {2, 2}), "ascending order"},
      {refusal_of(&Params::spatial_sigmas, {}), "number of spatial_sigmas is 0, must be in [1..8]"},
      {refusal_of(&Params::spatial_sigmas, {1, 2, 3, 4, 5, 6, 7, 8, 9}), "number of spatial_sigmas is 9"},
      {refusal_after(+[](Params& p) { p.range_sigma = -0.5F; }), "range_sigma is -0.5, must be finite and >= 0"},
      {refusal_after(+[](Params& p) { p.range_sigma = kInfinity; }), "range_sigma is inf"},
      {refusal_after(+[](Params& p) { p.guides.other_feature_sigma = -1; }), "other_feature_sigma is -1"},
      {refusal_after(+[](Params& p) {
         p.guides.feature_sigmas = {{"depth", NAN}};
       }),
       "the sigma of feature 'depth' is nan"},
      {refusal_after(+[](Params& p) {
         p.guides.feature_sigmas = {{"", 1}};
       }),
       "name"},
      {refusal_after(+[](Params& p) {
         p.guides.feature_sigmas = {{"depth", 1}, {"depth", 2}};
       }),
       "'depth' is listed twice"},
      {refusal_after(+[](Params& p) { p.guides.min_feature_variance = 0.9e-6F; }),
       "min_feature_variance is 9e-07, must be in [1e-06..1]"},
      {refusal_after(+[](Params& p) { p.guides.min_feature_variance = 1.01F; }), "min_feature_variance is 1.01"},
  };
  check_messages(messages, "cross-bilateral");
}

TEST_CASE("atrous-sure has the picture without details for a second candidate where it is wanted, as by default") {
  stein::AtrousSureParams params;
  CHECK(stein::candidate_names(params) == std::vector<std::string>{"input", "levels=5"});
  params.plain = true;
  CHECK(stein::candidate_names(params) == std::vector<std::string>{"input", "levels=5", "levels=5 plain"});
  CHECK(stein::candidate_names(stein::filters_of(stein::Quality::kDefault)).back() == "atrous-sure levels=5 plain");
}

TEST_CASE("The ranges of the à-trous filters") {
  using Plain = stein::AtrousParams;
  using Sure = stein::AtrousSureParams;
  CHECK(refusal_after(+[](Plain& p) { p.levels = 1; }).empty());
  CHECK(refusal_after(+[](Plain& p) { p.value_sigma = 0; }).empty());
  CHECK(contains(refusal_after(+[](Plain& p) { p.levels = 0; }), "atrous: levels is 0, must be in [1..5]"));
  CHECK(contains(refusal_after(+[](Plain& p) { p.levels = 6; }), "levels is 6"));
  CHECK(contains(refusal_after(+[](Plain& p) { p.value_sigma = 0.05F; }),
                 "value_sigma (0: off) is 0.05, must be in [0.1..100]"));
  CHECK(contains(refusal_after(+[](Plain& p) { p.value_sigma = NAN; }), "value_sigma"));
  CHECK(contains(refusal_after(+[](Plain& p) { p.guides.other_feature_sigma = -1; }),
                 "atrous: other_feature_sigma is -1"));
  CHECK(refusal_after(+[](Sure& p) { p.fixed_weight = 1.0F; }).empty());
  CHECK(contains(refusal_after(+[](Sure& p) { p.levels = 6; }), "atrous-sure: levels is 6"));
  CHECK(contains(refusal_after(+[](Sure& p) { p.fixed_weight = 1.1F; }),
                 "atrous-sure: fixed_weight is 1.1, must be in [0..1]"));
  CHECK(contains(refusal_after(+[](Sure& p) { p.noise_margin = -1; }), "noise_margin is -1, must be in [0..100]"));
  CHECK(contains(refusal_after(+[](Sure& p) { p.weight_steps = -1; }), "weight_steps is -1, must be in [0..100]"));
  CHECK(refusal_after(+[](Plain& p) { p.guides.smoothing_radius = 5; }).empty());
  CHECK(contains(refusal_after(+[](Plain& p) { p.guides.smoothing_radius = 6; }),
                 "atrous: smoothing_radius is 6, must be in [0..5] px"));
  CHECK(contains(refusal_after(+[](Sure& p) { p.guides.smoothing_radius = -1; }), "smoothing_radius is -1"));
  CHECK_FALSE(stein::has_derivative(stein::AtrousParams{}));
}

TEST_CASE("Weights by smoothed features have no known derivative; a regression on its own has") {
  stein::CrossBilateralParams bilateral;
  stein::CrossNlmParams nlm;
  stein::AdaptiveOrderParams regression;
  CHECK(stein::has_derivative(bilateral));
  CHECK(stein::has_derivative(nlm));
  for (stein::FeatureGuides* guides : {&bilateral.guides, &nlm.guides, &regression.guides})
    guides->smoothing_radius = 2;
  CHECK_FALSE(stein::has_derivative(bilateral));
  CHECK_FALSE(stein::has_derivative(nlm));
  CHECK(stein::has_derivative(regression));
  CHECK(stein::has_derivative(stein::GaussianParams{}));
}

TEST_CASE("The cross non-local means banks name their range sigmas and differ in their windows") {
  stein::CrossNlmParams params;
  params.range_sigmas = {0.005F, 0.70710678F, 4.0F};
  CHECK(stein::candidate_names(params) ==
        std::vector<std::string>{"input", "sigma_r=0.005", "sigma_r=0.707", "sigma_r=4"});
  CHECK(stein::CrossNlmParams{}.window_radius == 20);
  CHECK(stein::intermediate_cross_nlm().window_radius == 10);
  CHECK(stein::intermediate_cross_nlm().range_sigmas == stein::CrossNlmParams{}.range_sigmas);
}

TEST_CASE("Parameters of the cross non-local means bank are checked") {
  using Params = stein::CrossNlmParams;
  CHECK(refusal_of(&Params::range_sigmas, {1e-6F, 1e6F}).empty());
  CHECK(refusal_of(&Params::range_sigmas, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}).empty());
  CHECK(refusal_after(+[](Params& p) { p.window_radius = 1; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.window_radius = 32; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.patch_radius = 0; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.patch_radius = 4; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.patch_blur = 0; }).empty());
  const std::vector<std::pair<std::string, std::string>> messages = {
      {refusal_of(&Params::range_sigmas, {0.0F}), "range_sigmas[0] is 0, must be in [1e-06..1e+06]"},
      {refusal_of(&Params::range_sigmas, {1, NAN}), "range_sigmas[1] is nan"},
      {refusal_of(&Params::range_sigmas, {2, 2}), "range_sigmas[1] is 2, must be above"},
      {refusal_of(&Params::range_sigmas, {}), "number of range_sigmas is 0, must be in [1..12]"},
      {refusal_of(&Params::range_sigmas, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13}), "number of range_sigmas is 13"},
      {refusal_after(+[](Params& p) { p.window_radius = 0; }), "window_radius is 0, must be in [1..32] px"},
      {refusal_after(+[](Params& p) { p.window_radius = 33; }), "window_radius is 33"},
      {refusal_after(+[](Params& p) { p.patch_radius = -1; }), "patch_radius is -1, must be in [0..4] px"},
      {refusal_after(+[](Params& p) { p.patch_radius = 5; }), "patch_radius is 5"},
      {refusal_after(+[](Params& p) { p.patch_blur = 1.1F; }), "patch_blur is 1.1, must be in [0..1]"},
      {refusal_after(+[](Params& p) { p.guides.other_feature_sigma = -1; }), "other_feature_sigma is -1"},
  };
  check_messages(messages, "cross-nlm");
}

TEST_CASE("The adaptive-order banks name orders and range sigmas and differ in their windows") {
  stein::AdaptiveOrderParams params;
  params.orders = {0, 3};
  params.range_sigmas = {0.70710678F, 4.0F};
  CHECK(stein::candidate_names(params) == std::vector<std::string>{"input", "order=0 sigma_r=0.707",
                                                                   "order=3 sigma_r=0.707", "order=0 sigma_r=4",
                                                                   "order=3 sigma_r=4"});
  params.orders = {1};
  params.range_sigmas.clear();
  CHECK(stein::candidate_names(params) == std::vector<std::string>{"input", "order=1"});
  const stein::AdaptiveOrderParams usual;
  const stein::AdaptiveOrderParams intermediate = stein::intermediate_adaptive_order();
  CHECK(intermediate.window_radius < usual.window_radius);
  CHECK(intermediate.orders == usual.orders);
  CHECK(intermediate.range_sigmas == usual.range_sigmas);
  CHECK(refusal(intermediate).empty());
  CHECK(stein::has_derivative(usual));
}

TEST_CASE("Parameters of the adaptive-order bank are checked") {
  using Params = stein::AdaptiveOrderParams;
  CHECK(refusal_of(&Params::orders, {0, 1, 3}).empty());
  CHECK(refusal_of(&Params::orders, {3}).empty());
  CHECK(refusal_of(&Params::range_sigmas, {}).empty());
  CHECK(refusal_of(&Params::range_sigmas, {0.05F, 1.0F, 100.0F}).empty());
  CHECK(refusal_after(+[](Params& p) { p.spatial_sigma = 0; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.spatial_sigma = 0.5F; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.spatial_sigma = 100.0F; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.window_radius = 1; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.window_radius = 20; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.patch_radius = 0; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.patch_radius = 4; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.noise_threshold = 1; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.noise_threshold = 1e6F; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.ridge = 0; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.ridge = 1e6F; }).empty());
  CHECK(refusal_after(+[](Params& p) { p.curvature_ridge = 0; }).empty());
  const std::vector<std::pair<std::string, std::string>> messages = {
      {refusal_of(&Params::orders, {}), "the number of orders is 0, must be in [1..3]"},
      {refusal_of(&Params::orders, {2}), "orders[0] is 2, must be 0, 1 or 3"},
      {refusal_of(&Params::orders, {-1}), "orders[0] is -1"},
      {refusal_of(&Params::orders, {1, 0}), "orders[1] is 0, must be above the one before it"},
      {refusal_of(&Params::orders, {1, 1}), "orders[1] is 1, must be above"},
      {refusal_of(&Params::range_sigmas, {0.04F}), "range_sigmas[0] is 0.04, must be in [0.05..100]"},
      {refusal_of(&Params::range_sigmas, {1, NAN}), "range_sigmas[1] is nan"},
      {refusal_of(&Params::range_sigmas, {2, 2}), "range_sigmas[1] is 2, must be above"},
      {refusal_of(&Params::range_sigmas, {1, 2, 3, 4}), "number of range_sigmas is 4, must be in [1..3]"},
      {refusal_after(+[](Params& p) { p.spatial_sigma = 0.4F; }),
       "spatial_sigma (0: off) is 0.4, must be in [0.5..100] px"},
      {refusal_after(+[](Params& p) { p.spatial_sigma = -1; }), "spatial_sigma (0: off) is -1"},
      {refusal_after(+[](Params& p) { p.spatial_sigma = NAN; }), "spatial_sigma (0: off) is nan"},
      {refusal_after(+[](Params& p) { p.window_radius = 0; }), "window_radius is 0, must be in [1..20] px"},
      {refusal_after(+[](Params& p) { p.window_radius = 21; }), "window_radius is 21"},
      {refusal_after(+[](Params& p) { p.patch_radius = -1; }), "patch_radius is -1, must be in [0..4] px"},
      {refusal_after(+[](Params& p) { p.patch_radius = 5; }), "patch_radius is 5"},
      {refusal_after(+[](Params& p) { p.patch_blur = -0.1F; }), "patch_blur is -0.1, must be in [0..1]"},
      {refusal_after(+[](Params& p) { p.noise_threshold = 0.9F; }), "noise_threshold is 0.9, must be in [1..1e+06]"},
      {refusal_after(+[](Params& p) { p.noise_threshold = 2e6F; }), "noise_threshold is 2e+06"},
      {refusal_after(+[](Params& p) { p.ridge = -1; }), "ridge is -1, must be in [0..1e+06]"},
      {refusal_after(+[](Params& p) { p.ridge = NAN; }), "ridge is nan"},
      {refusal_after(+[](Params& p) { p.curvature_ridge = 2e6F; }), "curvature_ridge is 2e+06, must be in [0..1e+06]"},
      {refusal_after(+[](Params& p) { p.guides.other_feature_sigma = -1; }), "other_feature_sigma is -1"},
  };
  check_messages(messages, "adaptive-order");
}

TEST_CASE("Numbers in texts are short and do not depend on the locale") {
  CHECK(stein::to_text(0.1F) == "0.1");
  CHECK(stein::to_text(16.0F) == "16");
  CHECK(stein::to_text(-1.5F) == "-1.5");
  CHECK(stein::to_text(11.3137085F, 3) == "11.3");
  CHECK(stein::to_text(std::numeric_limits<float>::max()) == "3.4028235e+38");
}
