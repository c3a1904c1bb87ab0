// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "accumulated_rows.hpp"
#include "cancel.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "stein/error.hpp"
#include "stein/exr_samples.hpp"
#include "verbs.hpp"

namespace stein::cli {
namespace {

struct AccumulateOptions {
  std::string input;
  std::string output;
  std::vector<std::string> leave_out;
  bool no_covariances = false;
  bool quiet = false;
};

constexpr const char* kAccumulateFooter =
    "The input is a deep scanline OpenEXR file with one deep sample per Monte Carlo sample: R, G, B and the features\n"
    "of each, such as albedo.R or normal.X. The output holds, per pixel, their means, the variances and covariances "
    "of\n"
    "the means, and sampleCount. random.* channels say how a sample was drawn: they are left out. A sample whose "
    "colour\n"
    "is not finite is rejected; a feature that is not finite counts as 0. Both are counted.\n"
    "\n"
    "Rows are read one after the other: the file may be larger than memory.\n"
    "\n"
    "Examples:\n"
    "  stein accumulate samples.exr -o noisy.exr\n"
    "  stein accumulate samples.exr -o noisy.exr --leave-out position2,normal2";

void write_planes(const std::string& path, exr::SampleReader& samples, AccumulatedRows& rows, Progress& progress) {
  std::optional<exr::PlanesWriter> writer;
  while (rows.next()) {
    const std::vector<NamedView> planes = rows.planes();
    if (!writer) {
      std::vector<std::string> names;
      for (const NamedView& plane : planes) {
        names.push_back(plane.first);
      }
      writer.emplace(path, samples, std::move(names));
    }
    writer->write_rows(planes);
    progress.show(static_cast<double>(rows.rows_done()) / samples.height());
  }
  if (rows.counts().total == 0) {
    throw Error(ErrorCode::kInvalidFrame, "'" + samples.path() + "': it holds no sample with a finite colour");
  }
  check_not_interrupted();
  writer->finish();
}

void warn_of_counts(const SampleCounts& counts) {
  const auto warn = [](std::int64_t count, const char* what) {
    if (count > 0) {
      std::fprintf(stderr, "stein: warning: %lld %s\n", static_cast<long long>(count), what);
    }
  };
  warn(counts.rejected, "samples rejected: their colour is not finite");
  warn(counts.repaired, "samples with a feature that is not finite: it counts as 0");
  warn(counts.single_pixels, "pixels with one sample: nothing is known of their variance, which is written as 0");
}

void print_summary(const AccumulateOptions& options, const exr::SampleReader& samples, const SamplePlan& plan,
                   const SampleCounts& counts) {
  std::printf("%-9s %s, %dx%d\n", "input", options.input.c_str(), samples.width(), samples.height());
  std::printf("%-9s %lld, %u to %u per pixel\n", "samples", static_cast<long long>(counts.total), counts.fewest,
              counts.most);
  std::printf("%-9s %lld samples\n", "rejected", static_cast<long long>(counts.rejected));
  std::printf("%-9s %lld pixels\n", "empty", static_cast<long long>(counts.empty_pixels));
  for (const FeatureLayout& feature : plan.layout.features) {
    std::printf("%-9s %s (%d channel%s)\n", "feature", feature.name.c_str(), feature.channels,
                feature.channels == 1 ? "" : "s");
  }
  for (const std::string& name : plan.left_out) {
    std::printf("%-9s %s\n", "left out", name.c_str());
  }
  std::printf("%-9s %s\n", "output", options.output.c_str());
}

void accumulate(const AccumulateOptions& options) {
  catch_interrupts();
  check_output_path(options.output, options.input);
  std::optional<Progress> progress(choose_progress_style(options.quiet));
  progress->show(0);
  exr::SampleReader samples(options.input);
  const SamplePlan plan = plan_samples(samples, options.leave_out, !options.no_covariances);
  AccumulatedRows rows(samples, plan);
  write_planes(options.output, samples, rows, *progress);
  progress.reset();
  warn_of_counts(rows.counts());
  if (!options.quiet) {
    print_summary(options, samples, plan, rows.counts());
  }
}

}  // namespace

Action add_accumulate(CLI::App& verb) {
  auto options = std::make_shared<AccumulateOptions>();
  verb.add_option("DUMP", options->input, "Deep OpenEXR file of raw samples")->required();
  verb.add_option("-o,--output", options->output, "File of planes to write")->required();
  verb.add_option("--leave-out", options->leave_out, "NAME[,NAME...]: features that are not to be in the output")
      ->delimiter(',')
      ->allow_extra_args(false);
  verb.add_flag("--no-covariances", options->no_covariances,
                "Variances only: a smaller file, but the error estimate of a denoised image is then too low");
  verb.add_flag("--quiet", options->quiet, "No progress and no summary; warnings remain");
  verb.footer(kAccumulateFooter);
  return [options] { accumulate(*options); };
}

}  // namespace stein::cli
