// SPDX-License-Identifier: Apache-2.0
//
// The window of a non-local means filter.
#pragma once

#include <cstddef>
#include <vector>

#include "exec/buffers.hpp"

namespace stein {

struct NlmWindow {
  int radius = 0;
  int patch_radius = 0;
};

/// Up to here a neighbour's patch, of blurred colours, depends on the pixel.
[[nodiscard]] int near_radius(const NlmWindow& window);

/// Offsets of the window, the near ones first, padded to whole batches.
[[nodiscard]] std::vector<std::ptrdiff_t> nlm_taps(const NlmWindow& window, const exec::TileLayout& layout);

/// Calls visit(dx, dy) in the order of nlm_taps().
template <class Visit>
void for_each_nlm_tap(const NlmWindow& window, Visit visit) {
  const int near = near_radius(window);
  for (const bool wants_near : {true, false}) {
    for (int dy = -window.radius; dy <= window.radius; ++dy) {
      for (int dx = -window.radius; dx <= window.radius; ++dx) {
        const bool is_near = dx >= -near && dx <= near && dy >= -near && dy <= near;
        if (is_near == wants_near) visit(dx, dy);
      }
    }
  }
}

}  // namespace stein
