// SPDX-License-Identifier: Apache-2.0
//
// The error that a run reports against the true one: of the whole image, and of the pixels by what is reported of them.
#pragma once

#include <array>
#include <vector>

#include "stein/denoise.hpp"
#include "stein/exr.hpp"

namespace stein::quality {

/// Pixels whose reported relative error lies in [lower, upper).
struct ReliabilityBin {
  double lower = 0;
  double upper = 0;
  double share = 0;     ///< of all pixels
  double reported = 0;  ///< mean over them
  double truth = 0;     ///< mean over them, the reference's own noise taken off
};

/// Bins of equal ratio from 1e-5 to 1, after one for all below and before one for all above. Relative errors are means
/// over the channels of the squared error over r^2 + 0.01, r the reference.
[[nodiscard]] std::vector<ReliabilityBin> reliability(const DenoiseResult& result, const exr::NamedPlanes& reference,
                                                      double reference_noise);

}  // namespace stein::quality
