// SPDX-License-Identifier: Apache-2.0
#include "filter_options.hpp"

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <string_view>
#include <variant>

#include "arguments.hpp"
#include "stein/error.hpp"

namespace stein::cli {
namespace {

// An option belongs to every filter whose parameters have a member of its name: `set` returns whether they have.
template <class Setter>
void apply(const char* option, FilterSpec& spec, Setter set) {
  if (!std::visit(set, spec)) {
    throw Error(ErrorCode::kInvalidArgument,
                std::string(option) + ": the filter '" + std::string(filter_name(spec)) + "' has no such parameter");
  }
}

void set_feature_sigma(std::vector<FeatureSigma>& sigmas, const FeatureSigma& wanted) {
  const auto known = std::find_if(sigmas.begin(), sigmas.end(), [&](const auto& s) { return s.name == wanted.name; });
  if (known != sigmas.end()) {
    known->sigma = wanted.sigma;
  } else {
    sigmas.push_back(wanted);
  }
}

void make_intermediate(CrossBilateralParams& params) {
  params.spatial_sigmas = intermediate_cross_bilateral().spatial_sigmas;
}
void make_intermediate(GaussianParams& params) {
  params.spatial_sigmas = intermediate_cross_bilateral().spatial_sigmas;
}
void make_intermediate(CrossNlmParams& params) { params.window_radius = intermediate_cross_nlm().window_radius; }
void make_intermediate(AdaptiveOrderParams& params) {
  params.window_radius = intermediate_adaptive_order().window_radius;
}

void set_bank(FilterSpec& spec, const std::string& bank) {
  apply("--bank", spec, [&](auto& params) {
    if constexpr (requires { make_intermediate(params); }) {
      if (bank == "intermediate") make_intermediate(params);
      return true;
    }
    return false;
  });
}

void set_order(FilterSpec& spec, const std::string& order) {
  apply("--order", spec, [&](auto& params) {
    if constexpr (requires { params.orders; }) {
      if (order != "adaptive") params.orders = {order.front() - '0'};
      return true;
    }
    return false;
  });
}

void set_order_error(FilterSpec& spec, const std::string& error) {
  apply("--order-error", spec, [&](auto& params) {
    if constexpr (requires { params.orders; }) {
      params.error = error == "taylor" ? OrderError::kTaylor : OrderError::kRisk;
      return true;
    }
    return false;
  });
}

void set_range_sigma(FilterSpec& spec, float sigma) {
  apply("--range-sigma", spec, [&](auto& params) {
    if constexpr (requires { params.range_sigma; }) {
      params.range_sigma = sigma;
      return true;
    }
    return false;
  });
}

void set_feature_sigmas(FilterSpec& spec, const std::vector<std::string>& texts) {
  apply("--feature-sigma", spec, [&](auto& params) {
    if constexpr (requires { params.guides; }) {
      for (const std::string& text : texts) {
        set_feature_sigma(params.guides.feature_sigmas, parse_feature_sigma(text));
      }
      return true;
    }
    return false;
  });
}

}  // namespace

void declare(CLI::App& verb, FilterOptions& options) {
  std::string names;
  for (const std::string_view name : filter_names()) {
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  options.name = filter_names().front();
  verb.add_option("--filter", options.name, "One of: " + names)->capture_default_str();
  verb.add_option("--bank", options.bank,
                  "Candidates: all (final), or the cheaper ones for use between batches of samples (intermediate)")
      ->check(CLI::IsMember({"final", "intermediate"}));
  verb.add_option("--range-sigma", options.range_sigma, "Range term on the colour, in radiance; 0: off");
  verb.add_option("--feature-sigma", options.feature_sigmas,
                  "NAME=VALUE: how strongly a feature guides; smaller is stronger, 0: not at all; may be repeated")
      ->delimiter(',')
      ->allow_extra_args(false);
  verb.add_option(
          "--order", options.order,
          "Of adaptive-order's polynomials: all fits of one order, or the best for each neighbourhood (adaptive)")
      ->check(CLI::IsMember({"0", "1", "3", "adaptive"}));
  verb.add_option("--order-error", options.order_error,
                  "What adaptive-order's fits are judged by: SURE (risk), or fits of two orders more (taylor)")
      ->check(CLI::IsMember({"risk", "taylor"}));
}

bool has_intermediate_bank(const std::string& filter) {
  return std::visit(
      [](auto params) {
        return requires { make_intermediate(params); };
      },
      make_filter(filter));
}

FilterSpec filter_spec(const FilterOptions& options) {
  FilterSpec spec = make_filter(options.name);
  if (!options.bank.empty()) {
    set_bank(spec, options.bank);
  }
  if (options.range_sigma) {
    set_range_sigma(spec, *options.range_sigma);
  }
  if (!options.feature_sigmas.empty()) {
    set_feature_sigmas(spec, options.feature_sigmas);
  }
  if (!options.order.empty()) {
    set_order(spec, options.order);
  }
  if (!options.order_error.empty()) {
    set_order_error(spec, options.order_error);
  }
  return spec;
}

}  // namespace stein::cli
