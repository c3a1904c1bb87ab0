// SPDX-License-Identifier: Apache-2.0
//
// Which channels of a file make the layers that are asked for.
#pragma once

#include <string>
#include <vector>

#include "exr/layout.hpp"

namespace stein::exr {

struct LayerLayout {
  std::string name;
  std::vector<int> mean;  ///< R, G and B, or one channel
};

/// By the names of ReadOptions::layers.
/// @throws Error kInvalidArgument for a name that is no layer, or cannot be filtered.
[[nodiscard]] std::vector<LayerLayout> find_layers(const SourceFile& file, const Layout& layout,
                                                   const std::vector<std::string>& names);

}  // namespace stein::exr
