// SPDX-License-Identifier: Apache-2.0
#include "stein/options.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "catch.hpp"
#include "stein/error.hpp"

namespace {

using stein::DenoiseParams;

/// The filter of the type given after options that are texts, then numbers.
template <class Params>
Params filter_after(const std::vector<std::pair<std::string, std::string>>& texts,
                    const std::vector<std::pair<std::string, double>>& numbers) {
  DenoiseParams params;
  params.filters = {Params{}};
  for (const auto& [name, text] : texts) stein::set_option(params, name, text);
  for (const auto& [name, number] : numbers) stein::set_option(params, name, number);
  return std::get<Params>(params.filters.front());
}

/// The message of the error that the call throws; empty if it throws none.
std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const stein::Error& error) {
    CHECK(error.code() == stein::ErrorCode::kInvalidArgument);
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("Options of filters set the parameters of their names") {
  const auto bilateral =
      filter_after<stein::CrossBilateralParams>({{"spatial-sigmas", "1,2.5,4"}}, {{"range-sigma", 0.5},
                                                                                  {"feature-sigma.albedo", 0.1},
                                                                                  {"feature-sigma.shadow", 2},
                                                                                  {"other-feature-sigma", 3},
                                                                                  {"min-feature-variance", 0.25},
                                                                                  {"feature-smoothing", 3}});
  CHECK(bilateral.spatial_sigmas == std::vector<float>{1.0F, 2.5F, 4.0F});
  CHECK(bilateral.range_sigma == 0.5F);
  CHECK(bilateral.guides.sigma_of("albedo") == 0.1F);
  CHECK(bilateral.guides.sigma_of("shadow") == 2.0F);
  CHECK(bilateral.guides.sigma_of("anything") == 3.0F);
  CHECK(bilateral.guides.min_feature_variance == 0.25F);
  CHECK(bilateral.guides.smoothing_radius == 3);

  const auto nlm =
      filter_after<stein::CrossNlmParams>({{"range-sigmas", "0.5"}, {"distance", "absolute"}},
                                          {{"window-radius", 7}, {"patch-radius", 1}, {"patch-blur", 0.5}});
  CHECK(nlm.range_sigmas == std::vector<float>{0.5F});
  CHECK(nlm.distance == stein::PatchDistance::kAbsolute);
  CHECK(nlm.window_radius == 7);
  CHECK(nlm.patch_radius == 1);
  CHECK(nlm.patch_blur == 0.5F);

  const auto order = filter_after<stein::AdaptiveOrderParams>(
      {{"order", "3"}, {"order-error", "taylor"}},
      {{"spatial-sigma", 4}, {"noise-threshold", 3}, {"ridge", 0.5}, {"curvature-ridge", 20}});
  CHECK(order.orders == std::vector<int>{3});
  CHECK(order.error == stein::OrderError::kTaylor);
  CHECK(order.spatial_sigma == 4.0F);
  CHECK(order.noise_threshold == 3.0F);
  CHECK(order.ridge == 0.5F);
  CHECK(order.curvature_ridge == 20.0F);

  const auto atrous = filter_after<stein::AtrousSureParams>({}, {{"levels", 3},
                                                                 {"value-sigma", 2},
                                                                 {"fixed-weight", 0.75},
                                                                 {"noise-margin", 1},
                                                                 {"weight-steps", 5},
                                                                 {"plain", 1}});
  CHECK(atrous.levels == 3);
  CHECK(atrous.value_sigma == 2.0F);
  CHECK(atrous.fixed_weight == 0.75F);
  CHECK(atrous.noise_margin == 1.0F);
  CHECK(atrous.weight_steps == 5);
  CHECK(atrous.plain);
}

TEST_CASE("Banks: the cheaper one, and back") {
  using Params = stein::CrossNlmParams;
  CHECK(filter_after<Params>({{"bank", "intermediate"}}, {}).window_radius ==
        stein::intermediate_cross_nlm().window_radius);
  CHECK(filter_after<Params>({{"bank", "intermediate"}, {"bank", "final"}}, {}).window_radius ==
        Params{}.window_radius);
  CHECK(stein::has_banks(Params{}));
  CHECK_FALSE(stein::has_banks(stein::AtrousParams{}));
}

TEST_CASE("Options of the rest set the parameters of their names") {
  DenoiseParams params;
  stein::set_option(params, "risk", std::string("joint"));
  stein::set_option(params, "selection", std::string("argmin"));
  stein::set_option(params, "density-rule", std::string("all-samples"));
  for (const auto& [name, value] : std::vector<std::pair<std::string, double>>{{"strength", 0.5},
                                                                               {"draws", 3},
                                                                               {"seed", 9007199254740992.0},
                                                                               {"outliers", 0},
                                                                               {"strict", 1},
                                                                               {"threads", 2},
                                                                               {"tile-width", 32},
                                                                               {"tile-height", 8}})
    stein::set_option(params, name, value);
  CHECK(params.risk == stein::Risk::kJoint);
  CHECK(params.selection == stein::Selection::kArgmin);
  CHECK(params.density.rule == stein::DensityRule::kAllSamples);
  CHECK(params.strength == 0.5F);
  CHECK(params.monte_carlo.draws == 3);
  CHECK(params.monte_carlo.seed == std::uint64_t{1} << 53);
  CHECK_FALSE(params.outliers.enabled);
  CHECK(params.strict);
  CHECK(params.execution.threads == 2);
  CHECK(params.execution.tile_width == 32);
  CHECK(params.execution.tile_height == 8);
}

TEST_CASE("Options that cannot be are refused with what can") {
  DenoiseParams params;
  params.filters = {stein::CrossBilateralParams{}};
  const auto text = [&](const std::string& name, const std::string& value) {
    return refusal([&] { stein::set_option(params, name, value); });
  };
  const auto number = [&](const std::string& name, double value) {
    return refusal([&] { stein::set_option(params, name, value); });
  };
  const std::vector<std::pair<std::string, std::string>> messages = {
      {text("tempo", "high"), "no option 'tempo'"},
      {text("tempo", "high"), "window-radius"},
      {number("feature-sigma.", 1), "no option 'feature-sigma.'"},
      {text("window-radius", "3"), "window-radius is a number"},
      {number("spatial-sigmas", 3), "spatial-sigmas is a text"},
      {number("window-radius", 3), "'cross-bilateral' has no option window-radius"},
      {text("bank", "last"), "final, intermediate"},
      {text("spatial-sigmas", ""), "numbers with commas"},
      {text("spatial-sigmas", "1,,2"), "numbers with commas"},
      {text("spatial-sigmas", "1,2 4"), "numbers with commas"},
      {text("spatial-sigmas", "1,"), "numbers with commas"},
  };
  for (const auto& [message, part] : messages) {
    CAPTURE(message, part);
    CHECK(message.find(part) != std::string::npos);
  }
  params.filters = {stein::AtrousSureParams{}};
  CHECK(number("plain", 2).find("plain is 2, must be a whole number in [0..1]") != std::string::npos);
}
