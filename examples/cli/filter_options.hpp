// SPDX-License-Identifier: Apache-2.0
//
// The options that choose and tune a filter.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stein/denoise.hpp"
#include "verbs.hpp"

namespace stein::cli {

inline constexpr const char* kAuto = "auto";

struct FilterOptions {
  std::string name = kAuto;
  std::string quality;  ///< empty: the default
  std::string bank;     ///< empty: the filter's own
  std::optional<float> range_sigma;
  std::vector<std::string> feature_sigmas;
  std::optional<double> feature_smoothing;
  std::string order;        ///< of a regression; empty: the filter's own
  std::string order_error;  ///< what judges it; empty: the filter's own
};

/// Declares them; `options` must outlive the parsing.
void declare(CLI::App& verb, FilterOptions& options);

/// @throws Error kInvalidArgument.
void apply(const FilterOptions& options, DenoiseParams& params);

}  // namespace stein::cli
