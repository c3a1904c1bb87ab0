// SPDX-License-Identifier: Apache-2.0
//
// pathtracer: renders the scenes that it knows into files that stein reads.
#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "cancel.hpp"
#include "output_file.hpp"
#include "parsing.hpp"
#include "progress.hpp"
#include "renderer.hpp"
#include "run_program.hpp"
#include "stein/accumulate.hpp"
#include "stein/adaptive.hpp"
#include "stein/error.hpp"
#include "stein/exr.hpp"
#include "stein/exr_samples.hpp"
#include "stein/frame.hpp"

namespace pathtracer {
namespace {

struct Options {
  std::string scene;
  std::string size = "512x384";
  std::uint32_t samples = 8;
  std::uint64_t seed = 1;
  int threads = 0;
  std::string output;
  std::string dump;
  std::string counts;
  std::string denoised;
  int iterations = 0;  // 0: no adaptive sampling
  double target_error = 0;
  bool reference = false;
  bool quiet = false;
};

std::string footer() {
  std::string text = "Scenes:\n";
  for (const SceneEntry& entry : all_scenes()) {
    const std::string name = entry.name;
    text += "  " + name + std::string(17 - name.size(), ' ') + entry.summary + "\n";
  }
  text +=
      "\n"
      "The output has per pixel the mean colour and features (albedo, normal, depth, position, visibility), the\n"
      "variances and covariances of these means, and sampleCount. Equal seeds give equal files, with any number of\n"
      "threads; use different seeds for images whose noise must be independent.\n"
      "\n"
      "Examples:\n"
      "  pathtracer --scene cornell -o noisy.exr\n"
      "  pathtracer --scene cornell --samples 4096 --seed 2 --reference -o reference.exr\n"
      "  pathtracer --scene motion --samples 16 -o noisy.exr --dump samples.exr\n"
      "  pathtracer --scene motion --samples 16 --adaptive -o noisy.exr --denoised clean.exr\n"
      "  pathtracer --scene motion --counts counts.exr --seed 2 -o batch2.exr\n"
      "\n"
      "Exit codes:\n"
      "   0  done\n"
      "   1  any other failure\n"
      "   2  bad arguments\n"
      "   4  a file cannot be written\n"
      "   5  cancelled (Ctrl-C or SIGTERM); no output is left behind\n"
      "  75  full disk, too little memory, input/output error: another try may succeed";
  return text;
}

void declare_options(CLI::App& app, Options& options) {
  app.add_option("--scene", options.scene, "Name of the scene, see below")->required();
  app.add_option("--size", options.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  CLI::Option* samples = app.add_option("--samples", options.samples, "Samples per pixel, or their mean")
                             ->check(CLI::Range(1, 1 << 20))
                             ->capture_default_str();
  app.add_option("--seed", options.seed, "Start of the random numbers")->capture_default_str();
  app.add_option("--threads", options.threads, "Threads to use; 0: one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("-o,--output", options.output, "OpenEXR file of planes to write")->required();
  CLI::Option* dump = app.add_option(
      "--dump", options.dump, "Also write every sample, with its random parameters and second hit, to this deep file");
  app.add_flag("--reference", options.reference, "Colour, its variance and sampleCount only")->excludes(dump);
  app.add_option(
         "--counts", options.counts,
         "Take the samples of each pixel, and the size, from samples.V of this file, as stein sample-map writes")
      ->excludes(samples)
      ->excludes("--size");
  CLI::Option* adaptive = app.add_flag_callback(
      "--adaptive", [&options] { options.iterations = options.iterations == 0 ? 3 : options.iterations; },
      "Four samples per pixel first, the others where they lower the error most");
  adaptive->excludes(dump)->excludes("--reference")->excludes("--counts");
  app.add_option("--iterations", options.iterations, "Batches after the first, 3 unless given")
      ->check(CLI::Range(1, 1000))
      ->needs(adaptive);
  app.add_option("--target-error", options.target_error,
                 "Stop when the estimated mean relative error is at most this, also if samples are left")
      ->check(CLI::PositiveNumber)
      ->needs(adaptive);
  app.add_option("--denoised", options.denoised,
                 "Also write the denoised image, with its error and density, to this file")
      ->needs(adaptive);
  app.add_flag("--quiet", options.quiet, "No progress and no summary");
  app.footer(footer());
}

[[noreturn]] void fail_arguments(const std::string& why) {
  throw stein::Error(stein::ErrorCode::kInvalidArgument, why);
}

void check_apart(const Options& options, const std::string& option, const std::string& path) {
  std::error_code error;
  const bool is_same =
      std::filesystem::weakly_canonical(options.output, error) == std::filesystem::weakly_canonical(path, error);
  if (!path.empty() && is_same) fail_arguments(option + " and -o are the same file: choose another");
}

void check_paths(const Options& options) {
  check_apart(options, "--dump", options.dump);
  check_apart(options, "--denoised", options.denoised);
  check_apart(options, "--counts", options.counts);
  for (const std::string& path : {options.output, options.dump, options.denoised}) {
    if (!path.empty()) stein::cli::check_output_path(path);
  }
}

// Samples of every pixel, row by row.
struct Counts {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> samples;
};

Counts read_counts(const std::string& path) {
  const stein::exr::NamedPlanes file = stein::exr::read_planes(path, {"samples.V"});
  const stein::Plane& plane = file.planes.front();
  Counts counts{plane.width(), plane.height(), {}};
  constexpr float kMost = 1 << 20;
  for (int y = 0; y < counts.height; ++y) {
    for (int x = 0; x < counts.width; ++x) {
      const float value = plane.row(y)[x];
      if (!(value >= 0 && value <= kMost)) {
        throw stein::Error(stein::ErrorCode::kInvalidFrame, "'" + path + "': samples.V is " + std::to_string(value) +
                                                                " at pixel (" + std::to_string(x) + ", " +
                                                                std::to_string(y) + "), must be in [0.." +
                                                                std::to_string(static_cast<int>(kMost)) + "]");
      }
      counts.samples.push_back(static_cast<std::uint32_t>(value));
    }
  }
  return counts;
}

Counts counts_of(const Options& options) {
  if (!options.counts.empty()) return read_counts(options.counts);
  const auto [width, height] = stein::cli::parse_size("--size", options.size);
  constexpr int kMaxSide = 1 << 16;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    fail_arguments("--size: each side must be 1 to " + std::to_string(kMaxSide));
  }
  if (options.iterations > 0 && options.samples < stein::AdaptiveParams{}.initial_samples) {
    fail_arguments("--adaptive starts with " + std::to_string(stein::AdaptiveParams{}.initial_samples) +
                   " samples per pixel: raise --samples");
  }
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  return {width, height, std::vector<std::uint32_t>(pixels, options.samples)};
}

void write_denoised(const std::string& path, const stein::DenoiseResult& result) {
  std::vector<std::pair<std::string, stein::ConstPlaneView>> planes = {{"choice.V", result.choice.view()},
                                                                       {"density.V", result.density.view()}};
  constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    planes.emplace_back(kRgb[c], result.colour[c].view());
    planes.emplace_back(std::string("error.") + kRgb[c], result.error[c].view());
  }
  stein::exr::write_planes(path, planes);
}

// The loop of docs/adaptive.md: stein says where samples pay, the renderer takes them.
stein::DenoiseResult render_adaptively(const Options& options, Renderer& renderer, stein::Accumulator& film,
                                       const stein::Execution& execution) {
  stein::AdaptiveParams params;
  params.budget = std::int64_t{renderer.width()} * renderer.height() * options.samples;
  params.iterations = options.iterations;
  params.target_error = options.target_error;
  params.denoise.execution.threads = options.threads;
  params.denoise.execution.progress = [](double) { return !stein::cli::interrupted(); };
  double done = 0;
  stein::Execution batch = execution;
  std::optional<stein::Moments> moments;  // what the loop looks at until the next batch
  const auto more = [&](const std::vector<std::uint32_t>& counts) {
    const double share = std::accumulate(counts.begin(), counts.end(), 0.0) / static_cast<double>(params.budget);
    batch.progress = [&](double fraction) { return execution.progress(done + share * fraction); };
    renderer.render(counts.data(), film, batch);
    done += share;
    return moments.emplace(film.moments()).frame();
  };
  return stein::denoise_adaptively(renderer.width(), renderer.height(), more, params).result;
}

// The planes, then what goes with them: on failure neither stays.
template <class WriteSecond>
void write_both(const std::string& path, const stein::Accumulator& film, const WriteSecond& write_second) {
  stein::cli::check_not_interrupted();
  const stein::Moments moments = film.moments();
  stein::exr::write_planes(path, stein::named_planes(moments.frame()));
  try {
    stein::cli::check_not_interrupted();
    write_second();
  } catch (...) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
    throw;
  }
}

void render_and_write(const Options& options, const Counts& counts, Renderer& renderer, stein::Accumulator& film,
                      const stein::Execution& execution) {
  if (options.iterations > 0) {
    const stein::DenoiseResult result = render_adaptively(options, renderer, film, execution);
    write_both(options.output, film, [&] {
      if (!options.denoised.empty()) write_denoised(options.denoised, result);
    });
  } else if (!options.dump.empty()) {
    stein::exr::SampleWriter dump(options.dump, renderer.width(), renderer.height(), sample_channels());
    renderer.render(counts.samples.data(), film, execution,
                    [&](const std::uint32_t* row, const float* samples) { dump.write_row(row, samples); });
    write_both(options.output, film, [&] { dump.finish(); });
  } else {
    renderer.render(counts.samples.data(), film, execution);
    write_both(options.output, film, [] {});
  }
}

// Samples per pixel on average.
double mean_samples(const stein::Accumulator& film) {
  const stein::Moments moments = film.moments();
  double sum = 0;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) sum += moments.frame().sample_count.at(x, y);
  }
  return sum / (static_cast<double>(film.width()) * film.height());
}

