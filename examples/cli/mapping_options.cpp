// SPDX-License-Identifier: Apache-2.0
#include "mapping_options.hpp"

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <cmath>

#include "arguments.hpp"
#include "parsing.hpp"

namespace stein::cli {

void declare(CLI::App& verb, MappingOptions& options) {
  verb.add_option("--preset", options.preset,
                  "Whose names the channels bear: native, arnold, cycles, mitsuba, pbrt, renderman, tungsten (found by "
                  "the names if left out)");
  verb.add_option("--map", options.maps,
                  "PLANE=CHANNELS[:var=CHANNELS]: what a plane is made of, whatever the preset says. PLANE is colour, "
                  "samples or a feature; may be given several times")
      ->allow_extra_args(false);
  verb.add_option("--variance-of", options.variance_of,
                  "What all variances of the file are: of the mean, of single samples (sample), or means of squares "
                  "(m2)")
      ->check(CLI::IsMember({"mean", "sample", "m2"}));
  verb.add_option("--view", options.view, "Of a file of several views (stereo): the one to look at, such as right");
}

void declare(CLI::App& verb, SamplesOption& option) {
  verb.add_option("--samples", option.text,
                  "Samples per pixel, for files that do not say: a number, or the channel that holds them");
}

void apply(const SamplesOption& option, exr::ReadOptions& read) {
  if (option.text.empty()) return;
  float number = 0;
  if (!parse_number(option.text, number)) {
    read.maps.push_back({"samples", {option.text}, {}});
  } else if (number > 0 && std::isfinite(number)) {
    read.samples_per_pixel = number;
  } else {
    fail_argument("--samples", option.text, "a number above 0, or the name of a channel");
  }
}

void apply(const MappingOptions& options, exr::ReadOptions& read) {
  read.preset = options.preset;
  read.view = options.view;
  for (const std::string& text : options.maps) read.maps.push_back(parse_plane_map(text));
  if (options.variance_of == "mean") read.variance_of = exr::VarianceOf::kMean;
  if (options.variance_of == "sample") read.variance_of = exr::VarianceOf::kSample;
  if (options.variance_of == "m2") read.variance_of = exr::VarianceOf::kSecondMoment;
}

}  // namespace stein::cli
