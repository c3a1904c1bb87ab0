// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace stein::cli {

/// Whether both name one file, which need not exist.
[[nodiscard]] bool is_same_file(const std::string& a, const std::string& b);

/// Fails before the work is done rather than after it: the folder must exist and be writable, the path no folder.
/// @throws Error kIo naming the path.
void check_output_path(const std::string& path);

/// The same for what is made of `input`, which it must not be. @throws Error kInvalidArgument, kIo.
void check_output_path(const std::string& path, const std::string& input);

/// The file appears whole or not at all (temporary file in the same folder, renamed). Devices and pipes are written to.
/// @throws Error kIo naming the path.
void write_whole_file(const std::string& path, std::string_view content);

}  // namespace stein::cli
