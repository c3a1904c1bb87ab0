// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stein {

/// Mean correlation of the noise of two different taps of level `level` (0 is the finest) of the à-trous transform,
/// each pair weighted with its weights, where the noise of the image is white and nothing stops at edges.
[[nodiscard]] double tap_correlation(int level);

}  // namespace stein
