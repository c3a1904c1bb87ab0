// SPDX-License-Identifier: Apache-2.0
//
// Frames of a sequence: lists of their numbers, and names of files that hold one.
#pragma once

#include <string>
#include <vector>

namespace stein::cli {

/// "1-10,20-30:2" in the order given, each frame once. @throws Error kInvalidArgument naming --frames.
[[nodiscard]] std::vector<int> parse_frames(const std::string& text);

/// Ascending numbers as `parse_frames` reads them: "1-10,20".
[[nodiscard]] std::string frames_text(const std::vector<int>& frames);

/// Whether a path has a place for a frame number: "in.####.exr", "in.%04d.exr", "in.%d.exr".
[[nodiscard]] bool has_frame_place(const std::string& path);

/// The path with the number in all of its places, with zeros in front up to their width.
[[nodiscard]] std::string frame_path(const std::string& path, int frame);

}  // namespace stein::cli
