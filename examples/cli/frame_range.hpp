// SPDX-License-Identifier: Apache-2.0
//
// One run of `stein denoise` over a frame, or over the frames of a sequence.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "denoise_options.hpp"
#include "progress.hpp"
#include "verbs.hpp"

namespace stein::cli {

struct FrameRangeOptions {
  std::string frames;
  std::optional<int> frame;
  bool skip_existing = false;
};

/// Declares them; `range` must outlive the parsing.
void declare(CLI::App& verb, FrameRangeOptions& range);

/// What is to be done for one frame.
struct FrameTask {
  DenoiseOptions options;    ///< with the frame's own paths
  std::optional<int> frame;  ///< its number; absent where the paths are what was given
  bool is_alone = true;      ///< false: one of several, which is told in a line
  ProgressPart progress;
};

using FrameWork = std::function<void(const FrameTask&)>;

/// Calls `work` for each frame; one that fails is told and does not keep the others from being done.
/// @throws Error kInvalidArgument before any work; what the work throws if there is one frame, or if it was cancelled;
/// Failure in the end if some of several frames failed.
void for_each_frame(const DenoiseOptions& options, const FrameRangeOptions& range, const FrameWork& work);

}  // namespace stein::cli
