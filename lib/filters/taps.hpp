// SPDX-License-Identifier: Apache-2.0
//
// The neighbours of a pixel in the order in which kernels visit them.
#pragma once

#include <cstddef>
#include <vector>

#include "exec/buffers.hpp"

namespace stein {

/// Spatial Gaussians of several scales over one list of taps. A scale reaches kRadiusInSigmas standard deviations. All
/// taps of a batch are equally far away, so that they have one set of active scales and one factor for each; batches
/// are sorted by the number of scales that reach them. The pixel itself makes a batch of four, with a quarter of its
/// factor.
struct ScaleTaps {
  static constexpr float kRadiusInSigmas = 2.0F;

  /// `sigmas` ascending.
  ScaleTaps(const std::vector<float>& sigmas, const exec::TileLayout& layout);

  std::vector<std::ptrdiff_t> offsets;
  std::vector<int> first_scale;  ///< per batch
  std::vector<float> spatial;    ///< [batch][scale]: exp(-|p|^2 / (2 sigma^2))
};

/// Pixels that the largest of the scales reaches.
[[nodiscard]] int radius_of(const std::vector<float>& sigmas);

}  // namespace stein
