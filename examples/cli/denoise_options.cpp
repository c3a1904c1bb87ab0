// SPDX-License-Identifier: Apache-2.0
#include "denoise_options.hpp"

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <array>
#include <utility>

#include "arguments.hpp"
#include "parsing.hpp"
#include "stein/options.hpp"

namespace stein::cli {
namespace {

constexpr const char* kDenoiseFooter =
    "OUT holds the denoised colour, error.R/G/B (the squared error that is estimated to remain), choice.V (the filter\n"
    "chosen) and density.V (where samples would help most), next to everything of IN that does not describe its "
    "noise.\n"
    "\n"
    "Examples:\n"
    "  stein denoise noisy.exr -o clean.exr\n"
    "  stein denoise noisy.exr -o clean.exr --samples 16 --json report.json --quiet\n"
    "  stein denoise noisy.exr -o clean.exr --filter gaussian --risk monte-carlo\n"
    "  stein denoise noisy.exr -o clean.exr --map albedo=Diffuse.R,G,B --variance-of sample --samples 16\n"
    "  stein denoise noisy.exr -o clean.exr --feature-sigma normal=0.4,albedo=0.1\n"
    "  stein denoise noisy.exr -o clean.exr --layers diffuse,specular,A\n"
    "  stein denoise noisy.exr -o clean.exr --candidate oidn.exr --candidate-perturbed oidn_perturbed.exr\n"
    "  stein denoise noisy.####.exr -o clean.####.exr --frames 1-100,200-300:2 --skip-existing\n"
    "\n"
    "The filter rpf reads a file of raw samples (deep, as for stein accumulate) and writes the colour, and its error "
    "with\n"
    "--risk monte-carlo:\n"
    "  stein denoise samples.exr -o clean.exr --filter rpf";

void declare_memory(CLI::App& verb, DenoiseOptions& options) {
  CLI::Option* limit = verb.add_option(
      "--max-memory", options.max_memory,
      "Most memory to take, such as 2G or 512M; images that exceed it lie in scratch files. Never changes the result");
  verb.add_option("--scratch", options.scratch,
                  "Folder of the scratch files, on a disk; $TMPDIR, or /var/tmp, unless given")
      ->needs(limit);
}

void declare_output(CLI::App& verb, DenoiseOptions& options) {
  verb.add_flag_callback(
      "--no-error", [&options] { options.write.error = false; }, "Do not write error.R/G/B");
  verb.add_flag_callback(
      "--no-choice", [&options] { options.write.choice = false; }, "Do not write choice.V");
  verb.add_flag_callback(
      "--no-density", [&options] { options.write.density = false; }, "Do not write density.V");
  verb.add_flag("--keep-noisy", options.write.noisy, "Keep the input's colour as noisy.R/G/B");
  verb.add_flag("--keep-inputs", options.write.inputs, "Keep variances, covariances and the sample count");
  verb.add_flag("--half", options.write.half_colour, "Write the colour as half");
  verb.add_option("--json", options.json, "Write a report as JSON to this file");
}

}  // namespace

void declare(CLI::App& verb, DenoiseOptions& options) {
  declare_method(verb, options);
  verb.add_option(
          "--layers", options.layers,
          "Layers to filter as the colour is, by name (key for key.R, key.G, key.B; or one channel, such as A); "
          "all: every layer of R, G and B that is nothing else, and alpha")
      ->delimiter(',');
  verb.add_flag("--straight-alpha", options.straight_alpha,
                "The colour and its layers are divided by alpha, and are to be so in OUT; alpha is filtered as well");
  declare(verb, options.candidates);
  verb.add_option("--strength", options.strength, "1: the reconstruction, 0: the input, between: a mix")
      ->capture_default_str();
  declare_memory(verb, options);
  declare_output(verb, options);
  verb.footer(kDenoiseFooter);
}

void declare_method(CLI::App& verb, DenoiseOptions& options) {
  verb.add_option("IN", options.input, "OpenEXR file with the noisy image and its variances")->required();
  verb.add_option("-o,--output", options.output, "OpenEXR file to write; not IN itself")->required();
  declare(verb, options.filter);
  declare(verb, options.samples);
  declare(verb, options.mapping);
  verb.add_option("--risk", options.risk,
                  "How errors are estimated: sure and joint in closed form (joint: with the file's covariances), "
                  "monte-carlo by runs on perturbed input; auto: the best that filter and file allow")
      ->check(CLI::IsMember({"auto", "sure", "joint", "monte-carlo"}))
      ->capture_default_str();
  verb.add_option("--draws", options.draws, "Runs on perturbed input, for the Monte Carlo risk")->capture_default_str();
  verb.add_option("--seed", options.seed, "Of the perturbations")->capture_default_str();
  verb.add_option("--selection", options.selection,
                  "How candidates are chosen: by local evidence against that of the whole image, or the least "
                  "local risk")
      ->check(CLI::IsMember({"evidence", "argmin"}))
      ->capture_default_str();
  verb.add_flag_callback(
      "--no-outliers", [&options] { options.outliers = false; }, "Leave fireflies as they are");
  verb.add_flag("--strict", options.strict, "Fail on unusable values instead of repairing them");
  verb.add_option("--threads", options.threads, "Most threads to use; 0: all that affinity mask and CPU quota allow")
      ->capture_default_str();
  verb.add_option("--tile", options.tile, "WIDTHxHEIGHT of a unit of work; never changes the result");
  verb.add_flag("--quiet", options.quiet, "No progress and no summary; warnings remain");
}

std::shared_ptr<Memory> make_memory(const DenoiseOptions& options) {
  if (options.max_memory.empty()) return nullptr;
  return std::make_shared<Memory>(MemoryLimit{parse_bytes("--max-memory", options.max_memory), options.scratch});
}

DenoiseParams denoise_params(const DenoiseOptions& options) {
  DenoiseParams params;
  apply(options.filter, params);
  set_option(params, "risk", options.risk);
  set_option(params, "selection", options.selection);
  params.monte_carlo.draws = options.draws;
  params.monte_carlo.seed = options.seed;
  params.strength = options.strength;
  params.strict = options.strict;
  params.outliers.enabled = options.outliers;
  params.execution.threads = options.threads;
  if (!options.tile.empty()) {
    const std::array<int, 2> tile = parse_size("--tile", options.tile);
    params.execution.tile_width = tile[0];
    params.execution.tile_height = tile[1];
  }
  params.execution.memory = make_memory(options);
  check(params);
  return params;
}

exr::LoadedFrame read_input(const DenoiseOptions& options, std::shared_ptr<Memory> memory,
                            const std::function<bool(double)>& progress) {
  const bool needs_covariances = options.risk != "sure";
  exr::ReadOptions read{.read_covariances = needs_covariances};
  read.layers = options.layers;
  read.straight_alpha = options.straight_alpha;
  read.memory = std::move(memory);
  read.progress = progress;
  apply(options.samples, read);
  apply(options.mapping, read);
  exr::LoadedFrame input = exr::read_frame(options.input, read);
  for (const std::string& text : options.filter.feature_sigmas) {
    require_feature(input.frame(), parse_feature_sigma(text).name);
  }
  return input;
}

}  // namespace stein::cli
