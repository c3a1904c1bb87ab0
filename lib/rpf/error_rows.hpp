// SPDX-License-Identifier: Apache-2.0
//
// The estimated error of the result, row by row: Monte Carlo joint SURE (docs/risk.md), smoothed.
#pragma once

#include <array>
#include <vector>

#include "exec/buffers.hpp"
#include "rpf/sample_rows.hpp"

namespace stein::rpf {

class ErrorRows {
 public:
  /// Of the Gaussian that smooths; it ends after kRadius pixels.
  static constexpr float kSigma = 4.0F;
  static constexpr int kRadius = 8;

  /// `ring_rows`: rows that are remembered, more than 2 kRadius; `memory`: where they lie, null for the heap.
  ErrorRows(int width, int height, const RecordLayout& layout, int ring_rows, Memory* memory);

  /// Rows in order: what the last pass gave for the samples as they are, and for those that were moved.
  void add_row(const SampleRows& rows, const std::vector<const SampleRows*>& moved, int last_pass, float step);
  /// Smoothed; the rows within kRadius must have been added.
  void smooth_row(int channel, int y, float* out) const;

  [[nodiscard]] int rows_added() const noexcept { return rows_added_; }
  [[nodiscard]] std::array<double, 3> mean() const;

 private:
  enum : int { kWeight = 3, kPlanes = 4 };
  void risk_of_pixel(const SampleRow& row, const std::vector<const SampleRows*>& moved, int pass, float step, int x);
  void blur_row();

  int width_;
  int height_;
  const RecordLayout& layout_;
  int rows_added_ = 0;
  std::array<float, 2 * kRadius + 1> taps_{};
  std::array<std::vector<float>, kPlanes> risk_;  // of the row at hand: three channels, and 1 where they are known
  exec::RowRing blurred_;                         // along x
  std::array<double, 3> sum_{};
  std::int64_t known_ = 0;
};

}  // namespace stein::rpf
