// SPDX-License-Identifier: Apache-2.0
//
// Random directions with a given covariance, pixel by pixel: what Monte Carlo estimates of a risk perturb the input by.
#pragma once

#include <array>
#include <cstdint>

namespace stein {

/// Three independent numbers of mean 0 and variance 1 for a pixel and a draw: signs, which give the least variance. A
/// function of its arguments alone, so that threads and tiles cannot change it.
[[nodiscard]] std::array<float, 3> random_signs(std::uint64_t seed, int draw, int x, int y) noexcept;

/// Lower triangle L with L L^T = S, the covariance of the three colour channels. Where S is singular up to rounding
/// (grey light, fewer than four samples) the column is 0.
struct ColourFactor {
  float l00 = 0, l10 = 0, l11 = 0, l20 = 0, l21 = 0, l22 = 0;

  ColourFactor() noexcept = default;
  /// S = [v0 c01 c02; c01 v1 c12; c02 c12 v2]
  ColourFactor(float v0, float v1, float v2, float c01, float c02, float c12) noexcept;

  /// b_x = L z: covariance S.
  [[nodiscard]] float colour(std::size_t channel, const std::array<float, 3>& z) const noexcept;
  /// b_y = m z with m L^T = (c0, c1, c2): covariance c with b_x. Its own variance is the least that this allows
  /// (b_y = c S^+ b_x), which is less noise than the feature's own.
  [[nodiscard]] float feature(float c0, float c1, float c2, const std::array<float, 3>& z) const noexcept;
};

}  // namespace stein
