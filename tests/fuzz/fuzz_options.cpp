// SPDX-License-Identifier: Apache-2.0
//
// Any words as options: a line with the name of a filter, then lines of NAME=VALUE. What is refused is refused by an
// Error; with what is accepted a small frame can be denoised, which the line "run" asks for (it takes most of the
// time).
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "arguments.hpp"
#include "input.hpp"
#include "look_at.hpp"
#include "parsing.hpp"
#include "stein/denoise.hpp"
#include "stein/error.hpp"
#include "stein/options.hpp"

namespace {

constexpr int kWidth = 5;
constexpr int kHeight = 4;

/// Calls what may end in an Error, and in nothing else.
template <class Call>
bool accepts(const Call& call) {
  try {
    call();
    return true;
  } catch (const stein::Error&) {
    return false;
  }
}

void set(stein::DenoiseParams& params, const std::string& line) {
  const std::size_t equals = std::min(line.find('='), line.size());
  const std::string name = line.substr(0, equals);
  const std::string value = line.substr(std::min(equals + 1, line.size()));
  const auto change = [&](const auto& typed) {
    stein::DenoiseParams changed = params;
    if (accepts([&] {
          set_option(changed, name, typed);
          check(changed);
        })) {
      params = changed;
    }
  };
  change(value);
  char* end = nullptr;
  const double number = std::strtod(value.c_str(), &end);
  if (end != value.c_str()) change(number);
}

/// The words that the command line takes apart itself.
void parse(const std::string& line) {
  accepts([&] { (void)stein::cli::parse_plane_map(line); });
  accepts([&] { (void)stein::cli::parse_feature_sigma(line); });
  accepts([&] { (void)stein::cli::parse_range(line); });
  accepts([&] { (void)stein::cli::parse_size("--tile", line); });
}

void run(stein::DenoiseParams& params) {
  constexpr int kLargestTile = 64;  // others take the time of an image of that size
  stein::Execution& execution = params.execution;
  execution.threads = 1;
  if (execution.tile_width > kLargestTile) execution.tile_width = 0;
  if (execution.tile_height > kLargestTile) execution.tile_height = 0;
  stein::Frame frame;
  frame.width = kWidth;
  frame.height = kHeight;
  stein::Plane plane(kWidth, kHeight);
  for (int i = 0; i < kWidth * kHeight; ++i) plane.row(i / kWidth)[i % kWidth] = 0.1F * static_cast<float>(i * 7 % 11);
  frame.colour = {plane.view(), plane.view(), plane.view()};
  frame.colour_variance = frame.colour;
  frame.uniform_sample_count = 4;
  frame.features.push_back({"albedo", {plane.view()}, {plane.view()}, {}});
  accepts([&] {
    const stein::DenoiseResult result = stein::denoise(frame, params);
    for (const stein::Plane& colour : result.colour) stein::fuzz::look_at(colour.view());
  });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  constexpr int kMostLines = 64;
  stein::fuzz::Lines lines(bytes, size);
  stein::DenoiseParams params;
  bool is_run = false;
  const std::string filter = lines.next();
  accepts([&] { params.filters = stein::make_filters(filter); });
  for (int i = 0; i < kMostLines && !lines.at_end(); ++i) {
    const std::string line = lines.next();
    is_run = is_run || line == "run";
    set(params, line);
    parse(line);
  }
  (void)candidate_names(params.filters);
  if (is_run) run(params);
  return 0;
}
