// SPDX-License-Identifier: Apache-2.0
//
// Parameters by name, for who is told them at run time: these are the options of the command line, of stein.h and of
// the Python package.
#pragma once

#include <string>

#include "stein/denoise.hpp"
#include "stein/filters.hpp"
#include "stein/frame.hpp"

#pragma GCC visibility push(default)
namespace stein {

/// Texts. quality (fast, default, best) takes the place of the filters and their parameters, and of second-pass: set it
/// first. Of the
/// filters that have such a parameter (filters.hpp):
///
///   bank            final, intermediate (cheaper, for use between batches of samples)
///   spatial-sigmas  numbers with commas between, such as 1,2,4; and range-sigmas
///   distance        absolute, variance-normalised
///   order           0, 1, 3, adaptive
///   order-error     risk, taylor
///
/// and of the rest: risk (auto, sure, joint, monte-carlo), selection (evidence, argmin), density-rule (next-samples,
/// all-samples, error-reduction), scratch (a folder, once max-memory is set).
///
/// @throws Error kInvalidArgument if there is no such option, none of the filters has it, or the value is none of the
/// words or not a number. Whether numbers are in range, check(DenoiseParams) says.
void set_option(DenoiseParams& params, const std::string& name, const std::string& text);

/// Numbers; whole ones where they count. Of filters that have such a parameter: feature-sigma.<feature>,
/// other-feature-sigma, min-feature-variance, feature-smoothing, range-sigma, spatial-sigma, window-radius,
/// patch-radius, patch-blur, noise-threshold, ridge, curvature-ridge, levels, value-sigma, fixed-weight, noise-margin,
/// weight-steps, plain (0 or 1); and of the rest: strength, draws, seed (0 to 2^53), outliers, second-pass and strict
/// (0 or 1), threads, tile-width, tile-height, max-memory (bytes; 0: no limit).
void set_option(DenoiseParams& params, const std::string& name, double value);

/// Whether the filter has a cheaper bank, so that the option `bank` is one of its own.
[[nodiscard]] bool has_banks(const FilterSpec& spec);

/// For an option that names a feature, which would be ignored without it.
/// @throws Error kInvalidArgument listing the frame's features if it has none of this name.
void require_feature(const Frame& frame, const std::string& name);

}  // namespace stein
#pragma GCC visibility pop
