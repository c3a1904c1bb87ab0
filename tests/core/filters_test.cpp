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

template <class Change>
std::string refusal_after(const Change& change) {
  CrossBilateralParams params;
  change(params);
  return refusal(params);
}

bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

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
  CHECK(refusal_after([](Params& p) { p.spatial_sigmas = {0.5F, 16.0F}; }).empty());
  CHECK(refusal_after([](Params& p) { p.spatial_sigmas = {1, 2, 3, 4, 5, 6, 7, 8}; }).empty());
  CHECK(refusal_after([](Params& p) { p.guides.min_feature_variance = 1e-6F; }).empty());
  CHECK(refusal_after([](Params& p) { p.guides.min_feature_variance = 1.0F; }).empty());
  CHECK(refusal_after([](Params& p) { p.guides.other_feature_sigma = 0; }).empty());
  CHECK(refusal_after([](Params& p) { p.range_sigma = 1e9F; }).empty());
  CHECK(refusal_after([](Params& p) { p.guides.feature_sigmas.clear(); }).empty());
}

TEST_CASE("A value out of range is refused with parameter, value and range") {
  using Params = CrossBilateralParams;
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<std::pair<std::string, std::string>> messages = {
      {refusal_after([](Params& p) { p.spatial_sigmas = {0.49F}; }),
       "spatial_sigmas[0] is 0.49, must be in [0.5..16] px"},
      {refusal_after([](Params& p) {
         p.spatial_sigmas = {1, 16.5F};
       }),
       "spatial_sigmas[1] is 16.5, must be in [0.5..16]"},
      {refusal_after([](Params& p) {
         p.spatial_sigmas = {1, NAN};
       }),
       "spatial_sigmas[1] is nan"},
      {refusal_after([](Params& p) {
         p.spatial_sigmas = {2, 1};
       }),
       "spatial_sigmas[1] is 1, must be above"},
      {refusal_after([](Params& p) {
         p.spatial_sigmas = {2, 2};
       }),
       "ascending order"},
      {refusal_after([](Params& p) { p.spatial_sigmas.clear(); }), "number of spatial_sigmas is 0, must be in [1..8]"},
      {refusal_after([](Params& p) { p.spatial_sigmas = {1, 2, 3, 4, 5, 6, 7, 8, 9}; }),
       "number of spatial_sigmas is 9"},
      {refusal_after([](Params& p) { p.range_sigma = -0.5F; }), "range_sigma is -0.5, must be finite and >= 0"},
      {refusal_after([=](Params& p) { p.range_sigma = inf; }), "range_sigma is inf"},
      {refusal_after([](Params& p) { p.guides.other_feature_sigma = -1; }), "other_feature_sigma is -1"},
      {refusal_after([](Params& p) {
         p.guides.feature_sigmas = {{"depth", NAN}};
       }),
       "the sigma of feature 'depth' is nan"},
      {refusal_after([](Params& p) {
         p.guides.feature_sigmas = {{"", 1}};
       }),
       "name"},
      {refusal_after([](Params& p) {
         p.guides.feature_sigmas = {{"depth", 1}, {"depth", 2}};
       }),
       "'depth' is listed twice"},
      {refusal_after([](Params& p) { p.guides.min_feature_variance = 0.9e-6F; }),
       "min_feature_variance is 9e-07, must be in [1e-06..1]"},
      {refusal_after([](Params& p) { p.guides.min_feature_variance = 1.01F; }), "min_feature_variance is 1.01"},
  };
  for (const auto& [message, part] : messages) {
    CAPTURE(message, part);
    CHECK(contains(message, part));
    CHECK(contains(message, "cross-bilateral: "));
  }
}

