// SPDX-License-Identifier: Apache-2.0
//
// What another denoiser has to be run on as well, for its error to be known.
#include <CLI/Option.hpp>
#include <cstdint>
#include <cstdio>
#include <memory>

#include "cancel.hpp"
#include "denoise_options.hpp"
#include "frame_range.hpp"
#include "output_file.hpp"
#include "stein/candidate.hpp"
#include "stein/exr.hpp"
#include "verbs.hpp"

namespace stein::cli {
namespace {

constexpr double kReadDone = 0.4;
constexpr double kMoveDone = 0.6;

constexpr const char* kPerturbFooter =
    "OUT is as IN, but for its colour and features, which are moved by a random step of their noise; its attributes "
    "say\n"
    "by which. Run another denoiser on IN and on OUT, with the same settings, and hand both results to 'stein "
    "denoise':\n"
    "docs/candidates.md.\n"
    "\n"
    "Examples:\n"
    "  stein perturb noisy.exr -o perturbed.exr\n"
    "  stein perturb noisy.exr -o perturbed1.exr --draw 1\n"
    "  stein perturb noisy.####.exr -o perturbed.####.exr --frames 1-100\n"
    "  stein denoise noisy.exr -o clean.exr --candidate oidn.exr --candidate-perturbed oidn_perturbed.exr";

struct PerturbOptions {
  DenoiseOptions files;  // its paths, how they are read, and how it runs
  Perturbation perturbation{.step = kExternalStep};
  FrameRangeOptions range;
};

void declare(CLI::App& verb, PerturbOptions& options) {
  DenoiseOptions& files = options.files;
  verb.add_option("IN", files.input, "OpenEXR file with the noisy image and its variances")->required();
  verb.add_option("-o,--output", files.output, "OpenEXR file to write; not IN itself")->required();
  verb.add_option("--draw", options.perturbation.draw, "Which of the independent steps of a seed, from 0")
      ->capture_default_str();
  verb.add_option("--seed", options.perturbation.seed, "Of the steps")->capture_default_str();
  verb.add_option("--step", options.perturbation.step, "Size of the step, in standard deviations of the noise")
      ->capture_default_str();
  declare(verb, files.samples);
  declare(verb, files.mapping);
  declare(verb, options.range);
  verb.add_option("--threads", files.threads, "Most threads to use; 0: all that affinity mask and CPU quota allow")
      ->capture_default_str();
  verb.add_flag("--quiet", files.quiet, "No progress and no summary");
  verb.footer(kPerturbFooter);
}

void perturb_frame(const FrameTask& task, const Perturbation& perturbation) {
  const DenoiseOptions& options = task.options;
  check_output_path(options.output, options.input);
  const auto report_to = [&task](double begin, double end) {
    return [&task, begin, end](double fraction) {
      task.progress.show(begin + (end - begin) * fraction);
      return !interrupted();
    };
  };
  const exr::LoadedFrame input = read_input(options, {}, report_to(0, kReadDone));
  Execution execution;
  execution.threads = options.threads;
  execution.progress = report_to(kReadDone, kMoveDone);
  const PerturbedFrame moved(input.frame(), perturbation, execution);
  check_not_interrupted();
  exr::write_perturbed(options.output, moved.frame(), input, perturbation, report_to(kMoveDone, 1));
  task.progress.clear();
  if (options.quiet) return;
  std::printf("%s -> %s: draw %d of seed %llu, step %g\n", options.input.c_str(), options.output.c_str(),
              perturbation.draw, static_cast<unsigned long long>(perturbation.seed),
              static_cast<double>(perturbation.step));
}

}  // namespace

Action add_perturb(CLI::App& verb) {
  auto options = std::make_shared<PerturbOptions>();
  declare(verb, *options);
  return [options] {
    check(options->perturbation);
    for_each_frame(options->files, options->range,
                   [&](const FrameTask& task) { perturb_frame(task, options->perturbation); });
  };
}

}  // namespace stein::cli
