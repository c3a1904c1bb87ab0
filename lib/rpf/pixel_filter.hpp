// SPDX-License-Identifier: Apache-2.0
//
// One pass of random parameter filtering at one pixel: the body of RPF Algorithm 1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "exec/buffers.hpp"
#include "rpf/dependencies.hpp"
#include "rpf/frame_match.hpp"
#include "rpf/neighbour_draws.hpp"

namespace stein::rpf {

/// Works on one pixel after the other; one per thread.
class PixelFilter {
 public:
  /// Everything referred to must outlive this.
  PixelFilter(const RecordLayout& layout, const RpfParams& params, const std::vector<OffsetTable>& tables);

  /// Filters the samples of pixel (x, y) of `rows`; `adjacent`: where else neighbours come from.
  void run(int pass, int x, int y, SampleRows& rows, const std::vector<const SampleRows*>& adjacent);

 private:
  void list_own_samples(int pass, int x, const SampleRow& row);
  void list_neighbours(int pass, int x, int y, const SampleRows& rows, const std::vector<const SampleRows*>& adjacent);
  void find_bounds();
  void gather();
  void weigh_columns(int pass);
  void filter();
  void settle_spikes();
  void fill_empty(int pass, int x, int y, const SampleRows& rows, float* pixel) const;

  const RecordLayout& layout_;
  const RpfParams& params_;
  const std::vector<OffsetTable>& tables_;
  FrameMatcher matcher_;
  DependencyMeter meter_;
  FilterWeights weights_;
  std::vector<NeighbourFrame> frames_;
  SampleList list_;
  int own_ = 0;    // samples of the pixel, the first of the list
  int count_ = 0;  // of the neighbourhood
  std::vector<float> low_;
  std::vector<float> high_;
  std::vector<std::int32_t> kept_;
  exec::FloatBuffer planes_;  // columns, current colours, scaled planes
  std::ptrdiff_t pitch_ = 0;
  std::vector<kernels::PlaneMoments> moments_;
  std::vector<const float*> scaled_;
  std::vector<float> result_;
};

}  // namespace stein::rpf
