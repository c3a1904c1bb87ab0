// SPDX-License-Identifier: Apache-2.0
//
// stein: denoises renderings from the command line. One file per verb; this one finds the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "run_program.hpp"
#include "verbs.hpp"

namespace {

using stein::cli::Action;

struct Verb {
  const char* name;
  const char* summary;
  Action (*add)(CLI::App&);
};

constexpr Verb kVerbs[] = {
    {"denoise", "Denoise an image and write it with its estimated error", stein::cli::add_denoise},
    {"accumulate", "Turn a file of raw samples into one that can be denoised", stein::cli::add_accumulate},
    {"info", "Show what is understood of a file, and what it lacks", stein::cli::add_info},
    {"compare", "Measure an image against a reference", stein::cli::add_compare},
    {"sample-map", "Say how many further samples each pixel should get", stein::cli::add_sample_map},
    {"merge", "Make one image with variances out of several renders of a view", stein::cli::add_merge},
    {"perturb", "Make the files by which the error of another denoiser is told", stein::cli::add_perturb},
    {"preview", "Turn a layer of a file into a PNG picture", stein::cli::add_preview},
};

constexpr const char* kMainFooter =
    "Examples:\n"
    "  stein denoise noisy.exr -o clean.exr\n"
    "  stein accumulate samples.exr -o noisy.exr\n"
    "  stein info noisy.exr\n"
    "  stein compare clean.exr reference.exr\n"
    "  stein merge seed0.exr seed1.exr seed2.exr seed3.exr -o noisy.exr\n"
    "  stein preview clean.exr -o error.png --layer error\n"
    "\n"
    "'stein VERB --help' describes the options of a verb.\n"
    "\n"
    "Exit codes:\n"
    "   0  done\n"
    "   1  any other failure\n"
    "   2  bad arguments\n"
    "   3  the input cannot be used: planes are missing, invalid or unsupported\n"
    "   4  a file cannot be read or written\n"
    "   5  cancelled (Ctrl-C or SIGTERM); no output is left behind\n"
    "  75  full disk, too little memory, input/output error: another try may succeed";

Action declare(CLI::App& app) {
  app.set_version_flag("--version", "stein " STEIN_VERSION, "Print the version and exit");
  app.footer(kMainFooter);
  app.require_subcommand(1);
  auto action = std::make_shared<Action>();
  for (const Verb& verb : kVerbs) {
    CLI::App* parser = app.add_subcommand(verb.name, verb.summary);
    parser->callback([action, chosen = verb.add(*parser)] { *action = chosen; });
  }
  return [action] { (*action)(); };
}

}  // namespace

int main(int argc, char** argv) {
  return stein::cli::run_program("stein", "Denoises Monte Carlo renderings and says how large the remaining error is.",
                                 argc, argv, declare);
}
