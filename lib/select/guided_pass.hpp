// SPDX-License-Identifier: Apache-2.0
//
// Edge-aware smoothing of maps: a chain of cheap passes, each a 5x5 window whose taps lie `step` pixels apart.
#pragma once

#include <vector>

#include "exec/buffers.hpp"
#include "exec/rect.hpp"
#include "filters/filter.hpp"
#include "filters/guide_tile.hpp"

namespace stein {

/// Maps in a window of rows: planes [first_plane, first_plane + count).
struct MapRows {
  const exec::RowRing* ring = nullptr;
  int first_plane = 0;
  int count = 0;
  [[nodiscard]] float* row(int map, int y) const noexcept { return ring->row(first_plane + map, y); }
};

/// Spatial weights of the five taps of a pass, in x and in y.
enum class PassKernel {
  kBox,       ///< widest for its taps; several passes leave a faint grid around isolated values
  kB3Spline,  ///< 1 4 6 4 1: smooth over any number of passes
};

class GuidedPass {
 public:
  static constexpr int kRadius = 2;  ///< in taps

  /// The guides of `params` without a range term, with all feature sigmas times `sigma_scale`.
  GuidedPass(const Source& source, const CrossBilateralParams& params, float sigma_scale, PassKernel kernel, int step,
             int tile_width, int tile_height);

  [[nodiscard]] int halo() const noexcept { return layout_.halo; }

  /// Weighted means over the valid pixels of the window. Writes up to the next multiple of 16 pixels in x.
  void run(const Rect& tile, FilterScratch& scratch, const MapRows& in, const MapRows& out) const;

 private:
  const Source& source_;
  GuideSet guides_;
  exec::TileLayout layout_;
  std::vector<std::ptrdiff_t> taps_;
  std::vector<float> spatial_;
};

}  // namespace stein