void run(const Options& options) {
  stein::cli::catch_interrupts();
  const auto start = std::chrono::steady_clock::now();
  check_paths(options);
  const Counts counts = counts_of(options);
  const Scene scene = make_scene(options.scene);
  Renderer renderer(scene, counts.width, counts.height, options.seed);
  stein::SampleLayout layout;
  layout.covariances = !options.reference;
  if (!options.reference) layout.features = feature_layout();
  stein::Accumulator film(counts.width, counts.height, layout);

  std::optional<stein::cli::Progress> progress(stein::cli::choose_progress_style(options.quiet));
  stein::Execution execution;
  execution.threads = options.threads;
  execution.progress = [&progress](double fraction) {
    progress->show(fraction);
    return !stein::cli::interrupted();
  };
  progress->show(0);
  render_and_write(options, counts, renderer, film, execution);
  progress.reset();
  if (!options.quiet) {
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("%s, %dx%d, %.4g samples per pixel%s, seed %llu: %.1f s\n", options.scene.c_str(), counts.width,
                counts.height, mean_samples(film), options.iterations > 0 ? " on average" : "",
                static_cast<unsigned long long>(options.seed), seconds.count());
  }
}

stein::cli::Action declare(CLI::App& app) {
  auto options = std::make_shared<Options>();
  declare_options(app, *options);
  return [options] { run(*options); };
}

}  // namespace
}  // namespace pathtracer

int main(int argc, char** argv) {
  return stein::cli::run_program("pathtracer",
                                 "Renders test scenes with few samples per pixel, and all that stein can make use of.",
                                 argc, argv, pathtracer::declare);
}
