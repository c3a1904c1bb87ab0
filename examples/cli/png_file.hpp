// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "picture.hpp"

namespace stein::cli {

/// Written whole or not at all. @throws Error kIo naming the path.
void write_png(const std::string& path, const Picture& picture);

}  // namespace stein::cli
