// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "stein/frame.hpp"

namespace stein::cli {

using NamedView = std::pair<std::string, ConstPlaneView>;

/// By feature: the names of its components, such as X, Y, Z, where they are not the conventional ones.
using Components = std::map<std::string, std::vector<std::string>>;

/// Every plane that the frame has, under its name in the native schema.
[[nodiscard]] std::vector<NamedView> all_planes(const Frame& frame, const Components& components = {});

}  // namespace stein::cli
