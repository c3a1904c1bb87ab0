// SPDX-License-Identifier: Apache-2.0
#include "core/filter_options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <system_error>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/parameter_check.hpp"
#include "stein/options.hpp"

namespace stein {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::kInvalidArgument, message); }

using Filters = std::vector<FilterSpec>;

std::string joined_names(const Filters& filters) {
  std::string names;
  for (const FilterSpec& spec : filters) names += (names.empty() ? "'" : ", '") + std::string(filter_name(spec)) + "'";
  return names;
}

/// Calls set(member) for each filter whose parameters have the member that `pick` takes from them.
template <class Pick, class Set>
void with_member(Filters& filters, const std::string& name, const Pick& pick, const Set& set) {
  bool found = false;
  for (FilterSpec& spec : filters) {
    std::visit(
        [&](auto& params) {
          if constexpr (std::is_invocable_v<Pick, decltype(params)>) {
            set(pick(params));
            found = true;
          }
        },
        spec);
  }
  if (!found) refuse("the filter " + joined_names(filters) + " has no option " + name);
}

template <class Pick>
void set_number(Filters& filters, const std::string& name, double value, const Pick& pick) {
  with_member(filters, name, pick, [&]<class Member>(Member& member) {
    if constexpr (std::same_as<Member, bool>) {
      member = yes_or_no(name, value);
    } else if constexpr (std::integral<Member>) {
      member = static_cast<Member>(whole(name, value));
    } else {
      member = static_cast<float>(value);
    }
  });
}

std::vector<float> parse_list(const std::string& name, const std::string& text) {
  std::vector<float> numbers;
  const char* const end = text.data() + text.size();
  for (const char* begin = text.data();; ++begin) {
    const auto [stop, error] = std::from_chars(begin, end, numbers.emplace_back());
    if (error != std::errc() || (stop != end && *stop != ','))
      refuse(name + " is '" + text + "', not numbers with commas between, such as 1,2,4");
    if (stop == end) return numbers;
    begin = stop;
  }
}

// Members by name; a filter without it cannot be picked from.
constexpr auto kSpatialSigmas = [](auto& p) -> decltype((p.spatial_sigmas)) { return p.spatial_sigmas; };
constexpr auto kRangeSigmas = [](auto& p) -> decltype((p.range_sigmas)) { return p.range_sigmas; };
constexpr auto kDistance = [](auto& p) -> decltype((p.distance)) { return p.distance; };
constexpr auto kOrders = [](auto& p) -> decltype((p.orders)) { return p.orders; };
constexpr auto kError = [](auto& p) -> decltype((p.error)) { return p.error; };
constexpr auto kGuides = [](auto& p) -> decltype((p.guides)) { return p.guides; };
constexpr auto kRangeSigma = [](auto& p) -> decltype((p.range_sigma)) { return p.range_sigma; };
constexpr auto kSpatialSigma = [](auto& p) -> decltype((p.spatial_sigma)) { return p.spatial_sigma; };
constexpr auto kWindowRadius = [](auto& p) -> decltype((p.window_radius)) { return p.window_radius; };
constexpr auto kPatchRadius = [](auto& p) -> decltype((p.patch_radius)) { return p.patch_radius; };
constexpr auto kPatchBlur = [](auto& p) -> decltype((p.patch_blur)) { return p.patch_blur; };
constexpr auto kNoiseThreshold = [](auto& p) -> decltype((p.noise_threshold)) { return p.noise_threshold; };
constexpr auto kRidge = [](auto& p) -> decltype((p.ridge)) { return p.ridge; };
constexpr auto kCurvatureRidge = [](auto& p) -> decltype((p.curvature_ridge)) { return p.curvature_ridge; };
constexpr auto kLevels = [](auto& p) -> decltype((p.levels)) { return p.levels; };
constexpr auto kValueSigma = [](auto& p) -> decltype((p.value_sigma)) { return p.value_sigma; };
constexpr auto kFixedWeight = [](auto& p) -> decltype((p.fixed_weight)) { return p.fixed_weight; };
constexpr auto kNoiseMargin = [](auto& p) -> decltype((p.noise_margin)) { return p.noise_margin; };
constexpr auto kWeightSteps = [](auto& p) -> decltype((p.weight_steps)) { return p.weight_steps; };
constexpr auto kPlain = [](auto& p) -> decltype((p.plain)) { return p.plain; };
constexpr auto kOtherSigma = [](auto& p) -> decltype((p.guides.other_feature_sigma)) {
  return p.guides.other_feature_sigma;
};
constexpr auto kMinFeatureVariance = [](auto& p) -> decltype((p.guides.min_feature_variance)) {
  return p.guides.min_feature_variance;
};
constexpr auto kFeatureSmoothing = [](auto& p) -> decltype((p.guides.smoothing_radius)) {
  return p.guides.smoothing_radius;
};

