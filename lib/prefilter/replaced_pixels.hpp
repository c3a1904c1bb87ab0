// SPDX-License-Identifier: Apache-2.0
//
// Pixels that are seen with other values than the frame's, found row by row.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace stein {

/// A pixel whose colour is not the frame's.
struct ReplacedPixel {
  int x = 0;
  int y = 0;
  std::array<float, 3> colour{};
  bool is_source =
      false;           ///< false: an invalid pixel, filled from its neighbours; true: an outlier that was scaled down
  float scale = 0.0F;  ///< of an outlier: what its colour was multiplied with
  float response = 0.0F;  ///< of an outlier: how `colour` follows the frame's, see outliers.cpp
};

class ReplacedPixels {
 public:
  /// Takes in further pixels, in row order, of an image of `height` rows.
  void add(const std::vector<ReplacedPixel>& pixels, int height);

  [[nodiscard]] const std::vector<ReplacedPixel>& list() const noexcept { return list_; }  ///< in row order

  /// Calls visit(pixel, i) for each of the pixels x + i, i in [0, count), of row y.
  template <class Visit>
  void for_each(int y, int x, int count, Visit visit) const {
    if (list_.empty()) return;
    const auto row = static_cast<std::size_t>(y);
    for (std::size_t i = first_in_row_[row]; i < first_in_row_[row + 1]; ++i) {
      const ReplacedPixel& p = list_[i];
      if (p.x >= x && p.x < x + count) visit(p, p.x - x);
    }
  }

 private:
  std::vector<ReplacedPixel> list_;
  std::vector<std::size_t> first_in_row_;  // height + 1 indices into list_; empty while there are none
};

}  // namespace stein
