// SPDX-License-Identifier: Apache-2.0
#include "denoise_samples.hpp"

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "cancel.hpp"
#include "denoise_report.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "stein/error.hpp"
#include "stein/exr_samples.hpp"
#include "stein/rpf.hpp"

namespace stein::cli {
namespace {

using Names = std::vector<std::string>;

const Names kForSamples = {"--rpf-preset", "--adjacent", "--features", "--randoms"};
const Names kForBoth = {"IN",      "--output", "--filter", "--risk",          "--draws",      "--seed",   "--threads",
                        "--quiet", "--frames", "--frame",  "--skip-existing", "--max-memory", "--scratch"};

bool contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The rows of a result, as they come, to a file.
class ResultFile {
 public:
  ResultFile(const std::string& path, const exr::SampleReader& samples, bool has_error)
      : writer_(path, samples,
                has_error ? Names{"R", "G", "B", "error.R", "error.G", "error.B"} : Names{"R", "G", "B"}),
        has_error_(has_error) {}

  void write(const RpfBand& band) {
    constexpr std::array<const char*, 3> kColours = {"R", "G", "B"};
    std::vector<std::pair<std::string, ConstPlaneView>> planes;
    for (std::size_t c = 0; c < 3; ++c) planes.emplace_back(kColours[c], band.colour[c]);
    for (std::size_t c = 0; has_error_ && c < 3; ++c) {
      planes.emplace_back(std::string("error.") + kColours[c], band.error[c]);
    }
    writer_.write_rows(planes);
  }

  void finish() { writer_.finish(); }

 private:
  exr::PlanesWriter writer_;
  bool has_error_;
};

void print_names(const char* what, const Names& names) {
  for (const std::string& name : names) std::printf("%-9s %s\n", what, name.c_str());
}

void print_report(const DenoiseOptions& options, const exr::SampleReader& samples, const RpfReport& report,
                  bool has_error) {
  std::printf("%-9s %s, %dx%d\n", "input", options.input.c_str(), samples.width(), samples.height());
  std::printf("%-9s %lld, %lld rejected\n", "samples", static_cast<long long>(report.samples),
              static_cast<long long>(report.rejected));
  print_names("feature", report.features);
  print_names("random", report.randoms);
  if (has_error) {
    const auto& e = report.mean_error;
    std::printf("%-9s %.6g (mean square, estimated)\n", "error", (e[0] + e[1] + e[2]) / 3);
  }
  print_memory(report.scratch_bytes);
  std::printf("%-9s %s\n", "output", options.output.c_str());
}

void print_warnings(const RpfReport& report) {
  const auto warn = [](long long count, const char* what) {
    if (count > 0) std::fprintf(stderr, "stein: warning: %lld %s\n", count, what);
  };
  warn(report.rejected, "samples rejected: their colour is not finite");
  warn(report.repaired, "samples with a feature or random parameter that is not finite: it counts as 0");
  warn(report.empty_pixels, "pixels without samples: they get the mean of the nearest ones");
  for (const std::string& warning : report.warnings) std::fprintf(stderr, "stein: warning: %s\n", warning.c_str());
}

exr::SampleReader open_samples(const std::string& path) {
  try {
    return exr::SampleReader(path);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kIo) throw;
    throw Error(error.code(), std::string("--filter rpf reads raw samples: ") + error.what());
  }
}

}  // namespace

void declare(CLI::App& verb, SampleFilterOptions& options) {
  CLI::Option* filter = verb.get_option("--filter");
  filter->description(filter->get_description() + "; of raw samples: rpf");
  verb.add_option("--rpf-preset", options.preset,
                  "Of rpf: what measured best, or the paper's two settings, for clean and for noisy scenes")
      ->check(CLI::IsMember({"default", "paper-detail", "paper-noisy"}));
  verb.add_option("--adjacent", options.adjacent, "For rpf: samples of the frame before or after; may be repeated")
      ->allow_extra_args(false);
  verb.add_option("--features", options.features, "NAME[,NAME...]: the features that rpf uses; all unless given")
      ->delimiter(',')
      ->allow_extra_args(false);
  verb.add_option("--randoms", options.randoms,
                  "NAME[,NAME...]: the random parameters that rpf uses, such as random.lens; all unless given")
      ->delimiter(',')
      ->allow_extra_args(false);
}

bool reads_samples(const CLI::App& verb, const DenoiseOptions& options) {
  const bool is_rpf = options.filter.name == RpfParams::kName;
  for (const CLI::Option* option : verb.get_options()) {
    const Names& long_names = option->get_lnames();
    const std::string text = long_names.empty() ? option->get_name(true) : "--" + long_names.front();
    const bool is_for_rpf = contains(kForSamples, text);
    if (option->count() == 0 || (!is_rpf && !is_for_rpf)) continue;
    if (is_rpf && (is_for_rpf || contains(kForBoth, text))) continue;
    throw Error(ErrorCode::kInvalidArgument, text + (is_rpf ? ": the filter 'rpf' has no such parameter or result"
                                                            : ": only the filter 'rpf' has this parameter"));
  }
  return is_rpf;
}

RpfParams rpf_params(const DenoiseOptions& options, const SampleFilterOptions& filter) {
  RpfParams params;
  if (filter.preset == "paper-detail") params = paper_rpf(kRpfDetail);
  if (filter.preset == "paper-noisy") params = paper_rpf(kRpfNoisy);
  if (options.risk != "auto" && options.risk != "monte-carlo") {
    throw Error(ErrorCode::kInvalidArgument, "--risk " + options.risk +
                                                 ": the filter 'rpf' has no derivative; its error can be estimated "
                                                 "with monte-carlo");
  }
  params.draws = options.risk == "monte-carlo" ? options.draws : 0;
  params.seed = options.seed;
  params.features = filter.features;
  params.randoms = filter.randoms;
  params.check();
  static_cast<void>(make_memory(options));  // a mistake is told once, before any frame
  return params;
}

void denoise_samples(const FrameTask& task, const RpfParams& params, const std::vector<std::string>& adjacent_paths) {
  const DenoiseOptions& options = task.options;
  check_output_path(options.output, options.input);
  for (const std::string& path : adjacent_paths) check_output_path(options.output, path);
  exr::SampleReader samples = open_samples(options.input);
  std::vector<std::unique_ptr<exr::SampleReader>> readers;
  std::vector<SampleSource> adjacent;
  for (const std::string& path : adjacent_paths) {
    readers.push_back(std::make_unique<exr::SampleReader>(open_samples(path)));
    adjacent.push_back(exr::sample_source(*readers.back()));
  }
  const SampleSource source = exr::sample_source(samples);
  task.progress.show(0);
  Execution execution;
  execution.threads = options.threads;
  execution.memory = make_memory(options);
  execution.progress = [&task](double fraction) {
    task.progress.show(fraction);
    return !interrupted();
  };
  const bool has_error = params.draws > 0;
  ResultFile result(options.output, samples, has_error);
  RpfReport report = filter_samples(
      source, params, execution, [&result](const RpfBand& band) { result.write(band); }, adjacent);
  check_not_interrupted();
  if (report.samples == 0) {
    throw Error(ErrorCode::kInvalidFrame, "'" + samples.path() + "': it holds no sample with a finite colour");
  }
  result.finish();
  if (execution.memory) warn_if_exceeded(*execution.memory, report.warnings);
  task.progress.clear();
  print_warnings(report);
  if (!options.quiet) print_report(options, samples, report, has_error);
}

}  // namespace stein::cli
