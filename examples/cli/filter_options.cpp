// SPDX-License-Identifier: Apache-2.0
#include "filter_options.hpp"

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <string_view>

#include "arguments.hpp"
#include "stein/error.hpp"
#include "stein/options.hpp"

namespace stein::cli {

void declare(CLI::App& verb, FilterOptions& options) {
  std::string names;
  for (const std::string_view name : filter_names()) {
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  verb.add_option("--filter", options.name,
                  "auto: those of --quality; or one or more, with commas between, which are mixed: " + names)
      ->capture_default_str();
  verb.add_option("--quality", options.quality, "Which filters auto takes, by their time")
      ->check(CLI::IsMember({"fast", "default", "best"}));
  verb.add_option("--bank", options.bank,
                  "Candidates: all (final), or the cheaper ones for use between batches of samples (intermediate)")
      ->check(CLI::IsMember({"final", "intermediate"}));
  verb.add_option("--range-sigma", options.range_sigma, "Range term on the colour, in radiance; 0: off");
  verb.add_option("--feature-sigma", options.feature_sigmas,
                  "NAME=VALUE: how strongly a feature guides; smaller is stronger, 0: not at all; may be repeated")
      ->delimiter(',')
      ->allow_extra_args(false);
  verb.add_option("--feature-smoothing", options.feature_smoothing,
                  "Radius in pixels of the window that features are smoothed over before they guide, 0 to 5; 0: not");
  verb.add_option(
          "--order", options.order,
          "Of adaptive-order's polynomials: all fits of one order, or the best for each neighbourhood (adaptive)")
      ->check(CLI::IsMember({"0", "1", "3", "adaptive"}));
  verb.add_option("--order-error", options.order_error,
                  "What adaptive-order's fits are judged by: SURE (risk), or fits of two orders more (taylor)")
      ->check(CLI::IsMember({"risk", "taylor"}));
}

void apply(const FilterOptions& options, DenoiseParams& params) {
  params.filters = make_filters(options.name);
  if (!options.quality.empty()) {
    if (options.name != kAuto) {
      throw Error(ErrorCode::kInvalidArgument,
                  "--quality chooses the filters of auto; leave out --filter, or --quality");
    }
    set_option(params, "quality", options.quality);
  }
  if (!options.bank.empty()) set_option(params, "bank", options.bank);
  if (options.range_sigma) set_option(params, "range-sigma", *options.range_sigma);
  for (const std::string& text : options.feature_sigmas) {
    const FeatureSigma feature = parse_feature_sigma(text);
    set_option(params, "feature-sigma." + feature.name, feature.sigma);
  }
  if (options.feature_smoothing) set_option(params, "feature-smoothing", *options.feature_smoothing);
  if (!options.order.empty()) set_option(params, "order", options.order);
  if (!options.order_error.empty()) set_option(params, "order-error", options.order_error);
}

}  // namespace stein::cli
