// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace stein::exr {

/// Walks the attributes of all headers of a file before OpenEXR does: that allocates what an attribute claims as its
/// size before it finds that the file is shorter, and takes attributes of fixed size for that size whatever they claim.
/// @throws Error kIo naming the file: not OpenEXR, ends within its header, or an attribute's size is wrong.
void check_header_sizes(const std::string& path, std::int64_t file_size);

}  // namespace stein::exr
