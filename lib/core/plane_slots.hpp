// SPDX-License-Identifier: Apache-2.0
//
// Which planes a frame can have, and what each is called in files and in C.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "stein/frame.hpp"

namespace stein {

inline constexpr std::array<const char*, 3> kColourNames = {"R", "G", "B"};

/// Calls visit(name, view) for the colour and what belongs to it. `FrameType` is Frame or const Frame.
template <class FrameType, class Visit>
void for_each_colour_slot(FrameType& frame, const Visit& visit) {
  constexpr std::array<const char*, 3> kPairs = {"covariance.R.G", "covariance.R.B", "covariance.G.B"};
  for (std::size_t c = 0; c < 3; ++c) visit(std::string(kColourNames[c]), frame.colour[c]);
  for (std::size_t c = 0; c < 3; ++c) visit(std::string("variance.") + kColourNames[c], frame.colour_variance[c]);
  for (std::size_t c = 0; c < 3; ++c) visit(std::string(kPairs[c]), frame.colour_covariance[c]);
  visit(std::string("sampleCount"), frame.sample_count);
}

/// Calls visit(name, view) for every view that the feature holds.
template <class FeatureType, class Visit>
void for_each_slot(FeatureType& feature, const Visit& visit) {
  const std::size_t channels = feature.mean.size();
  for (std::size_t k = 0; k < channels; ++k) visit(plane_name(feature, k, false), feature.mean[k]);
  for (std::size_t k = 0; k < feature.variance.size(); ++k) visit(plane_name(feature, k, true), feature.variance[k]);
  for (std::size_t i = 0; i < feature.colour_covariance.size(); ++i) {
    visit(std::string("covariance.") + kColourNames[i / channels] + "." + plane_name(feature, i % channels, false),
          feature.colour_covariance[i]);
  }
}

}  // namespace stein
