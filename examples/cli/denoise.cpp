// SPDX-License-Identifier: Apache-2.0
#include "stein/denoise.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "cancel.hpp"
#include "denoise_options.hpp"
#include "denoise_report.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "stein/density.hpp"
#include "stein/error.hpp"
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
  std::error_code error;
  if (std::filesystem::equivalent(options.input, options.output, error)) {
    throw Error(ErrorCode::kInvalidArgument, "-o " + options.output + " is the input itself: choose another file");
  }
  check_output_path(options.output);
  if (!options.json.empty()) {
    check_output_path(options.json);
  }
}

void check_feature_names(const DenoiseOptions& options, const Frame& frame) {
  for (const std::string& text : options.filter.feature_sigmas) {
    const std::string name = text.substr(0, text.find('='));
    std::string names;
    bool found = false;
    for (const Feature& feature : frame.features) {
      found = found || feature.name == name;
      names += " " + feature.name;
    }
    if (!found) {
      throw Error(ErrorCode::kInvalidArgument, "--feature-sigma: " + options.input + " has no feature '" + name +
                                                   "'; it has:" + (names.empty() ? " none" : names));
    }
  }
}

AllocationParams allocation(const DenoiseOptions& options) {
  return {.budget = options.budget, .min_per_pixel = options.min_samples, .max_per_pixel = options.max_samples};
}

// So that bounds that leave no room for the budget are told before the work, not after it.
void check_budget(const DenoiseOptions& options, const Frame& frame) {
  if (options.budget >= 0) {
    const Plane any_density(frame.width, frame.height);
    static_cast<void>(allocate_samples(any_density.view(), allocation(options)));
  }
}

void write_output(const DenoiseOptions& options, const exr::LoadedFrame& input, const DenoiseResult& result) {
  exr::WriteOptions write = options.write;
  std::vector<std::uint32_t> samples;
  if (options.budget >= 0) {
    samples = allocate_samples(result.density.view(), allocation(options));
    write.samples = &samples;
  }
  check_not_interrupted();
  exr::write_result(options.output, input, result, write);
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
  const bool needs_covariances = params.risk != Risk::kPlain;
  const exr::LoadedFrame input =
      exr::read_frame(options.input, {.samples_per_pixel = options.samples, .read_covariances = needs_covariances});
  check_feature_names(options, input.frame());
  check_budget(options, input.frame());
  check_not_interrupted();
  params.luminance_weights = input.luminance_weights();
  seconds.read = watch.lap();

  const DenoiseResult result = stein::denoise(input.frame(), params);
  seconds.compute = watch.lap();

  write_output(options, input, result);
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
  declare(verb, *options);
  return [options] { run_denoise(*options); };
}

}  // namespace stein::cli
