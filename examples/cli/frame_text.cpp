// SPDX-License-Identifier: Apache-2.0
#include "frame_text.hpp"

#include <array>
#include <cstdio>

#include "plane_statistics.hpp"

namespace stein::cli {
namespace {

std::string number_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

}  // namespace

std::string size_text(const exr::LoadedFrame& input) {
  const Frame& frame = input.frame();
  std::string text = std::to_string(frame.width) + "x" + std::to_string(frame.height);
  const std::array<int, 4> window = input.data_window();
  if (window[0] != 0 || window[1] != 0) {
    text += ", data window from " + std::to_string(window[0]) + "," + std::to_string(window[1]) + " to " +
            std::to_string(window[2]) + "," + std::to_string(window[3]);
  }
  return text;
}

std::string samples_text(const Frame& frame) {
  std::string text;
  if (!frame.sample_count) {
    text = number_text(frame.uniform_sample_count) + " per pixel";
  } else {
    const PlaneStatistics count = statistics(frame.sample_count);
    const bool varies = count.maximum > count.minimum;
    text = number_text(count.minimum) + (varies ? " to " + number_text(count.maximum) : "") + " per pixel";
    if (varies) text += ", mean " + number_text(count.mean);
  }
  if (frame.degrees_of_freedom > 0) {
    text += ", variances with " + number_text(frame.degrees_of_freedom) + " degrees of freedom";
  }
  return text;
}

std::string colour_text(const Frame& frame) {
  return frame.colour_covariance[0] ? "variance, covariances" : "variance";
}

std::string feature_text(const Feature& feature) {
  std::string text =
      feature.name + " (" + std::to_string(feature.mean.size()) + (feature.mean.size() == 1 ? " channel" : " channels");
  text += feature.variance.empty() ? ", no variance" : ", variance";
  text += feature.colour_covariance.empty() ? ")" : ", covariance with the colour)";
  return text;
}

}  // namespace stein::cli
