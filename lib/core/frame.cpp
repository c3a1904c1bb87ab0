// SPDX-License-Identifier: Apache-2.0
#include "stein/frame.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "core/validity.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};
constexpr std::array<const char*, 3> kColourPairs = {"R.G", "R.B", "G.B"};

std::string channel_suffix(std::size_t channel, std::size_t count, const std::string& feature) {
  if (count == 1) return feature == "visibility" ? "V" : "Z";
  const bool is_colour = feature.find("albedo") != std::string::npos || feature.find("colo") != std::string::npos;
  constexpr std::array<const char*, 4> kColour = {"R", "G", "B", "A"};
  constexpr std::array<const char*, 4> kVector = {"X", "Y", "Z", "W"};
  return (is_colour ? kColour : kVector).at(channel);
}

[[noreturn]] void fail(const Frame& frame, const std::string& what) {
  throw Error(ErrorCode::kInvalidFrame, name_of(frame) + ": " + what);
}

void check_plane(const Frame& frame, const ConstPlaneView& view, const std::string& name, const char* advice) {
  if (!view) fail(frame, "plane '" + name + "' is missing; " + advice);
  if (view.width() != frame.width || view.height() != frame.height) {
    fail(frame, "plane '" + name + "' is " + std::to_string(view.width()) + "x" + std::to_string(view.height()) +
                    ", the frame is " + std::to_string(frame.width) + "x" + std::to_string(frame.height) +
                    "; all planes must have the size of the frame");
  }
}

void check_colour(const Frame& frame) {
  for (std::size_t c = 0; c < 3; ++c) {
    check_plane(frame, frame.colour[c], kRgb[c], "supply the mean of the samples for R, G and B");
    check_plane(frame, frame.colour_variance[c], std::string("variance.") + kRgb[c],
                "supply the variance of the mean (sample variance / n) for R, G and B");
  }
  const auto present = std::count_if(frame.colour_covariance.begin(), frame.colour_covariance.end(),
                                     [](const ConstPlaneView& v) { return static_cast<bool>(v); });
  for (std::size_t p = 0; present > 0 && p < 3; ++p) {
    check_plane(frame, frame.colour_covariance[p], std::string("covariance.") + kColourPairs[p],
                "supply all three colour covariances or none");
  }
}

void check_counts(const Frame& frame) {
  if (frame.sample_count) {
    check_plane(frame, frame.sample_count, "sampleCount", "supply samples per pixel");
  } else if (!(frame.uniform_sample_count >= 1) || !std::isfinite(frame.uniform_sample_count)) {
    fail(frame,
         "the number of samples per pixel is unknown; supply the plane 'sampleCount' or a uniform sample count >= 1");
  }
  if (!(frame.degrees_of_freedom >= 0) || !std::isfinite(frame.degrees_of_freedom)) {
    fail(frame, "the variances' degrees of freedom are " + std::to_string(frame.degrees_of_freedom) +
                    "; they must be positive, or 0 where each pixel has one less than samples");
  }
}

void check_feature(const Frame& frame, const Feature& feature) {
  const std::size_t channels = feature.mean.size();
  if (feature.name.empty()) fail(frame, "a feature has no name; give each feature a unique name");
  if (channels < 1 || channels > 4) {
    fail(frame, "feature '" + feature.name + "' has " + std::to_string(channels) + " channels; 1 to 4 are possible");
  }
  if (!feature.variance.empty() && feature.variance.size() != channels) {
    fail(frame, "feature '" + feature.name + "' has " + std::to_string(channels) + " means but " +
                    std::to_string(feature.variance.size()) + " variances; supply one variance per channel or none");
  }
  if (!feature.colour_covariance.empty() && feature.variance.empty()) {
    fail(frame, "feature '" + feature.name +
                    "' has covariances with the colour but no variances; supply its variances, or neither");
  }
  if (!feature.colour_covariance.empty() && feature.colour_covariance.size() != 3 * channels) {
    fail(frame, "feature '" + feature.name + "' has " + std::to_string(feature.colour_covariance.size()) +
                    " covariances with the colour; supply three per channel or none");
  }
  for (std::size_t k = 0; k < channels; ++k) {
    check_plane(frame, feature.mean[k], plane_name(feature, k, false), "a feature's view may not be empty");
    if (!feature.variance.empty()) {
      check_plane(frame, feature.variance[k], plane_name(feature, k, true), "a feature's view may not be empty");
    }
  }
  for (std::size_t i = 0; i < feature.colour_covariance.size(); ++i) {
    const std::string name =
        std::string("covariance.") + kRgb[i / channels] + "." + plane_name(feature, i % channels, false);
    check_plane(frame, feature.colour_covariance[i], name, "supply three covariances per channel or none");
  }
}

