// SPDX-License-Identifier: Apache-2.0
#include "stein/denoise.hpp"

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cancel.hpp"
#include "denoise_options.hpp"
#include "denoise_report.hpp"
#include "denoise_samples.hpp"
#include "frame_range.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "stein/error.hpp"
#include "stein/exr.hpp"
#include "verbs.hpp"

namespace stein::cli {
namespace {

// What part of the progress is over when a step is.
constexpr double kReadDone = 0.2;
constexpr double kComputeDone = 0.7;

class Stopwatch {
 public:
  /// Seconds since the last call, or since the start.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> elapsed = now - last_;
    last_ = now;
    return elapsed.count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void check_paths(const DenoiseOptions& options) {
  check_output_path(options.output, options.input);
  CandidateOptions candidates = options.candidates;
  candidates.for_each_path([&](const std::string& path) {
    if (!is_same_file(path, options.output)) return;
    throw Error(ErrorCode::kInvalidArgument, "-o " + options.output + " is a candidate's image: choose another file");
  });
  if (options.json.empty()) return;
  if (is_same_file(options.json, options.input) || is_same_file(options.json, options.output)) {
    throw Error(ErrorCode::kInvalidArgument, "--json " + options.json + " is the image: choose another file");
  }
  check_output_path(options.json);
}

// Asked between the chunks of a file, and between tiles.
std::function<bool(double)> report_to(const ProgressPart& progress, double begin, double end) {
  return [&progress, begin, end](double fraction) {
    progress.show(begin + (end - begin) * fraction);
    return !interrupted();
  };
}

void report(const FrameTask& task, const std::vector<DenoiseSummary>& views) {
  task.progress.clear();
  for (const DenoiseSummary& view : views) {
    print_warnings(view.input.frame().origin, view.report);
    if (!task.options.quiet) task.is_alone ? print_summary(view) : print_line_of_frame(view);
  }
  if (!task.options.json.empty()) {
    constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;  // file names need not be UTF-8
    write_whole_file(task.options.json, to_json(views).dump(2, ' ', false, kReplace) + "\n");
  }
}

// The view that was asked for, or all that the file has.
std::vector<exr::LoadedFrame> read_views(DenoiseOptions options, const std::shared_ptr<Memory>& memory,
                                         const ProgressPart& progress) {
  std::vector<exr::LoadedFrame> views;
  views.push_back(read_input(options, memory, report_to(progress, 0, kReadDone)));
  if (!options.mapping.view.empty()) return views;
  const std::vector<std::string> names = views.front().views();
  for (std::size_t v = 1; v < names.size(); ++v) {
    options.mapping.view = names[v];
    views.push_back(read_input(options, memory, report_to(progress, kReadDone, kReadDone)));
  }
  return views;
}

// The candidates' files are of one.
void require_one_view(const std::vector<exr::LoadedFrame>& views, const LoadedCandidates& candidates) {
  if (views.size() == 1 || candidates.list.empty()) return;
  throw Error(ErrorCode::kInvalidArgument,
              "'" + views.front().path() + "' has several views, and a candidate is of one; choose it with --view");
}

void denoise_frame(const FrameTask& task, DenoiseParams params) {
  DenoiseOptions options = task.options;
  check_paths(options);
  // Of each frame: what it needs is told with it.
  if (params.execution.memory) params.execution.memory = std::make_shared<Memory>(params.execution.memory->limit());
  Seconds seconds;
  Stopwatch watch;
  task.progress.show(0);
  const std::vector<exr::LoadedFrame> views = read_views(options, params.execution.memory, task.progress);
  check_not_interrupted();
  const LoadedCandidates candidates =
      read_candidates(options.candidates, params.execution.memory.get(), check_not_interrupted);
  require_one_view(views, candidates);
  params.candidates = candidates.list;
  seconds.read = watch.lap();

  std::vector<DenoiseResult> results;
  for (const exr::LoadedFrame& view : views) {
    const auto share = [&](std::size_t done) {
      return kReadDone + (kComputeDone - kReadDone) * static_cast<double>(done) / static_cast<double>(views.size());
    };
    params.luminance_weights = view.luminance_weights();
    params.execution.progress = report_to(task.progress, share(results.size()), share(results.size() + 1));
    results.push_back(stein::denoise(view.frame(), params));
  }
  seconds.compute = watch.lap();

  options.write.progress = report_to(task.progress, kComputeDone, 1);
  std::vector<exr::ViewResult> filtered;
  for (std::size_t v = 0; v < views.size(); ++v) filtered.push_back({views[v], results[v]});
  exr::write_results(options.output, filtered, options.write);
  seconds.write = watch.lap();
  if (params.execution.memory) warn_if_exceeded(*params.execution.memory, results.front().report.warnings);
  seconds.total = seconds.read + seconds.compute + seconds.write;
  task.progress.show(1);

  const int threads = options.threads > 0 ? options.threads : available_threads();
  std::vector<DenoiseSummary> summaries;
  for (const exr::ViewResult& view : filtered) {
    summaries.push_back(
        {view.source, view.result.report, options.output, options.filter.name, threads, seconds, task.frame});
  }
  report(task, summaries);
}

}  // namespace

Action add_denoise(CLI::App& verb) {
  auto options = std::make_shared<DenoiseOptions>();
  auto range = std::make_shared<FrameRangeOptions>();
  auto samples = std::make_shared<SampleFilterOptions>();
  declare(verb, *options);
  declare(verb, *range);
  declare(verb, *samples);
  return [options, range, samples, &verb] {
    if (reads_samples(verb, *options)) {
      if (!range->frames.empty() && !samples->adjacent.empty()) {
        throw Error(ErrorCode::kInvalidArgument, "--adjacent names the neighbours of one frame: use --frame with it");
      }
      const RpfParams params = rpf_params(*options, *samples);
      for_each_frame(*options, *range,
                     [&](const FrameTask& task) { denoise_samples(task, params, samples->adjacent); });
    } else {
      const DenoiseParams params = denoise_params(*options);
      check(options->candidates);
      for_each_frame(*options, *range, [&](const FrameTask& task) { denoise_frame(task, params); });
    }
  };
}

}  // namespace stein::cli
