// SPDX-License-Identifier: Apache-2.0
#include "filters/nlm_taps.hpp"

#include <algorithm>

#include "kernels/guides.hpp"

namespace stein {

int near_radius(const NlmWindow& window) { return std::min(window.patch_radius + 1, window.radius); }

std::vector<std::ptrdiff_t> nlm_taps(const NlmWindow& window, const exec::TileLayout& layout) {
  std::vector<std::ptrdiff_t> taps;
  for_each_nlm_tap(window, [&](int dx, int dy) { taps.push_back(layout.offset(dx, dy)); });
  while (taps.size() % kernels::kTapBatch != 0) taps.push_back(0);
  return taps;
}

}  // namespace stein
