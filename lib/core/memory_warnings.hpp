// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "stein/memory.hpp"

namespace stein {

/// What a user should know of how memory under a limit was used, in words.
void add_memory_warnings(const MemoryUsage& usage, std::vector<std::string>& warnings);

}  // namespace stein
