// SPDX-License-Identifier: Apache-2.0
#include "stein/denoise.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "cancel.hpp"
#include "denoise_options.hpp"
#include "denoise_report.hpp"
#include "denoise_samples.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "stein/exr.hpp"
#include "verbs.hpp"

namespace stein::cli {
namespace {

// What part of the progress is over when a step is.
constexpr double kReadDone = 0.05;
constexpr double kComputeDone = 0.95;

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
  if (!options.json.empty()) {
    check_output_path(options.json);
  }
}

void run_denoise(const DenoiseOptions& options) {
  catch_interrupts();
  DenoiseParams params = denoise_params(options);
  check_paths(options);

  std::optional<Progress> progress(choose_progress_style(options.quiet));
  params.execution.progress = [&progress](double fraction) {
    progress->show(kReadDone + (kComputeDone - kReadDone) * fraction);
    return !interrupted();
  };
  Seconds seconds;
  Stopwatch watch;
  progress->show(0);
  const exr::LoadedFrame input = read_input(options);
  check_not_interrupted();
  params.luminance_weights = input.luminance_weights();
  seconds.read = watch.lap();

  const DenoiseResult result = stein::denoise(input.frame(), params);
  seconds.compute = watch.lap();

  check_not_interrupted();
  exr::write_result(options.output, input, result, options.write);
  seconds.write = watch.lap();
  seconds.total = seconds.read + seconds.compute + seconds.write;
  progress->show(1);
  progress.reset();

  const int threads = options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
  const DenoiseSummary summary{input, result.report, options.output, options.filter.name, threads, seconds};
  print_warnings(result.report);
  if (!options.quiet) {
    print_summary(summary);
  }
  if (!options.json.empty()) {
    constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;  // file names need not be UTF-8
    write_whole_file(options.json, to_json(summary).dump(2, ' ', false, kReplace) + "\n");
  }
}

}  // namespace

Action add_denoise(CLI::App& verb) {
  auto options = std::make_shared<DenoiseOptions>();
  auto samples = std::make_shared<SampleFilterOptions>();
  declare(verb, *options);
  declare(verb, *samples);
  return [options, samples, &verb] {
    if (reads_samples(verb, *options)) {
      denoise_samples(*options, *samples);
    } else {
      run_denoise(*options);
    }
  };
}

}  // namespace stein::cli
