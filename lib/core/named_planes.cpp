// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstddef>

#include "stein/frame.hpp"

namespace stein {
namespace {

using NamedView = std::pair<std::string, ConstPlaneView>;

constexpr std::array<const char*, 3> kColourNames = {"R", "G", "B"};

void add_feature(const Feature& feature, std::vector<NamedView>& planes) {
  const std::size_t channels = feature.mean.size();
  for (std::size_t k = 0; k < channels; ++k) {
    planes.emplace_back(plane_name(feature, k, false), feature.mean[k]);
  }
  for (std::size_t k = 0; k < feature.variance.size(); ++k) {
    planes.emplace_back(plane_name(feature, k, true), feature.variance[k]);
  }
  for (std::size_t i = 0; i < feature.colour_covariance.size(); ++i) {
    const std::string colour = kColourNames[i / channels];
    planes.emplace_back("covariance." + colour + "." + plane_name(feature, i % channels, false),
                        feature.colour_covariance[i]);
  }
}

}  // namespace

std::vector<NamedView> named_planes(const Frame& frame) {
  constexpr std::array<const char*, 3> kPairs = {"covariance.R.G", "covariance.R.B", "covariance.G.B"};
  std::vector<NamedView> planes;
  for (std::size_t c = 0; c < 3; ++c) {
    planes.emplace_back(kColourNames[c], frame.colour[c]);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    planes.emplace_back(std::string("variance.") + kColourNames[c], frame.colour_variance[c]);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    planes.emplace_back(kPairs[c], frame.colour_covariance[c]);
  }
  planes.emplace_back("sampleCount", frame.sample_count);
  for (const Feature& feature : frame.features) {
    add_feature(feature, planes);
  }
  planes.emplace_back("A", frame.alpha);
  for (const ColourLayer& layer : frame.extra_layers) {
    for (std::size_t c = 0; c < 3; ++c) {
      planes.emplace_back(layer.name + "." + kColourNames[c], layer.mean[c]);
    }
  }
  std::erase_if(planes, [](const NamedView& plane) { return !plane.second; });
  return planes;
}

}  // namespace stein
