// SPDX-License-Identifier: Apache-2.0
#include "c/filter_options.hpp"

#include <algorithm>
#include <variant>
#include <vector>

namespace stein::c {
namespace {

// `set` returns whether the parameters of the filter have the option.
template <class Set>
void apply(FilterSpec& spec, const std::string& name, const Set& set) {
  if (!std::visit(set, spec)) refuse("the filter '" + std::string(filter_name(spec)) + "' has no option " + name);
}

// What a cheaper bank changes.
template <class Params>
void take_bank(Params& to, const auto& from) {
  if constexpr (requires { to.spatial_sigmas; }) {
    to.spatial_sigmas = from.spatial_sigmas;
  } else {
    to.window_radius = from.window_radius;
  }
}

CrossBilateralParams intermediate(const CrossBilateralParams& /*of*/) { return intermediate_cross_bilateral(); }
CrossBilateralParams intermediate(const GaussianParams& /*of*/) { return intermediate_cross_bilateral(); }
CrossNlmParams intermediate(const CrossNlmParams& /*of*/) { return intermediate_cross_nlm(); }
AdaptiveOrderParams intermediate(const AdaptiveOrderParams& /*of*/) { return intermediate_adaptive_order(); }

}  // namespace

void set_bank(FilterSpec& spec, const std::string& name, const std::string& text) {
  constexpr std::array<Word<bool>, 2> kWords = {{{"final", false}, {"intermediate", true}}};
  const bool is_intermediate = choose(name, text, kWords);
  apply(spec, name, [&]<class Params>(Params& params) {
    if constexpr (requires { intermediate(params); }) {
      if (is_intermediate) {
        take_bank(params, intermediate(params));
      } else {
        take_bank(params, Params{});
      }
      return true;
    }
    return false;
  });
}

void set_order(FilterSpec& spec, const std::string& name, const std::string& text) {
  constexpr int kAdaptive = -1;
  constexpr std::array<Word<int>, 4> kWords = {{{"0", 0}, {"1", 1}, {"3", 3}, {"adaptive", kAdaptive}}};
  const int order = choose(name, text, kWords);
  apply(spec, name, [&]<class Params>(Params& params) {
    if constexpr (requires { params.orders; }) {
      params.orders = order == kAdaptive ? Params{}.orders : std::vector<int>{order};
      return true;
    }
    return false;
  });
}

void set_judge(FilterSpec& spec, const std::string& name, const std::string& text) {
  constexpr std::array<Word<OrderError>, 2> kWords = {{{"risk", OrderError::kRisk}, {"taylor", OrderError::kTaylor}}};
  const OrderError error = choose(name, text, kWords);
  apply(spec, name, [&](auto& params) {
    if constexpr (requires { params.orders; }) {
      params.error = error;
      return true;
    }
    return false;
  });
}

void set_range_sigma(FilterSpec& spec, const std::string& name, double sigma) {
  apply(spec, name, [&](auto& params) {
    if constexpr (requires { params.range_sigma; }) {
      params.range_sigma = static_cast<float>(sigma);
      return true;
    }
    return false;
  });
}

void set_feature_sigma(FilterSpec& spec, const std::string& name, const std::string& feature, double sigma) {
  apply(spec, name, [&](auto& params) {
    if constexpr (requires { params.guides; }) {
      std::vector<FeatureSigma>& sigmas = params.guides.feature_sigmas;
      const auto known = std::find_if(sigmas.begin(), sigmas.end(), [&](const auto& s) { return s.name == feature; });
      if (known != sigmas.end()) {
        known->sigma = static_cast<float>(sigma);
      } else {
        sigmas.push_back({feature, static_cast<float>(sigma)});
      }
      return true;
    }
    return false;
  });
}

}  // namespace stein::c
