// SPDX-License-Identifier: Apache-2.0
//
// pathtracer: renders the scenes that it knows into files that stein reads.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
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
      "\n"
      "Exit codes:\n"
      "  0  done\n"
      "  1  any other failure\n"
      "  2  bad arguments\n"
      "  4  a file cannot be written\n"
      "  5  cancelled (Ctrl-C or SIGTERM); no output is left behind";
  return text;
}

void declare_options(CLI::App& app, Options& options) {
  app.add_option("--scene", options.scene, "Name of the scene, see below")->required();
  app.add_option("--size", options.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  app.add_option("--samples", options.samples, "Samples per pixel")
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
  app.add_flag("--quiet", options.quiet, "No progress and no summary");
  app.footer(footer());
}

void check_paths(const Options& options) {
  stein::cli::check_output_path(options.output);
  if (options.dump.empty()) return;
  stein::cli::check_output_path(options.dump);
  std::error_code error;
  const bool is_same = std::filesystem::weakly_canonical(options.output, error) ==
                       std::filesystem::weakly_canonical(options.dump, error);
  if (is_same) {
    throw stein::Error(stein::ErrorCode::kInvalidArgument, "--dump and -o are the same file: choose another");
  }
}

void render(const Options& options, Renderer& renderer, stein::Accumulator& film, const stein::Execution& execution) {
  const auto pixels = static_cast<std::size_t>(renderer.width()) * static_cast<std::size_t>(renderer.height());
  const std::vector<std::uint32_t> counts(pixels, options.samples);
  if (options.dump.empty()) {
    renderer.render(counts.data(), film, execution);
    return;
  }
  stein::exr::SampleWriter dump(options.dump, renderer.width(), renderer.height(), sample_channels());
  renderer.render(counts.data(), film, execution,
                  [&](const std::uint32_t* row, const float* samples) { dump.write_row(row, samples); });
  stein::cli::check_not_interrupted();
  dump.finish();
}

void run(const Options& options) {
  stein::cli::catch_interrupts();
  const auto start = std::chrono::steady_clock::now();
  const auto [width, height] = stein::cli::parse_size("--size", options.size);
  const Scene scene = make_scene(options.scene);
  check_paths(options);
  Renderer renderer(scene, width, height, options.seed);
  stein::SampleLayout layout;
  layout.covariances = !options.reference;
  if (!options.reference) layout.features = feature_layout();
  stein::Accumulator film(width, height, layout);

  std::optional<stein::cli::Progress> progress(stein::cli::choose_progress_style(options.quiet));
  stein::Execution execution;
  execution.threads = options.threads;
  execution.progress = [&progress](double fraction) {
    progress->show(fraction);
    return !stein::cli::interrupted();
  };
  progress->show(0);
  render(options, renderer, film, execution);
  stein::cli::check_not_interrupted();
  stein::exr::write_planes(options.output, stein::named_planes(film.moments().frame()));
  progress.reset();
  if (!options.quiet) {
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("%s, %dx%d, %u samples per pixel, seed %llu: %.1f s\n", options.scene.c_str(), width, height,
                options.samples, static_cast<unsigned long long>(options.seed), seconds.count());
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
