// SPDX-License-Identifier: Apache-2.0
//
// Edge-aware smoothing of maps: a chain of cheap passes, each a 5x5 window whose taps lie `step` pixels apart.
#pragma once

#include <vector>

#include "exec/buffers.hpp"
#include "exec/rect.hpp"
#include "filters/guide_rows.hpp"
#include "kernels/guided_smooth.hpp"

namespace stein {

/// Maps in a window of rows.
struct MapRows {
  const exec::RowRing* ring = nullptr;
  int count = 0;
  /// Plane with the inverse of the effective count of pixels behind the maps' means (kernels/guided_smooth.hpp); -1:
  /// none.
  int inverse_count = -1;
  [[nodiscard]] float* row(int map, int y) const noexcept { return ring->row(map, y); }
};

/// Spatial weights of the five taps of a pass, in x and in y.
enum class PassKernel {
  kBox,       ///< widest for its taps; several passes leave a faint grid around isolated values
  kB3Spline,  ///< 1 4 6 4 1: smooth over any number of passes
};

struct GuidedPass {
  static constexpr int kRadius = kernels::kWindow / 2;  ///< in taps
  static constexpr int kMaxStep = exec::RowRing::kPadding / kRadius;

  PassKernel kernel = PassKernel::kBox;
  int step = 1;           ///< [1..kMaxStep] px
  float sigma_scale = 1;  ///< factor to all feature sigmas of the guides
  float overlap = 1;      ///< see overlap_factors()

  [[nodiscard]] int halo() const noexcept { return kRadius * step; }
};

/// For a chain of passes with these steps: by what factor the variance of noise after each pass exceeds what it would
/// be if the means that the pass reads were independent, where no guide intervenes.
[[nodiscard]] std::vector<float> overlap_factors(PassKernel kernel, const std::vector<int>& steps);

/// Weighted means of each map over the valid pixels of the window, clipped to the image. The guides and the maps of the
/// tile's rows and those within the halo must be there; so must the inverse counts, if both have them. Writes up to the
/// next multiple of 16 pixels in x.
void run_guided_pass(const GuidedPass& pass, const GuideRows& guides, int image_height, const Rect& tile,
                     const MapRows& in, const MapRows& out);

}  // namespace stein
