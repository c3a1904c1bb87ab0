// SPDX-License-Identifier: Apache-2.0
//
// The loop of adaptive sampling for renderers out of process: from the planes of the samples so far to the counts of
// the next batch.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cancel.hpp"
#include "denoise_options.hpp"
#include "denoise_report.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "stein/density.hpp"
#include "stein/options.hpp"
#include "verbs.hpp"

namespace stein::cli {
namespace {

constexpr const char* kSampleMapFooter =
    "COUNTS holds samples.V (uint): how many further samples each pixel should get, in the pixels of IN's data "
    "window.\n"
    "Their sum is the budget, exactly. Pixels that already have what they need get none. Render them, merge them with\n"
    "those of IN (mean, variance of the mean, sampleCount), and ask again, or denoise: docs/adaptive.md.\n"
    "\n"
    "Examples:\n"
    "  stein sample-map pass1.exr -o counts.exr --budget 1000000\n"
    "  stein sample-map pass1.exr -o counts.exr --budget 1000000 --min-samples 1 --max-samples 64\n"
    "  stein sample-map pass1.exr -o counts.exr --budget 1000000 --filter cross-nlm --bank intermediate";

struct SampleMapOptions {
  DenoiseOptions method;
  std::string density = "all-samples";
  AllocationParams allocation;
};

void declare(CLI::App& verb, SampleMapOptions& options) {
  options.method.filter.name = CrossBilateralParams::kName;
  declare_method(verb, options.method);
  verb.add_option("--budget", options.allocation.budget, "Samples to hand out in all")
      ->required()
      ->check(CLI::NonNegativeNumber);
  verb.add_option("--min-samples", options.allocation.min_per_pixel, "Least samples of a pixel")->capture_default_str();
  verb.add_option("--max-samples", options.allocation.max_per_pixel, "Most samples of a pixel");
  verb.add_option("--density", options.density,
                  "What counts follow: least noise of all samples; the error that the next ones take away; or, of the "
                  "next ones, error and variance")
      ->check(CLI::IsMember({"all-samples", "error-reduction", "next-samples"}))
      ->capture_default_str();
  verb.footer(kSampleMapFooter);
}

DenoiseParams params_of(SampleMapOptions& options) {
  FilterOptions& filter = options.method.filter;
  const std::vector<FilterSpec> filters = make_filters(filter.name);
  if (filter.bank.empty() && std::any_of(filters.begin(), filters.end(), has_banks)) filter.bank = "intermediate";
  DenoiseParams params = denoise_params(options.method);
  set_option(params, "density-rule", options.density);
  return params;
}

// Samples of every pixel so far, also where the file gives one number for all.
Plane samples_so_far(const Frame& frame) {
  Plane counts(frame.width, frame.height);
  for (int y = 0; y < frame.height; ++y) {
    if (frame.sample_count) {
      frame.sample_count.read_row(y, 0, frame.width, counts.row(y));
    } else {
      std::fill_n(counts.row(y), frame.width, frame.uniform_sample_count);
    }
  }
  return counts;
}

void run_sample_map(SampleMapOptions& options) {
  catch_interrupts();
  DenoiseParams params = params_of(options);
  check_output_path(options.method.output, options.method.input);

  std::optional<Progress> progress(choose_progress_style(options.method.quiet));
  params.execution.progress = [&progress](double fraction) {
    progress->show(fraction);
    return !interrupted();
  };
  const exr::LoadedFrame input = read_input(options.method, {}, [](double) { return !interrupted(); });
  const Frame& frame = input.frame();
  // So that bounds that leave no room for the budget are told before the work, not after it.
  static_cast<void>(allocate_samples(Plane(frame.width, frame.height).view(), options.allocation));
  params.luminance_weights = input.luminance_weights();

  const DenoiseResult result = stein::denoise(frame, params);
  const Plane so_far = samples_so_far(frame);
  const bool is_of_all = params.density.rule == DensityRule::kAllSamples;
  const std::vector<std::uint32_t> counts =
      allocate_samples(result.density.view(), options.allocation, is_of_all ? so_far.view() : ConstPlaneView{});
  check_not_interrupted();
  const ConstPlaneView view(counts.data(), ScalarType::kUint32, frame.width, frame.height);
  exr::write_planes(options.method.output, {{"samples.V", view}}, {input.data_window()[0], input.data_window()[1]});
  progress.reset();
  print_warnings(options.method.input, result.report);
  if (!options.method.quiet) {
    std::printf("%s -> %s\n", options.method.input.c_str(), options.method.output.c_str());
    std::printf("  estimated relative error so far: %.5f\n", result.report.mean_relative_error);
    std::printf("  %lld samples: %.2f per pixel, at most %u in one\n",
                static_cast<long long>(options.allocation.budget),
                static_cast<double>(options.allocation.budget) / (static_cast<double>(frame.width) * frame.height),
                *std::max_element(counts.begin(), counts.end()));
  }
}

}  // namespace

Action add_sample_map(CLI::App& verb) {
  auto options = std::make_shared<SampleMapOptions>();
  declare(verb, *options);
  return [options] { run_sample_map(*options); };
}

}  // namespace stein::cli
