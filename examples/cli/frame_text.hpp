// SPDX-License-Identifier: Apache-2.0
//
// How a frame was understood, in words; shared by `stein info` and the summary of `stein denoise`.
#pragma once

#include <string>

#include "stein/exr.hpp"

namespace stein::cli {

/// "512x512", with the data window where it does not start at 0,0.
[[nodiscard]] std::string size_text(const exr::LoadedFrame& input);

/// "8 per pixel" or "4 to 64 per pixel".
[[nodiscard]] std::string samples_text(const Frame& frame);

/// "variance, covariances", or what there is of them.
[[nodiscard]] std::string colour_text(const Frame& frame);

/// "normal (3 channels, variance, covariance)"
[[nodiscard]] std::string feature_text(const Feature& feature);

}  // namespace stein::cli
