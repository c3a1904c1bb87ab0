// SPDX-License-Identifier: Apache-2.0
//
// The light that the passes lost: a step on pixels, after them.
#pragma once

#include <array>
#include <vector>

#include "rpf/sample_rows.hpp"

namespace stein::rpf {

/// Weighted means prefer what most samples have: of a skewed distribution they lose light, evenly over a surface. The
/// difference between the samples as they were rendered and the filtered ones holds it, below its noise; its mean over
/// the pixels around, those of like colour, goes back to the pixel as far as it is more than noise.
class LightReturn {
 public:
  /// Pixels that are done at a time. A multiple of this is the first of them.
  static constexpr int kSpan = 16;

  /// `sigma`: of the Gaussian over the pixels around, in pixels. It ends after `radius()`.
  explicit LightReturn(float sigma);

  [[nodiscard]] int radius() const noexcept { return radius_; }
  /// Of SampleRow::balance, which is 0 before pixels are noted.
  [[nodiscard]] std::size_t row_floats(int width) const noexcept;
  /// Remembers what pixel x has after pass `last`, and what its samples had.
  void note_pixel(const RecordLayout& layout, int last, int x, SampleRow& row) const;
  /// The result of pixels [x0, x0 + kSpan) of row y, from the rows around; it goes to pixels[stage].
  void run(int stage, int x0, int y, SampleRows& rows) const;

 private:
  [[nodiscard]] std::ptrdiff_t pitch(int width) const noexcept { return width + 2 * radius_ + kSpan; }

  int radius_;
  std::vector<float> taps_;
};

}  // namespace stein::rpf
