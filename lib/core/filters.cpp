// SPDX-License-Identifier: Apache-2.0
#include "stein/filters.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/parameter_check.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

/// Calls visit.operator()<Params>() for every alternative of FilterSpec, in the order of the list.
template <class Visit>
void for_each_filter(const Visit& visit) {
  [&]<std::size_t... index>(std::index_sequence<index...>) {
    (visit.template operator()<std::variant_alternative_t<index, FilterSpec>>(), ...);
  }
  (std::make_index_sequence<std::variant_size_v<FilterSpec>>{});
}

std::string joined_names() {
  std::string text;
  for (const std::string_view name : filter_names()) {
    text += (text.empty() ? "" : ", ");
    text += name;
  }
  return text;
}

[[noreturn]] void out_of_range(std::string_view what, const std::string& value, const std::string& range) {
  throw Error(ErrorCode::kInvalidArgument, std::string(what) + " is " + value + ", must be " + range);
}

template <class... Precision>
std::string chars_of(float value, Precision... precision) {
  std::array<char, 64> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, precision...);
  return {text.data(), end.ptr};
}

std::vector<std::string> names_of(const std::string& what, const std::vector<float>& sigmas) {
  std::vector<std::string> names;
  names.reserve(sigmas.size());
  std::transform(sigmas.begin(), sigmas.end(), std::back_inserter(names),
                 [&](float sigma) { return what + "=" + to_text(sigma, 3); });
  return names;
}

// The sigmas that tell a bank's candidates apart: what each may be, and how many.
struct SigmaRange {
  float low = 0;
  float high = 0;
  std::string_view unit;
  std::size_t most = 0;
};

void require_sigmas(const std::string& prefix, const std::string& name, const std::vector<float>& sigmas,
                    const SigmaRange& range) {
  if (sigmas.empty() || sigmas.size() > range.most) {
    out_of_range(prefix + "the number of " + name, std::to_string(sigmas.size()),
                 "in [1.." + std::to_string(range.most) + "]");
  }
  for (std::size_t i = 0; i < sigmas.size(); ++i) {
    const std::string what = prefix + name + "[" + std::to_string(i) + "]";
    require_in_range(what, sigmas[i], range.low, range.high, range.unit);
    if (i > 0 && sigmas[i] <= sigmas[i - 1]) {
      out_of_range(what, to_text(sigmas[i]),
                   "above the one before it (" + to_text(sigmas[i - 1]) + "): list them in ascending order");
    }
  }
}

void require_scales(const std::string& prefix, const std::vector<float>& spatial_sigmas) {
  require_sigmas(prefix, "spatial_sigmas", spatial_sigmas, {0.5F, 16.0F, "px", 8});
}

void require_atrous(const std::string& owner, int levels, float value_sigma, const FeatureGuides& guides) {
  require_in_range(owner + ": levels", static_cast<float>(levels), 1.0F, 5.0F);
  if (value_sigma != 0.0F) require_in_range(owner + ": value_sigma (0: off)", value_sigma, 0.1F, 100.0F);
  guides.check(owner);
}

// Of smoothed features the derivative is not known. The regression has its own, and is not guided by others.
template <class Params>
bool is_guided_by_single_pixels(const Params& params) {
  if constexpr (std::is_same_v<Params, AdaptiveOrderParams> || !requires { params.guides; }) {
    return true;
  } else {
    return params.guides.smoothing_radius == 0;
  }
}

}  // namespace

std::string to_text(float value) { return chars_of(value); }

std::string to_text(float value, int digits) { return chars_of(value, std::chars_format::general, digits); }

void require_in_range(std::string_view what, float value, float low, float high, std::string_view unit) {
  if (value >= low && value <= high) return;
  const std::string suffix = unit.empty() ? "" : " " + std::string(unit);
  out_of_range(what, to_text(value), "in [" + to_text(low) + ".." + to_text(high) + "]" + suffix);
}

void require_not_negative(std::string_view what, float value) {
  if (!(value >= 0.0F) || std::isinf(value)) out_of_range(what, to_text(value), "finite and >= 0");
}

std::string_view filter_name(const FilterSpec& spec) {
  return std::visit([](const auto& params) { return std::remove_cvref_t<decltype(params)>::kName; }, spec);
}

