// SPDX-License-Identifier: Apache-2.0
#include "arguments.hpp"

#include <cmath>
#include <string_view>

#include "parsing.hpp"

namespace stein::cli {

std::pair<double, double> parse_range(const std::string& text) {
  std::string_view low_text;
  std::string_view high_text;
  double low = 0;
  double high = 0;
  if (!split(text, ',', low_text, high_text) || !parse_number(low_text, low) || !parse_number(high_text, high) ||
      !std::isfinite(low) || !std::isfinite(high) || low >= high) {
    fail_argument("--range", text, "LOW,HIGH with LOW < HIGH, such as 0,0.5");
  }
  return {low, high};
}

FeatureSigma parse_feature_sigma(const std::string& text) {
  std::string_view name;
  std::string_view value;
  FeatureSigma result;
  if (!split(text, '=', name, value) || name.empty() || !parse_number(value, result.sigma)) {
    fail_argument("--feature-sigma", text, "NAME=VALUE, such as normal=0.8");
  }
  result.name = name;
  return result;
}

}  // namespace stein::cli
