// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace stein::metrics {

/// One channel in double precision, row-major.
struct GreyImage {
  int width = 0;
  int height = 0;
  std::vector<double> values;
};

/// Structural similarity: Gaussian window of sigma 1.5 and 11x11 taps, clipped to the image at its border; K1 = 0.01,
/// K2 = 0.03, data range 1; the mean over all pixels.
/// Wang, Bovik, Sheikh, Simoncelli: Image quality assessment: from error visibility to structural similarity (2004).
[[nodiscard]] double ssim(const GreyImage& a, const GreyImage& b);

}  // namespace stein::metrics
