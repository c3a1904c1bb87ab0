// SPDX-License-Identifier: Apache-2.0
//
// Errors of an image against a reference. Internal to the project's programs (not installed).
#pragma once

#include <array>

#include "stein/plane.hpp"

namespace stein::metrics {

using Rgb = std::array<ConstPlaneView, 3>;

struct Comparison {
  double rel_mse = 0;          ///< mean over pixels and channels of (a-b)^2 / (b^2 + 0.01)
  double trimmed_rel_mse = 0;  ///< the same without the worst 0.01 % of the pixels (per-pixel mean over channels)
  double mse = 0;
  double psnr = 0;  ///< dB, of the sRGB-encoded [0,1] images; +inf for equal images
  double ssim = 0;  ///< Gaussian sigma 1.5 (11x11), of the mean of the clipped, sRGB-encoded channels
};

/// `image` against `reference` (same size; checked). Non-finite pixels make the figures non-finite: they are not
/// hidden.
[[nodiscard]] Comparison compare(const Rgb& image, const Rgb& reference);

/// (a-b)^2 / (b^2 + 0.01), mean over the channels, per pixel.
[[nodiscard]] Plane relative_error_map(const Rgb& image, const Rgb& reference);

/// Linear to sRGB-encoded; the input is clipped to [0, 1], NaN becomes 0.
[[nodiscard]] float encode_srgb(float linear) noexcept;

}  // namespace stein::metrics
