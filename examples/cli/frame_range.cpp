// SPDX-License-Identifier: Apache-2.0
#include "frame_range.hpp"

#include <CLI/Option.hpp>
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "cancel.hpp"
#include "exit_codes.hpp"
#include "frame_numbers.hpp"
#include "stein/error.hpp"

namespace stein::cli {
namespace {

void require_frame_place(const char* what, const std::string& path) {
  if (has_frame_place(path)) return;
  throw Error(ErrorCode::kInvalidArgument, std::string(what) + " '" + path +
                                               "' has no place for the number of the frame: write it as #### or %04d, "
                                               "such as in.####.exr");
}

void check_sequence(DenoiseOptions options) {
  require_frame_place("IN", options.input);
  require_frame_place("-o", options.output);
  if (!options.json.empty()) require_frame_place("--json", options.json);
  options.candidates.for_each_path([](const std::string& path) { require_frame_place("the candidate", path); });
}

/// A sequence without its numbers is told as what it is, not as a file that is missing.
void check_single(const DenoiseOptions& options) {
  std::error_code error;
  if (!has_frame_place(options.input) || std::filesystem::exists(options.input, error)) return;
  throw Error(ErrorCode::kInvalidArgument,
              "'" + options.input + "' is a sequence: say which frames with --frames or --frame");
}

DenoiseOptions options_of_frame(DenoiseOptions options, int frame) {
  options.input = frame_path(options.input, frame);
  options.output = frame_path(options.output, frame);
  options.json = frame_path(options.json, frame);
  options.candidates.for_each_path([frame](std::string& path) { path = frame_path(path, frame); });
  return options;
}

/// Files appear whole or not at all: what exists is done.
bool is_done(const DenoiseOptions& options) {
  std::error_code error;
  return std::filesystem::exists(options.output, error) &&
         (options.json.empty() || std::filesystem::exists(options.json, error));
}

/// The frames asked for; one without a number where there is no sequence.
std::vector<std::optional<int>> frames_asked_for(const DenoiseOptions& options, const FrameRangeOptions& range) {
  if (range.frames.empty() && !range.frame) {
    check_single(options);
    return {std::nullopt};
  }
  check_sequence(options);
  if (range.frame) return {range.frame};
  const std::vector<int> frames = parse_frames(range.frames);
  return {frames.begin(), frames.end()};
}

/// Several frames: failures are told and remembered.
class FrameLoop {
 public:
  FrameLoop(std::size_t frames, const FrameWork& work) : frames_(frames), work_(work) {}

  void run(const FrameTask& task) {
    try {
      work_(task);
    } catch (...) {
      const Failure failure = current_failure();
      if (failure.code() == kCancelledByUser) throw;
      task.progress.clear();
      std::fprintf(stderr, "stein: frame %d: %s\n", *task.frame, failure.what());
      // One frame that another try may help is enough to make it worth while.
      if (failed_.empty() || failure.code() == kTryAgain) code_ = failure.code();
      failed_.push_back(*task.frame);
    }
  }

  void finish() {
    if (failed_.empty()) return;
    std::sort(failed_.begin(), failed_.end());
    throw Failure(code_, std::to_string(failed_.size()) + " of " + std::to_string(frames_) +
                             " frames failed: " + frames_text(failed_));
  }

 private:
  std::size_t frames_;
  const FrameWork& work_;
  ExitCode code_ = kSuccess;
  std::vector<int> failed_;
};

}  // namespace

void declare(CLI::App& verb, FrameRangeOptions& range) {
  CLI::Option* frames = verb.add_option("--frames", range.frames,
                                        "Frames of a sequence, such as 1-10,20-30:2 (:2 is every other); IN, -o and "
                                        "--json have #### or %04d for the number");
  verb.add_option("--frame", range.frame, "One frame of a sequence, such as $SLURM_ARRAY_TASK_ID")->excludes(frames);
  verb.add_flag("--skip-existing", range.skip_existing,
                "Leave out frames whose output, and report if asked for, exist already");
}

void for_each_frame(const DenoiseOptions& options, const FrameRangeOptions& range, const FrameWork& work) {
  catch_interrupts();
  std::vector<std::optional<int>> frames = frames_asked_for(options, range);
  const bool is_alone = frames.size() == 1;
  const auto options_of = [&](std::optional<int> frame) { return frame ? options_of_frame(options, *frame) : options; };
  if (range.skip_existing) {
    const std::size_t asked_for = frames.size();
    std::erase_if(frames, [&](std::optional<int> frame) { return is_done(options_of(frame)); });
    const std::size_t skipped = asked_for - frames.size();
    if (skipped > 0 && !options.quiet) std::printf("skipped   %zu of %zu, which exist\n", skipped, asked_for);
  }
  Progress progress(choose_progress_style(options.quiet));
  FrameLoop loop(frames.size(), work);
  const double share = 1.0 / static_cast<double>(std::max<std::size_t>(frames.size(), 1));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    check_not_interrupted();
    const FrameTask task{options_of(frames[i]), frames[i], is_alone,
                         ProgressPart(progress, static_cast<double>(i) * share, share)};
    is_alone ? work(task) : loop.run(task);
  }
  loop.finish();
}

}  // namespace stein::cli
