// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stein {

/// Pixels [x0, x1) x [y0, y1).
struct Rect {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
  [[nodiscard]] int width() const noexcept { return x1 - x0; }
  [[nodiscard]] int height() const noexcept { return y1 - y0; }
};

}  // namespace stein