CrossBilateralParams intermediate(const CrossBilateralParams& /*of*/) { return intermediate_cross_bilateral(); }
CrossBilateralParams intermediate(const GaussianParams& /*of*/) { return intermediate_cross_bilateral(); }
CrossNlmParams intermediate(const CrossNlmParams& /*of*/) { return intermediate_cross_nlm(); }
AdaptiveOrderParams intermediate(const AdaptiveOrderParams& /*of*/) { return intermediate_adaptive_order(); }

/// A filter with a cheaper bank is picked as a whole.
constexpr auto kWithBanks = []<class Params>(Params & p) -> Params& requires requires { intermediate(p); }
{ return p; };

// What a cheaper bank changes.
void take_bank(auto& to, const auto& from) {
  if constexpr (requires { to.spatial_sigmas; }) {
    to.spatial_sigmas = from.spatial_sigmas;
  } else {
    to.window_radius = from.window_radius;
  }
}

void set_bank(Filters& filters, const std::string& name, const std::string& text) {
  constexpr std::array<Word<bool>, 2> kWords = {{{"final", false}, {"intermediate", true}}};
  const bool is_intermediate = choose(name, text, kWords);
  with_member(filters, name, kWithBanks, [&]<class Params>(Params& params) {
    is_intermediate ? take_bank(params, intermediate(params)) : take_bank(params, Params{});
  });
}

void set_distance(Filters& filters, const std::string& name, const std::string& text) {
  constexpr std::array<Word<PatchDistance>, 2> kWords = {
      {{"absolute", PatchDistance::kAbsolute}, {"variance-normalised", PatchDistance::kVarianceNormalised}}};
  const PatchDistance distance = choose(name, text, kWords);
  with_member(filters, name, kDistance, [&](PatchDistance& member) { member = distance; });
}

void set_order(Filters& filters, const std::string& name, const std::string& text) {
  constexpr int kAdaptive = -1;
  constexpr std::array<Word<int>, 4> kWords = {{{"0", 0}, {"1", 1}, {"3", 3}, {"adaptive", kAdaptive}}};
  const int order = choose(name, text, kWords);
  with_member(filters, name, kOrders, [&](std::vector<int>& orders) {
    orders = order == kAdaptive ? AdaptiveOrderParams{}.orders : std::vector<int>{order};
  });
}

void set_order_error(Filters& filters, const std::string& name, const std::string& text) {
  constexpr std::array<Word<OrderError>, 2> kWords = {{{"risk", OrderError::kRisk}, {"taylor", OrderError::kTaylor}}};
  const OrderError error = choose(name, text, kWords);
  with_member(filters, name, kError, [&](OrderError& member) { member = error; });
}

void set_feature_sigma(Filters& filters, const std::string& name, double sigma) {
  with_member(filters, name, kGuides, [&](FeatureGuides& guides) {
    const std::string_view feature = feature_of_option(name);
    std::vector<FeatureSigma>& sigmas = guides.feature_sigmas;
    const auto known = std::find_if(sigmas.begin(), sigmas.end(), [&](const auto& s) { return s.name == feature; });
    FeatureSigma& entry = known != sigmas.end() ? *known : sigmas.emplace_back(FeatureSigma{std::string(feature), 0});
    entry.sigma = static_cast<float>(sigma);
  });
}

