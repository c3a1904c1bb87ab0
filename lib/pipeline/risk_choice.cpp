// SPDX-License-Identifier: Apache-2.0
#include "pipeline/risk_choice.hpp"

#include <algorithm>

#include "core/validity.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

// Whether the weights depend on the colours.
template <class Params>
bool compares_colours(const Params& params) {
  if constexpr (requires { params.range_sigma; }) return params.range_sigma > 0.0F;
  if constexpr (requires { params.value_sigma; }) return params.value_sigma > 0.0F;
  if constexpr (requires { params.range_sigmas; }) return !params.range_sigmas.empty();
  return false;
}

// Whether features take part at all.
template <class Params>
bool reads_features(const Params& params) {
  if constexpr (requires { params.orders; }) return params.orders.back() > 0;
  return true;
}

// What the filter is guided by and is noisy, by whether its covariance with the colour is known.
struct NoisyGuides {
  std::vector<std::string> known;
  std::vector<std::string> unknown;
};

NoisyGuides noisy_guides(const Frame& frame, const FilterSpec& spec) {
  NoisyGuides noisy;
  std::visit(
      [&](const auto& params) {
        if constexpr (requires { params.guides; }) {
          for (const Feature& feature : frame.features) {
            if (!reads_features(params)) break;
            if (params.guides.sigma_of(feature.name) <= 0.0F || feature.variance.empty()) continue;
            (feature.colour_covariance.empty() ? noisy.unknown : noisy.known).push_back(feature.name);
          }
        }
        if (compares_colours(params))
          (frame.colour_covariance[0] ? noisy.known : noisy.unknown).emplace_back("the colour channels");
      },
      spec);
  return noisy;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

// Why, if the filter has one as a rule.
std::string missing_closed_form(const FilterSpec& filter) {
  const bool is_usual =
      std::visit([](const auto& params) { return std::remove_cvref_t<decltype(params)>::kHasDerivative; }, filter);
  return is_usual ? " with smoothed features" : "";
}

void require_closed_form(const FilterSpec& filter, Risk risk) {
  if (risk == Risk::kAuto || risk == Risk::kMonteCarlo || has_derivative(filter)) return;
  throw Error(ErrorCode::kInvalidArgument, "the filter '" + std::string(filter_name(filter)) +
                                               "' has no risk in closed form" + missing_closed_form(filter) +
                                               "; choose the Monte Carlo risk");
}

void require_covariances(const Frame& frame, const NoisyGuides& noisy) {
  if (noisy.unknown.empty()) return;
  throw Error(ErrorCode::kInvalidFrame, (frame.origin.empty() ? std::string("frame") : frame.origin) +
                                            ": the joint risk needs the covariances of the colour with " +
                                            joined(noisy.unknown) +
                                            ", which are missing; supply them, or choose the plain risk");
}

RiskChoice make_choice(Risk method, std::string name, std::string reason, const NoisyGuides& noisy) {
  RiskChoice choice;
  choice.method = method;
  choice.name = std::move(name);
  choice.reason = std::move(reason);
  choice.knows_covariances = noisy.unknown.empty();
  if (!noisy.unknown.empty()) {
    choice.warnings.push_back("the covariances of the colour with " + joined(noisy.unknown) +
                              " are missing and count as 0: where they are noisy together with the colour the "
                              "estimated error is too low");
  }
  return choice;
}

RiskChoice monte_carlo(const Frame& frame, const NoisyGuides& noisy, std::string reason) {
  const std::string name = has_covariances(frame) ? "Monte Carlo joint SURE" : "Monte Carlo SURE";
  return make_choice(Risk::kMonteCarlo, name, std::move(reason), noisy);
}

bool counts_events(const FilterSpec& filter) {
  return std::visit(
      []<class Params>(const Params&) {
        return requires { Params::kCountsEvents; };
      },
      filter);
}

RiskChoice closed_form(NoisyGuides noisy, const FilterSpec& filter, Risk wanted) {
  const std::string asked = "it was asked for";
  if (wanted == Risk::kPlain) {  // leaves out what is known
    noisy.unknown.insert(noisy.unknown.end(), noisy.known.begin(), noisy.known.end());
    return make_choice(Risk::kPlain, "SURE", asked, noisy);
  }
  if (!noisy.known.empty()) {
    const std::string found = "the frame has the covariances";
    const std::string reason = counts_events(filter) ? found + "; noise of few events as such" : found;
    return make_choice(Risk::kJoint, "joint SURE", wanted == Risk::kJoint ? asked : reason, noisy);
  }
  return make_choice(
      Risk::kPlain, "SURE",
      noisy.unknown.empty() ? "nothing that guides the filter is noisy" : "covariances with the colour are missing",
      noisy);
}

bool is_taylor(const FilterSpec& spec) {
  const auto* regression = std::get_if<AdaptiveOrderParams>(&spec);
  return regression != nullptr && regression->error == OrderError::kTaylor;
}

RiskChoice taylor(const DenoiseParams& params) {
  if (params.risk != Risk::kAuto) {
    throw Error(ErrorCode::kInvalidArgument,
                "adaptive-order: the error by Taylor expansion takes the place of the risk; leave the risk at auto, or "
                "choose OrderError::kRisk");
  }
  if (params.density.rule == DensityRule::kAllSamples) {
    throw Error(ErrorCode::kInvalidArgument,
                "adaptive-order: the density of all samples needs the divergence that the error by Taylor expansion "
                "does not give; choose OrderError::kRisk, or DensityRule::kErrorReduction");
  }
  if (params.filters.size() + params.candidates.size() > 1) {
    throw Error(
        ErrorCode::kInvalidArgument,
        "adaptive-order: the error by Taylor expansion is no risk by which several filters can be mixed; choose "
        "OrderError::kRisk, or adaptive-order alone");
  }
  RiskChoice choice;
  choice.method = Risk::kPlain;
  choice.name = "Taylor expansion";
  choice.reason = "it was asked for";
  return choice;
}

}  // namespace

RiskChoice choose_risk(const Frame& frame, const FilterSpec& filter, const DenoiseParams& params) {
  if (is_taylor(filter)) return taylor(params);
  require_closed_form(filter, params.risk);
  const NoisyGuides noisy = noisy_guides(frame, filter);
  if (params.risk == Risk::kMonteCarlo) return monte_carlo(frame, noisy, "it was asked for");
  if (!has_derivative(filter))
    return monte_carlo(frame, noisy, "the filter has no closed form" + missing_closed_form(filter));
  if (params.risk == Risk::kJoint) require_covariances(frame, noisy);
  return closed_form(noisy, filter, params.risk);
}

RiskChoice external_risk(const Frame& frame, int draws) {
  NoisyGuides noisy;
  for (const Feature& feature : frame.features) {
    if (feature.variance.empty()) continue;
    (feature.colour_covariance.empty() ? noisy.unknown : noisy.known).push_back(feature.name);
  }
  (frame.colour_covariance[0] ? noisy.known : noisy.unknown).emplace_back("the colour channels");
  return monte_carlo(frame, noisy,
                     "from " + std::to_string(draws) + (draws == 1 ? " perturbed run" : " perturbed runs"));
}

}  // namespace stein