void check_layer(const Frame& frame, const Layer& layer) {
  if (layer.name.empty()) fail(frame, "a layer has no name; give each layer a unique name");
  if (layer.mean.size() != 1 && layer.mean.size() != 3) {
    fail(frame, "layer '" + layer.name + "' has " + std::to_string(layer.mean.size()) +
                    " channels; supply R, G and B, or one channel");
  }
  for (std::size_t c = 0; c < layer.mean.size(); ++c)
    check_plane(frame, layer.mean[c], plane_name(layer, c), "supply all channels of the layer");
}

}  // namespace

std::string describe(const BadValue& bad) {
  std::ostringstream text;
  text << "plane '" << bad.plane << "' holds " << bad.value << " at pixel (" << bad.x << ", " << bad.y << ")";
  return text.str();
}

std::string name_of(const Frame& frame) { return frame.origin.empty() ? "frame" : "'" + frame.origin + "'"; }

std::string plane_name(const Feature& feature, std::size_t channel, bool is_variance) {
  return feature.name + (is_variance ? ".variance." : ".") + channel_suffix(channel, feature.mean.size(), feature.name);
}

std::string plane_name(const Layer& layer, std::size_t channel) {
  return layer.mean.size() == 1 ? layer.name : layer.name + "." + kRgb.at(channel);
}

void check(const Frame& frame) {
  constexpr int kMaxSide = 1 << 20;
  if (frame.width < 1 || frame.height < 1 || frame.width > kMaxSide || frame.height > kMaxSide) {
    fail(frame, "the size is " + std::to_string(frame.width) + "x" + std::to_string(frame.height) +
                    "; each side must be 1 to " + std::to_string(kMaxSide));
  }
  check_colour(frame);
  check_counts(frame);
  std::set<std::string> names;
  for (const Feature& feature : frame.features) {
    check_feature(frame, feature);
    if (!names.insert(feature.name).second)
      fail(frame, "two features are named '" + feature.name + "'; names must be unique");
  }
  names.clear();
  for (const Layer& layer : frame.layers) {
    check_layer(frame, layer);
    if (!names.insert(layer.name).second)
      fail(frame, "two layers are named '" + layer.name + "'; names must be unique");
  }
}

FrameReport inspect(const Frame& frame) {
  exec::Runner runner(Execution{});
  return inspect(frame, runner, 0.0);
}

void check_strict(const Frame& frame) { require_clean(frame, inspect(frame)); }

void require_clean(const Frame& frame, const FrameReport& report) {
  if (report.invalid_pixels > 0) {
    fail(frame, describe(report.first_invalid) + "; " + std::to_string(report.invalid_pixels) +
                    " pixels have no usable colour: fix the renderer, or allow repairs");
  }
  if (report.bad_covariance_pixels > 0) {
    fail(frame, describe(report.first_bad_covariance) + "; " + std::to_string(report.bad_covariance_pixels) +
                    " pixels have unusable covariances: fix the renderer, or allow repairs");
  }
  for (std::size_t f = 0; f < report.bad_feature_pixels.size(); ++f) {
    if (report.bad_feature_pixels[f] > 0) {
      fail(frame, describe(report.first_bad_feature[f]) + "; " + std::to_string(report.bad_feature_pixels[f]) +
                      " pixels of feature '" + frame.features[f].name +
                      "' are unusable: fix the renderer, or allow repairs");
    }
  }
  for (std::size_t l = 0; l < report.bad_layer_pixels.size(); ++l) {
    if (report.bad_layer_pixels[l] > 0) {
      fail(frame, describe(report.first_bad_layer[l]) + "; " + std::to_string(report.bad_layer_pixels[l]) +
                      " pixels of layer '" + frame.layers[l].name +
                      "' are unusable: fix the renderer, or allow repairs");
    }
  }
}

}  // namespace stein
