// SPDX-License-Identifier: Apache-2.0
//
// One pass of random parameter filtering at one pixel: the body of RPF Algorithm 1.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/buffers.hpp"
#include "rpf/dependencies.hpp"
#include "rpf/neighbour_draws.hpp"

namespace stein::rpf {

/// Works on one pixel after the other; one per thread.
class PixelFilter {
 public:
  PixelFilter(const RecordLayout& layout, const RpfParams& params, const std::vector<OffsetTable>& tables);

  /// Filters the samples of pixel (x, y) of the first frame. `rows` is that frame's, to write to.
  void run(int pass, int x, int y, const std::vector<NeighbourFrame>& frames, SampleRows& rows);

 private:
  void add_own_samples(int pass, int x, const SampleRow& row);
  void find_bounds();
  int gather();
  void measure(int pass);
  void filter(int pass);
  void reset_spikes(float* colours) const;
  void fill_empty(int pass, int x, int y, SampleRows& rows) const;

  const RecordLayout& layout_;
  const RpfParams& params_;
  const std::vector<OffsetTable>& tables_;
  DependencyMeter meter_;
  FilterWeights weights_;
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
