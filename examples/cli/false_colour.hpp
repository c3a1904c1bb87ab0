// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "picture.hpp"
#include "stein/plane.hpp"

namespace stein::cli {

/// Dark violet (0) to light yellow (1), clipped. Lightness is linear in `t`, so that equal steps look equal and the
/// order survives greyscale printing.
[[nodiscard]] Pixel false_colour(double t);

/// Distinct colours for small integers; grey for 0, which is "unfiltered" in a choice plane. Repeats after 10.
[[nodiscard]] Pixel category_colour(int index);

struct ValueRange {
  double low = 0;
  double high = 1;

  [[nodiscard]] double normalise(double value) const noexcept { return (value - low) / (high - low); }
};

/// The 1 % and 99 % quantiles of the finite values, so that single outliers do not leave everything else dark; 0, 0 if
/// there are none.
[[nodiscard]] ValueRange quantile_range(ConstPlaneView plane);

/// From 0 where the values come close to it, and never empty.
[[nodiscard]] ValueRange display_range(ValueRange range);

}  // namespace stein::cli
