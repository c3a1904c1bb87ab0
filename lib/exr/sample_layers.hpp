// SPDX-License-Identifier: Apache-2.0
//
// What the channels of a file of samples are, by their names in the native schema.
#pragma once

#include <string>
#include <vector>

#include "stein/exr_samples.hpp"

namespace stein::exr {

/// The colour, features (by name), random parameters, others; every name in exactly one layer.
/// @throws Error kInvalidFrame naming the file: R, G or B is missing, a feature has too many channels.
[[nodiscard]] std::vector<SampleLayer> sample_layers(const std::string& path, const std::vector<std::string>& names);

/// @throws Error kInvalidArgument "<action>: ...": no names, an empty, overlong or repeated one.
void check_channel_names(const std::string& action, const std::vector<std::string>& names);

/// The names of all layers in their order.
[[nodiscard]] std::vector<std::string> all_channels(const std::vector<SampleLayer>& layers);

}  // namespace stein::exr
