// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "false_colour.hpp"
#include "picture.hpp"
#include "stein/exr.hpp"
#include "stein/plane.hpp"

namespace stein::cli {

enum class LayerKind {
  kColour,  ///< R, G, B of light or reflectance
  kVector,  ///< X, Y, Z
  kChoice,  ///< small integers
  kScalar,  ///< anything else; the mean where there are several channels
};

struct Layer {
  LayerKind kind = LayerKind::kScalar;
  exr::NamedPlanes planes;
};

/// Finds the channels of a layer ("" is the colour; "albedo", "depth", "error", "covariance.R.G", ...).
/// @throws Error kInvalidFrame naming the layer and what there is instead.
[[nodiscard]] Layer find_layer(const std::string& path, const std::string& name);

/// The channels named, or nothing if the file lacks one of them.
[[nodiscard]] std::optional<exr::NamedPlanes> read_if_present(const std::string& path,
                                                              const std::vector<std::string>& names);

/// Scaled by 2^stops, converted to Rec. 709, clipped and sRGB-encoded.
[[nodiscard]] Picture colour_picture(const exr::NamedPlanes& planes, double stops);

/// Unit vectors as v * 0.5 + 0.5; others, and all where a range is given, from the range to [0, 1].
[[nodiscard]] Picture vector_picture(const exr::NamedPlanes& planes, std::optional<ValueRange> range);

/// Distinct colours with a key.
[[nodiscard]] Picture choice_picture(ConstPlaneView choice);

/// False colours with a scale bar.
[[nodiscard]] Picture scalar_picture(ConstPlaneView plane, std::optional<ValueRange> range);

/// The mean over the channels.
[[nodiscard]] Plane channel_mean(const exr::NamedPlanes& planes);

}  // namespace stein::cli
