// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "stein/frame.hpp"

namespace stein::cli {

using NamedView = std::pair<std::string, ConstPlaneView>;

/// Every plane that the frame has, under its name in the native schema.
[[nodiscard]] std::vector<NamedView> all_planes(const Frame& frame);

}  // namespace stein::cli
