// SPDX-License-Identifier: Apache-2.0
//
// Arguments that are more than a number or a word. All throw Error kInvalidArgument naming the option.
#pragma once

#include <string>
#include <utility>

#include "stein/exr.hpp"
#include "stein/filters.hpp"

namespace stein::cli {

/// "lo,hi" with lo < hi
[[nodiscard]] std::pair<double, double> parse_range(const std::string& text);

/// "normal=0.8"
[[nodiscard]] FeatureSigma parse_feature_sigma(const std::string& text);

/// "albedo=Diffuse.R,G,B:var=DiffuseVar.R,G,B": after a name with dots, a name without one is of the same layer.
[[nodiscard]] exr::PlaneMap parse_plane_map(const std::string& text);

}  // namespace stein::cli
