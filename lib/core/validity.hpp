// SPDX-License-Identifier: Apache-2.0
//
// Which pixels and feature values can be used: the one definition of "invalid", row by row.
#pragma once

#include <string>

#include "exec/runner.hpp"
#include "stein/frame.hpp"

namespace stein {

/// Whether any covariance with the colour is known.
[[nodiscard]] bool has_covariances(const Frame& frame);

/// mask[i] = 1 where the colour of pixel (x + i, y) is usable, else 0. Returns the number of unusable pixels.
int colour_validity_row(const Frame& frame, int y, int x, int count, float* mask);

/// mask[i] = 1 where mean and variance of the feature at pixel (x + i, y) are usable, else 0. Returns the number that
/// are not.
int feature_validity_row(const Feature& feature, int y, int x, int count, float* mask);

/// mask[i] = 1 where colour and layer of pixel (x + i, y) are usable, else 0. Returns the number that are not.
int layer_validity_row(const Frame& frame, const Layer& layer, int y, int x, int count, float* mask);

/// Samples per pixel of pixels [x, x + count) of row y.
void sample_count_row(const Frame& frame, int y, int x, int count, float* n);

/// stein::inspect in the caller's threads.
FrameReport inspect(const Frame& frame, exec::Runner& runner, double progress_weight);

/// "plane 'G' holds nan at pixel (7, 5)"
[[nodiscard]] std::string describe(const BadValue& bad);

/// What messages call the frame: its file, if it comes from one.
[[nodiscard]] std::string name_of(const Frame& frame);

/// Throws on the first repair that the report counts.
void require_clean(const Frame& frame, const FrameReport& report);

}  // namespace stein
