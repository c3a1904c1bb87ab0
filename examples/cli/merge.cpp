// SPDX-License-Identifier: Apache-2.0
//
// Several renders of one view become one frame with variances and covariances.
#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cancel.hpp"
#include "frame_text.hpp"
#include "mapping_options.hpp"
#include "merge_input.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "stein/accumulate.hpp"
#include "stein/exr.hpp"
#include "verbs.hpp"

namespace stein::cli {
namespace {

constexpr double kAccumulated = 0.9;  // what part of the progress is over then

struct MergeOptions {
  std::vector<std::string> inputs;
  std::string output;
  std::vector<float> samples;
  MappingOptions mapping;
  bool spread = false;
  bool quiet = false;
};

constexpr const char* kMergeFooter =
    "The files are renders of one view with different seeds; how many samples each has may differ. Size, data window "
    "and\n"
    "features must agree. Where the files have variances of the colour and of all features, these are pooled. Where\n"
    "they do not, or with --spread, variances and covariances come from how the files differ, and OUT says in the\n"
    "attribute stein:degreesOfFreedom how well they are known: one less than there are files. Four files or more are\n"
    "worth having then. What is neither colour nor feature is taken from the first file as it is.\n"
    "\n"
    "Examples:\n"
    "  stein merge seed0.exr seed1.exr seed2.exr seed3.exr -o merged.exr\n"
    "  stein merge a.exr b.exr c.exr -o merged.exr --samples 16,16,64\n"
    "  stein merge node*.exr -o merged.exr --spread --quiet";

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorCode::kInvalidArgument, why); }

void check_arguments(const MergeOptions& options) {
  const auto& inputs = options.inputs;
  if (inputs.size() < 2) refuse("merge needs two files or more; " + inputs.front() + " is alone");
  if (options.samples.size() > 1 && options.samples.size() != inputs.size()) {
    refuse("--samples has " + std::to_string(options.samples.size()) + " numbers for " + std::to_string(inputs.size()) +
           " files; give one for all or one for each");
  }
  std::error_code error;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (std::filesystem::equivalent(inputs[i], options.output, error)) {
      refuse("-o " + options.output + " is one of the inputs: choose another file");
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (std::filesystem::equivalent(inputs[i], inputs[k], error)) {
        refuse(inputs[i] + " and " + inputs[k] + " are one file; merge renders with different seeds");
      }
    }
  }
  check_output_path(options.output);
}

exr::LoadedFrame read(const MergeOptions& options, std::size_t file) {
  const auto& samples = options.samples;
  const float given = samples.empty() ? 0 : samples[samples.size() == 1 ? 0 : file];
  exr::ReadOptions read{.samples_per_pixel = given, .require_variance = false};
  read.progress = [](double) { return !interrupted(); };
  apply(options.mapping, read);
  return exr::read_frame(options.inputs[file], read);
}

class Merger {
 public:
  explicit Merger(const MergeOptions& options) : options_(options), progress_(choose_progress_style(options.quiet)) {}

  void run() {
    progress_->show(0);
    const exr::LoadedFrame first = read(options_, 0);
    pooled_ = !options_.spread && has_all_variances(first.frame());
    const SampleLayout layout = sample_layout(first.frame(), pooled_);
    if (!layout.covariances && first.frame().colour_covariance[0]) {
      warnings_.push_back("not all features have covariances with the colour: all covariances are left out");
    }
    Accumulator film(first.frame().width, first.frame().height, layout);
    add(first, 0, film);
    for (std::size_t file = 1; file < options_.inputs.size(); ++file) {
      const exr::LoadedFrame next = read(options_, file);
      require_same_view(first, next, pooled_);
      add(next, file, film);
    }
    const Moments moments = film.moments();
    check_not_interrupted();
    exr::write_frame(options_.output, moments.frame(), first, [](double) { return !interrupted(); });
    progress_->show(1);
    progress_.reset();
    report(film, moments.frame());
  }

 private:
  void add(const exr::LoadedFrame& file, std::size_t index, Accumulator& film) {
    const auto files = static_cast<double>(options_.inputs.size());
    MergeInput input(file.frame(), film.layout(), pooled_);
    for (int y = 0; y < film.height(); ++y) {
      check_not_interrupted();
      input.add_row(y, film);
      progress_->show(kAccumulated * (static_cast<double>(index) + static_cast<double>(y) / film.height()) / files);
    }
    for (const auto& [digest, name] : digests_) {
      if (digest == input.digest()) {
        warnings_.push_back(options_.inputs[index] + " and " + name +
                            " hold the same image; if they have the same seed, the variances are too small");
      }
    }
    digests_.emplace_back(input.digest(), options_.inputs[index]);
  }

  void report(const Accumulator& film, const Frame& frame) {
    if (film.rejected() > 0) {
      warnings_.push_back(std::to_string(film.rejected()) +
                          " pixels of the files had no usable colour; the other files stand in for them" +
                          (empty_pixels(frame) > 0 ? ", but for " + std::to_string(empty_pixels(frame)) +
                                                         " pixels without any, whose sampleCount is 0"
                                                   : ""));
    }
    if (film.repaired() > 0) {
      warnings_.push_back(std::to_string(film.repaired()) +
                          " pixels of the files had an unusable feature; it counts as 0 there");
    }
    for (const std::string& warning : warnings_) std::fprintf(stderr, "stein: warning: %s\n", warning.c_str());
    if (options_.quiet) return;
    std::printf("%s: %zu files, %s\nvariances: %s\n", options_.output.c_str(), options_.inputs.size(),
                samples_text(frame).c_str(), pooled_ ? "pooled from those of the files" : "from how the files differ");
  }

  static std::int64_t empty_pixels(const Frame& frame) {
    std::int64_t empty = 0;
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) empty += frame.sample_count.at(x, y) > 0 ? 0 : 1;
    }
    return empty;
  }

  const MergeOptions& options_;
  std::optional<Progress> progress_;
  bool pooled_ = false;
  std::vector<std::pair<std::uint64_t, std::string>> digests_;
  std::vector<std::string> warnings_;
};

}  // namespace

Action add_merge(CLI::App& verb) {
  auto options = std::make_shared<MergeOptions>();
  verb.add_option("FILES", options->inputs, "OpenEXR files, two or more")->required();
  verb.add_option("-o,--output", options->output, "OpenEXR file to write; none of FILES")->required();
  verb.add_option("--samples", options->samples, "Samples per pixel, for files that do not say: one number or one each")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::PositiveNumber);
  declare(verb, options->mapping);
  verb.add_flag("--spread", options->spread,
                "Take variances from how the files differ, also where the files have some");
  verb.add_flag("--quiet", options->quiet, "No progress and no summary; warnings remain");
  verb.footer(kMergeFooter);
  return [options] {
    catch_interrupts();
    check_arguments(*options);
    Merger(*options).run();
  };
}

}  // namespace stein::cli