std::vector<std::string_view> filter_names() {
  std::vector<std::string_view> names;
  for_each_filter([&]<class Params>() { names.push_back(Params::kName); });
  return names;
}

FilterSpec make_filter(std::string_view name) {
  FilterSpec spec;
  bool found = false;
  for_each_filter([&]<class Params>() {
    if (name != Params::kName) return;
    spec = Params{};
    found = true;
  });
  if (!found) {
    throw Error(ErrorCode::kInvalidArgument,
                "there is no filter '" + std::string(name) + "'; choose one of: " + joined_names());
  }
  return spec;
}

std::vector<std::string> candidate_names(const std::vector<FilterSpec>& specs) {
  if (specs.size() == 1) return candidate_names(specs.front());
  std::vector<std::string> names = {"input"};
  for (const FilterSpec& spec : specs) {
    const std::vector<std::string> own = candidate_names(spec);
    for (std::size_t i = 1; i < own.size(); ++i) names.push_back(std::string(filter_name(spec)) + " " + own[i]);
  }
  return names;
}

std::vector<FilterSpec> make_filters(std::string_view names) {
  if (names == "auto") return filters_of(Quality::kDefault);
  std::vector<FilterSpec> specs;
  for (;;) {
    const std::size_t comma = names.find(',');
    specs.push_back(make_filter(names.substr(0, comma)));
    if (comma == std::string_view::npos) return specs;
    names.remove_prefix(comma + 1);
  }
}

std::vector<FilterSpec> filters_of(Quality quality) {
  if (quality == Quality::kFast) return {AtrousSureParams{}};
  if (quality == Quality::kBest)
    return {AdaptiveOrderParams{}, CrossNlmParams{}, CrossBilateralParams{}, AtrousSureParams{}};
  AdaptiveOrderParams regression;
  regression.orders = {0, 1};
  AtrousSureParams atrous;
  atrous.plain = true;
  return {regression, atrous};
}

bool has_derivative(const FilterSpec& spec) {
  return std::visit(
      [](const auto& params) {
        return std::remove_cvref_t<decltype(params)>::kHasDerivative && is_guided_by_single_pixels(params);
      },
      spec);
}

std::vector<std::string> candidate_names(const FilterSpec& spec) {
  std::vector<std::string> names = std::visit([](const auto& params) { return params.candidate_names(); }, spec);
  names.insert(names.begin(), "input");
  return names;
}

void check(const FilterSpec& spec) {
  std::visit([](const auto& params) { params.check(); }, spec);
}

CrossBilateralParams intermediate_cross_bilateral() {
  CrossBilateralParams params;
  params.spatial_sigmas = {1.0F, 2.0F, 4.0F};
  return params;
}

std::vector<std::string> CrossBilateralParams::candidate_names() const { return names_of("sigma_s", spatial_sigmas); }

std::vector<std::string> GaussianParams::candidate_names() const { return names_of("sigma_s", spatial_sigmas); }

CrossNlmParams intermediate_cross_nlm() {
  CrossNlmParams params;
  params.window_radius = 10;
  return params;
}

std::vector<std::string> CrossNlmParams::candidate_names() const { return names_of("sigma_r", range_sigmas); }

AdaptiveOrderParams intermediate_adaptive_order() {
  AdaptiveOrderParams params;
  params.window_radius = 5;
  return params;
}

std::vector<std::string> AdaptiveOrderParams::candidate_names() const {
  const std::vector<std::string> sigmas =
      range_sigmas.empty() ? std::vector<std::string>{""} : names_of(" sigma_r", range_sigmas);
  std::vector<std::string> names;
  for (const std::string& sigma : sigmas) {
    for (const int order : orders) names.push_back("order=" + std::to_string(order) + sigma);
  }
  return names;
}

std::vector<std::string> AtrousParams::candidate_names() const { return {"levels=" + std::to_string(levels)}; }

std::vector<std::string> AtrousSureParams::candidate_names() const {
  const std::string name = "levels=" + std::to_string(levels);
  return plain ? std::vector{name, name + " plain"} : std::vector{name};
}

float FeatureGuides::sigma_of(std::string_view feature) const {
  for (const FeatureSigma& entry : feature_sigmas) {
    if (entry.name == feature) return entry.sigma;
  }
  return other_feature_sigma;
}

