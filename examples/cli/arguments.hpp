// SPDX-License-Identifier: Apache-2.0
//
// Arguments that are more than a number or a word. All throw Error kInvalidArgument naming the option.
#pragma once

#include <string>
#include <utility>

#include "stein/filters.hpp"

namespace stein::cli {

/// "lo,hi" with lo < hi
[[nodiscard]] std::pair<double, double> parse_range(const std::string& text);

/// "normal=0.8"
[[nodiscard]] FeatureSigma parse_feature_sigma(const std::string& text);

}  // namespace stein::cli
