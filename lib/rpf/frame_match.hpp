// SPDX-License-Identifier: Apache-2.0
//
// Where what a pixel shows is found in another frame: RPF sec. 6.4.
#pragma once

#include <vector>

#include "rpf/sample_rows.hpp"

namespace stein::rpf {

/// Keeps its memory between pixels; one per thread.
class FrameMatcher {
 public:
  /// The shift of at most `radius` px to the pixel of `frame` whose mean features are nearest to those of pixel (x, y)
  /// of `rows`, in units of what they vary by within the pixel. Of equally near ones the first, no shift before others.
  [[nodiscard]] PixelShift find(const SampleRows& rows, const SampleRows& frame, int x, int y, int radius);

 private:
  struct Scale {
    int column = 0;
    double mean = 0;
    double inverse_variance = 0;
  };
  void find_scales(const SampleRow& row, const RecordLayout& layout, int x);
  [[nodiscard]] double distance(const SampleRow& row, int stride, int x, double limit) const;

  std::vector<Scale> scales_;
};

}  // namespace stein::rpf