void FeatureGuides::check(const std::string& owner) const {
  const std::string prefix = owner + ": ";
  std::set<std::string_view> seen;
  for (const FeatureSigma& feature : feature_sigmas) {
    const std::string what = prefix + "the sigma of feature '" + feature.name + "'";
    require_not_negative(what, feature.sigma);
    if (feature.name.empty()) out_of_range(what, to_text(feature.sigma), "given with the feature's name");
    if (!seen.insert(feature.name).second) out_of_range(what, "listed twice", "listed once");
  }
  require_not_negative(prefix + "other_feature_sigma", other_feature_sigma);
  require_in_range(prefix + "min_feature_variance", min_feature_variance, 1e-6F, 1.0F);
  require_in_range(prefix + "smoothing_radius", static_cast<float>(smoothing_radius), 0.0F, 5.0F, "px");
}

void CrossBilateralParams::check() const {
  const std::string prefix = std::string(kName) + ": ";
  require_scales(prefix, spatial_sigmas);
  require_not_negative(prefix + "range_sigma", range_sigma);
  guides.check(std::string(kName));
}

void CrossNlmParams::check() const {
  const std::string prefix = std::string(kName) + ": ";
  require_sigmas(prefix, "range_sigmas", range_sigmas, {1e-6F, 1e6F, "", 12});
  require_in_range(prefix + "window_radius", static_cast<float>(window_radius), 1.0F, 32.0F, "px");
  require_in_range(prefix + "patch_radius", static_cast<float>(patch_radius), 0.0F, 4.0F, "px");
  require_in_range(prefix + "patch_blur", patch_blur, 0.0F, 1.0F);
  guides.check(std::string(kName));
}

void AdaptiveOrderParams::check() const {
  const std::string prefix = std::string(kName) + ": ";
  if (orders.empty()) out_of_range(prefix + "the number of orders", "0", "in [1..3]");
  for (std::size_t i = 0; i < orders.size(); ++i) {
    const std::string what = prefix + "orders[" + std::to_string(i) + "]";
    const bool is_known = orders[i] == 0 || orders[i] == 1 || orders[i] == 3;
    if (!is_known) out_of_range(what, std::to_string(orders[i]), "0, 1 or 3");
    if (i > 0 && orders[i] <= orders[i - 1]) {
      out_of_range(what, std::to_string(orders[i]), "above the one before it: list them in ascending order");
    }
  }
  if (!range_sigmas.empty()) require_sigmas(prefix, "range_sigmas", range_sigmas, {0.05F, 100.0F, "", 3});
  if (spatial_sigma != 0.0F) require_in_range(prefix + "spatial_sigma (0: off)", spatial_sigma, 0.5F, 100.0F, "px");
  require_in_range(prefix + "window_radius", static_cast<float>(window_radius), 1.0F, 20.0F, "px");
  require_in_range(prefix + "patch_radius", static_cast<float>(patch_radius), 0.0F, 4.0F, "px");
  require_in_range(prefix + "patch_blur", patch_blur, 0.0F, 1.0F);
  require_in_range(prefix + "noise_threshold", noise_threshold, 1.0F, 1e6F);
  require_in_range(prefix + "ridge", ridge, 0.0F, 1e6F, "px");
  require_in_range(prefix + "curvature_ridge", curvature_ridge.value_or(0.0F), 0.0F, 1e6F, "px");
  guides.check(std::string(kName));
}

FeatureGuides atrous_guides() {
  FeatureGuides guides;
  guides.smoothing_radius = 2;
  for (FeatureSigma& feature : guides.feature_sigmas) feature.sigma *= 1.3F;
  return guides;
}

void AtrousParams::check() const { require_atrous(std::string(kName), levels, value_sigma, guides); }

void AtrousSureParams::check() const {
  require_atrous(std::string(kName), levels, value_sigma, guides);
  const std::string prefix = std::string(kName) + ": ";
  if (fixed_weight) require_in_range(prefix + "fixed_weight", *fixed_weight, 0.0F, 1.0F);
  require_in_range(prefix + "noise_margin", noise_margin, 0.0F, 100.0F);
  require_in_range(prefix + "weight_steps", static_cast<float>(weight_steps), 0.0F, 100.0F);
}

void GaussianParams::check() const { require_scales(std::string(kName) + ": ", spatial_sigmas); }

}  // namespace stein
