// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stein {

/// Pixels in each direction that are around one.
inline constexpr int kSurroundings = 5;

/// Rows of an image, up to kSurroundings above and below one, and that one: pointers to column 0.
struct RowsAround {
  const float* const* rows;
  int count;
  int width;  ///< of the image
};

/// out[i]: the mean of max(value, 0) over the square around pixel x + i of the row `own`, which is one of the rows, as
/// far as it lies in the image; without the pixel itself. 0 where there is no other pixel. `columns`: count + 2
/// kSurroundings floats of scratch.
void mean_around_row(const RowsAround& around, const float* own, int x, int count, float* columns, float* out);

}  // namespace stein
