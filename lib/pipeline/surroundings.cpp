// SPDX-License-Identifier: Apache-2.0
#include "pipeline/surroundings.hpp"

#include <algorithm>

namespace stein {

// Sums over columns, then of those: each in the same order whatever the tile, so that its edges do not show. The pixel
// itself is never added: it can be so large that nothing of the others would be left in the sum.
void mean_around_row(const RowsAround& around, const float* own, int x, int count, float* columns, float* out) {
  const int first = x - kSurroundings;
  const int reach = count + 2 * kSurroundings;
  std::fill_n(columns, reach, 0.0F);
  const int begin = std::max(first, 0);
  const int end = std::min(first + reach, around.width);
  for (int r = 0; r < around.count; ++r) {
    const float* row = around.rows[r];
    if (row == own) continue;
    for (int i = begin; i < end; ++i) columns[i - first] += std::max(row[i], 0.0F);
  }
  std::copy_n(columns + kSurroundings, count, out);
  for (int i = begin; i < end; ++i) columns[i - first] += std::max(own[i], 0.0F);
  for (int i = 0; i < count; ++i) {
    for (int k = 1; k <= kSurroundings; ++k) out[i] += columns[i + kSurroundings - k] + columns[i + kSurroundings + k];
    const int inside = std::min(x + i + kSurroundings + 1, around.width) - std::max(x + i - kSurroundings, 0);
    const int others = inside * around.count - 1;
    if (others > 0) out[i] /= static_cast<float>(others);
  }
}

}  // namespace stein
