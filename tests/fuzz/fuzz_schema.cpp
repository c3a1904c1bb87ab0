// SPDX-License-Identifier: Apache-2.0
//
// Any words as the names of a file's channels, presets and maps. Lines: the preset; a letter of what the variances are,
// and "+" for a file beside it; then maps (which begin with "=") and channels. Reading may only end in an Error.
#include <unistd.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "input.hpp"
#include "look_at.hpp"
#include "stein/error.hpp"
#include "stein/exr.hpp"

namespace {

using stein::exr::VarianceOf;

constexpr int kWidth = 3;
constexpr int kHeight = 2;

struct Words {
  stein::exr::ReadOptions options{.layers = {"all"}, .require_variance = false};
  bool has_companion = false;
  std::vector<std::pair<std::string, stein::ConstPlaneView>> planes;
};

VarianceOf variance_of(const std::string& line) {
  switch (line.empty() ? ' ' : line[0]) {
    case 'm':
      return VarianceOf::kMean;
    case 's':
      return VarianceOf::kSample;
    case '2':
      return VarianceOf::kSecondMoment;
    default:
      return VarianceOf::kAsStated;
  }
}

Words read_words(stein::fuzz::Lines lines, const stein::ConstPlaneView& plane) {
  constexpr int kMostLines = 48;
  Words words;
  words.options.preset = lines.next();
  const std::string kinds = lines.next();
  words.options.variance_of = variance_of(kinds);
  words.options.samples_per_pixel = kinds.find('n') == std::string::npos ? 0.0F : 4.0F;
  words.has_companion = kinds.find('+') != std::string::npos;
  for (int i = 0; i < kMostLines && !lines.at_end(); ++i) {
    const std::string line = lines.next();
    if (line.starts_with('=')) {
      words.options.maps.push_back(stein::cli::parse_plane_map(line.substr(1)));
    } else {
      words.planes.emplace_back(line, plane);
    }
  }
  return words;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const std::string stem =
      (std::filesystem::temp_directory_path() / ("stein-fuzz-" + std::to_string(::getpid()) + "-")).string();
  stein::Plane plane(kWidth, kHeight);
  for (int x = 0; x < kWidth; ++x) plane.row(1)[x] = static_cast<float>(x);
  try {
    const Words words = read_words({bytes, size}, plane.view());
    stein::exr::write_planes(stem + "color.exr", words.planes);
    if (words.has_companion) stein::exr::write_planes(stem + "colorVariance.exr", words.planes);
    stein::fuzz::look_at(stein::exr::read_frame(stem + "color.exr", words.options).frame());
  } catch (const stein::Error&) {
    // The promised end of words that mean nothing.
  }
  for (const char* name : {"color.exr", "colorVariance.exr"}) std::filesystem::remove(stem + name);
  return 0;
}
