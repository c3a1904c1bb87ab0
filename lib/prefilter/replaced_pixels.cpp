// SPDX-License-Identifier: Apache-2.0
#include "prefilter/replaced_pixels.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace stein {

void ReplacedPixels::add(const std::vector<ReplacedPixel>& pixels, int height) {
  if (pixels.empty()) return;
  const auto before = [](const ReplacedPixel& a, const ReplacedPixel& b) {
    return std::pair(a.y, a.x) < std::pair(b.y, b.x);
  };
  std::vector<ReplacedPixel> merged(list_.size() + pixels.size());
  std::merge(list_.begin(), list_.end(), pixels.begin(), pixels.end(), merged.begin(), before);
  list_ = std::move(merged);
  first_in_row_.assign(static_cast<std::size_t>(height) + 1, 0);
  for (const ReplacedPixel& p : list_) ++first_in_row_[static_cast<std::size_t>(p.y) + 1];
  std::partial_sum(first_in_row_.begin(), first_in_row_.end(), first_in_row_.begin());
}

}  // namespace stein