TEST_CASE("The ranges of the à-trous filters") {
  const auto plain = [](auto change) {
    stein::AtrousParams params;
    change(params);
    return refusal(params);
  };
  const auto sure = [](auto change) {
    stein::AtrousSureParams params;
    change(params);
    return refusal(params);
  };
  CHECK(plain([](auto& p) { p.levels = 1; }).empty());
  CHECK(plain([](auto& p) { p.value_sigma = 0; }).empty());
  CHECK(contains(plain([](auto& p) { p.levels = 0; }), "atrous: levels is 0, must be in [1..5]"));
  CHECK(contains(plain([](auto& p) { p.levels = 6; }), "levels is 6"));
  CHECK(contains(plain([](auto& p) { p.value_sigma = 0.05F; }), "value_sigma (0: off) is 0.05, must be in [0.1..100]"));
  CHECK(contains(plain([](auto& p) { p.value_sigma = NAN; }), "value_sigma"));
  CHECK(contains(plain([](auto& p) { p.guides.other_feature_sigma = -1; }), "atrous: other_feature_sigma is -1"));
  CHECK(sure([](auto& p) { p.fixed_weight = 1.0F; }).empty());
  CHECK(contains(sure([](auto& p) { p.levels = 6; }), "atrous-sure: levels is 6"));
  CHECK(contains(sure([](auto& p) { p.fixed_weight = 1.1F; }), "atrous-sure: fixed_weight is 1.1, must be in [0..1]"));
  CHECK(contains(sure([](auto& p) { p.noise_margin = -1; }), "noise_margin is -1, must be in [0..100]"));
  CHECK(contains(sure([](auto& p) { p.weight_steps = -1; }), "weight_steps is -1, must be in [0..100]"));
  CHECK_FALSE(stein::has_derivative(stein::AtrousParams{}));
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
  const auto message = [](const auto& change) {
    Params params;
    change(params);
    return refusal(params);
  };
  CHECK(message([](Params& p) { p.range_sigmas = {1e-6F, 1e6F}; }).empty());
  CHECK(message([](Params& p) { p.range_sigmas = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}; }).empty());
  CHECK(message([](Params& p) { p.window_radius = 1; }).empty());
  CHECK(message([](Params& p) { p.window_radius = 32; }).empty());
  CHECK(message([](Params& p) { p.patch_radius = 0; }).empty());
  CHECK(message([](Params& p) { p.patch_radius = 4; }).empty());
  CHECK(message([](Params& p) { p.patch_blur = 0; }).empty());
  const std::vector<std::pair<std::string, std::string>> messages = {
      {message([](Params& p) { p.range_sigmas = {0.0F}; }), "range_sigmas[0] is 0, must be in [1e-06..1e+06]"},
      {message([](Params& p) {
         p.range_sigmas = {1, NAN};
       }),
       "range_sigmas[1] is nan"},
      {message([](Params& p) {
         p.range_sigmas = {2, 2};
       }),
       "range_sigmas[1] is 2, must be above"},
      {message([](Params& p) { p.range_sigmas.clear(); }), "number of range_sigmas is 0, must be in [1..12]"},
      {message([](Params& p) { p.range_sigmas = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13}; }),
       "number of range_sigmas is 13"},
      {message([](Params& p) { p.window_radius = 0; }), "window_radius is 0, must be in [1..32] px"},
      {message([](Params& p) { p.window_radius = 33; }), "window_radius is 33"},
      {message([](Params& p) { p.patch_radius = -1; }), "patch_radius is -1, must be in [0..4] px"},
      {message([](Params& p) { p.patch_radius = 5; }), "patch_radius is 5"},
      {message([](Params& p) { p.patch_blur = 1.1F; }), "patch_blur is 1.1, must be in [0..1]"},
      {message([](Params& p) { p.guides.other_feature_sigma = -1; }), "other_feature_sigma is -1"},
  };
  for (const auto& [text, part] : messages) {
    CAPTURE(text, part);
    CHECK(contains(text, part));
    CHECK(contains(text, "cross-nlm: "));
  }
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
  const auto message = [](const auto& change) {
    Params params;
    change(params);
    return refusal(params);
  };
  CHECK(message([](Params& p) { p.orders = {0, 1, 3}; }).empty());
  CHECK(message([](Params& p) { p.orders = {3}; }).empty());
  CHECK(message([](Params& p) { p.range_sigmas.clear(); }).empty());
  CHECK(message([](Params& p) { p.range_sigmas = {0.05F, 1.0F, 100.0F}; }).empty());
  CHECK(message([](Params& p) { p.spatial_sigma = 0; }).empty());
  CHECK(message([](Params& p) { p.spatial_sigma = 0.5F; }).empty());
  CHECK(message([](Params& p) { p.spatial_sigma = 100.0F; }).empty());
  CHECK(message([](Params& p) { p.window_radius = 1; }).empty());
  CHECK(message([](Params& p) { p.window_radius = 20; }).empty());
  CHECK(message([](Params& p) { p.patch_radius = 0; }).empty());
  CHECK(message([](Params& p) { p.patch_radius = 4; }).empty());
  CHECK(message([](Params& p) { p.noise_threshold = 1; }).empty());
  CHECK(message([](Params& p) { p.noise_threshold = 1e6F; }).empty());
  CHECK(message([](Params& p) { p.ridge = 0; }).empty());
  CHECK(message([](Params& p) { p.ridge = 1e6F; }).empty());
  CHECK(message([](Params& p) { p.curvature_ridge = 0; }).empty());
  const std::vector<std::pair<std::string, std::string>> messages = {
      {message([](Params& p) { p.orders.clear(); }), "the number of orders is 0, must be in [1..3]"},
      {message([](Params& p) { p.orders = {2}; }), "orders[0] is 2, must be 0, 1 or 3"},
      {message([](Params& p) { p.orders = {-1}; }), "orders[0] is -1"},
      {message([](Params& p) {
         p.orders = {1, 0};
       }),
       "orders[1] is 0, must be above the one before it"},
      {message([](Params& p) {
         p.orders = {1, 1};
       }),
       "orders[1] is 1, must be above"},
      {message([](Params& p) { p.range_sigmas = {0.04F}; }), "range_sigmas[0] is 0.04, must be in [0.05..100]"},
      {message([](Params& p) {
         p.range_sigmas = {1, NAN};
       }),
       "range_sigmas[1] is nan"},
      {message([](Params& p) {
         p.range_sigmas = {2, 2};
       }),
       "range_sigmas[1] is 2, must be above"},
      {message([](Params& p) {
         p.range_sigmas = {1, 2, 3, 4};
       }),
       "number of range_sigmas is 4, must be in [1..3]"},
      {message([](Params& p) { p.spatial_sigma = 0.4F; }), "spatial_sigma (0: off) is 0.4, must be in [0.5..100] px"},
      {message([](Params& p) { p.spatial_sigma = -1; }), "spatial_sigma (0: off) is -1"},
      {message([](Params& p) { p.spatial_sigma = NAN; }), "spatial_sigma (0: off) is nan"},
      {message([](Params& p) { p.window_radius = 0; }), "window_radius is 0, must be in [1..20] px"},
      {message([](Params& p) { p.window_radius = 21; }), "window_radius is 21"},
      {message([](Params& p) { p.patch_radius = -1; }), "patch_radius is -1, must be in [0..4] px"},
      {message([](Params& p) { p.patch_radius = 5; }), "patch_radius is 5"},
      {message([](Params& p) { p.patch_blur = -0.1F; }), "patch_blur is -0.1, must be in [0..1]"},
      {message([](Params& p) { p.noise_threshold = 0.9F; }), "noise_threshold is 0.9, must be in [1..1e+06]"},
      {message([](Params& p) { p.noise_threshold = 2e6F; }), "noise_threshold is 2e+06"},
      {message([](Params& p) { p.ridge = -1; }), "ridge is -1, must be in [0..1e+06]"},
      {message([](Params& p) { p.ridge = NAN; }), "ridge is nan"},
      {message([](Params& p) { p.curvature_ridge = 2e6F; }), "curvature_ridge is 2e+06, must be in [0..1e+06]"},
      {message([](Params& p) { p.guides.other_feature_sigma = -1; }), "other_feature_sigma is -1"},
  };
  for (const auto& [text, part] : messages) {
    CAPTURE(text, part);
    CHECK(contains(text, part));
    CHECK(contains(text, "adaptive-order: "));
  }
}

TEST_CASE("Numbers in texts are short and do not depend on the locale") {
  CHECK(stein::to_text(0.1F) == "0.1");
  CHECK(stein::to_text(16.0F) == "16");
  CHECK(stein::to_text(-1.5F) == "-1.5");
  CHECK(stein::to_text(11.3137085F, 3) == "11.3");
  CHECK(stein::to_text(std::numeric_limits<float>::max()) == "3.4028235e+38");
}