template <const auto& pick>
void set_list_of(Filters& filters, const std::string& name, const std::string& text) {
  with_member(filters, name, pick, [&](std::vector<float>& member) { member = parse_list(name, text); });
}

template <const auto& pick>
void set_number_of(Filters& filters, const std::string& name, double value) {
  set_number(filters, name, value, pick);
}

constexpr auto kTexts = std::to_array<Option<Filters, const std::string&>>({
    {"bank", set_bank},
    {"spatial-sigmas", set_list_of<kSpatialSigmas>},
    {"range-sigmas", set_list_of<kRangeSigmas>},
    {"distance", set_distance},
    {"order", set_order},
    {"order-error", set_order_error},
});

constexpr auto kNumbers = std::to_array<Option<Filters, double>>({
    {"other-feature-sigma", set_number_of<kOtherSigma>},
    {"min-feature-variance", set_number_of<kMinFeatureVariance>},
    {"feature-smoothing", set_number_of<kFeatureSmoothing>},
    {"range-sigma", set_number_of<kRangeSigma>},
    {"spatial-sigma", set_number_of<kSpatialSigma>},
    {"window-radius", set_number_of<kWindowRadius>},
    {"patch-radius", set_number_of<kPatchRadius>},
    {"patch-blur", set_number_of<kPatchBlur>},
    {"noise-threshold", set_number_of<kNoiseThreshold>},
    {"ridge", set_number_of<kRidge>},
    {"curvature-ridge", set_number_of<kCurvatureRidge>},
    {"levels", set_number_of<kLevels>},
    {"value-sigma", set_number_of<kValueSigma>},
    {"fixed-weight", set_number_of<kFixedWeight>},
    {"noise-margin", set_number_of<kNoiseMargin>},
    {"weight-steps", set_number_of<kWeightSteps>},
    {"plain", set_number_of<kPlain>},
});

}  // namespace

double whole(const std::string& name, double value, double highest) {
  if (value >= 0 && value <= highest && value == std::floor(value)) return value;
  refuse(name + " is " + to_text(static_cast<float>(value)) + ", must be a whole number in [0.." +
         std::to_string(static_cast<std::uint64_t>(highest)) + "]");
}

std::string_view feature_of_option(std::string_view name) {
  return name.starts_with(kFeatureSigmaPrefix) ? name.substr(kFeatureSigmaPrefix.size()) : std::string_view();
}

bool set_filter_option(Filters& filters, const std::string& name, const std::string& text) {
  const auto* option = find_option(kTexts, name);
  if (option != nullptr) option->set(filters, name, text);
  return option != nullptr;
}

bool set_filter_option(Filters& filters, const std::string& name, double value) {
  if (!feature_of_option(name).empty()) {
    set_feature_sigma(filters, name, value);
    return true;
  }
  const auto* option = find_option(kNumbers, name);
  if (option != nullptr) option->set(filters, name, value);
  return option != nullptr;
}

OptionKind filter_option_kind(std::string_view name) {
  if (find_option(kTexts, name) != nullptr) return OptionKind::kText;
  const bool is_number = find_option(kNumbers, name) != nullptr || !feature_of_option(name).empty();
  return is_number ? OptionKind::kNumber : OptionKind::kNone;
}

std::string filter_option_names() {
  std::string names;
  for (const auto& option : kTexts) names += std::string(option.name) + ", ";
  for (const auto& option : kNumbers) names += std::string(option.name) + ", ";
  return names + std::string(kFeatureSigmaPrefix) + "<feature>";
}

bool has_banks(const FilterSpec& spec) {
  return std::visit(
      [](const auto& params) {
        return requires { intermediate(params); };
      },
      spec);
}

}  // namespace stein
