// SPDX-License-Identifier: Apache-2.0
//
// The edge-avoiding à-trous filters as docs/filters/atrous.md writes them, in double, on whole images.
#pragma once

#include <array>
#include <vector>

#include "prefilter/source.hpp"
#include "stein/filters.hpp"

namespace stein::test {

/// A level of the transform; planes in row order.
struct AtrousLevel {
  std::array<std::vector<double>, 3> colour;
  std::vector<double> noise;                  ///< variance, summed over the channels
  std::array<std::vector<double>, 3> detail;  ///< this colour minus the next level's; empty at the last level
  std::vector<double> energy;                 ///< of the taps around their mean, summed over the channels
  std::vector<double> noise_energy;           ///< what noise alone adds to that
  std::vector<double> detail_weight;          ///< as `params` says, but not rounded to steps
};

/// Where the planes hold pixel (x, y).
[[nodiscard]] inline std::size_t pixel_index(int width, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

/// All levels, the first one that of the frame; levels + 1 of them.
std::vector<AtrousLevel> atrous_reference(const AtrousSureParams& params, const Source& source);

/// The last level and the weighted details.
std::array<std::vector<double>, 3> atrous_result(const AtrousSureParams& params,
                                                 const std::vector<AtrousLevel>& levels);

}  // namespace stein::test
