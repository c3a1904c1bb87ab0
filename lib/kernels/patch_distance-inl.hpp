// SPDX-License-Identifier: Apache-2.0
//
// Distances of the patches around the pixels of a block to the patches around their neighbours at one offset. Compiled
// once per instruction set.
#if defined(STEIN_KERNELS_PATCH_DISTANCE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef STEIN_KERNELS_PATCH_DISTANCE_INL
#undef STEIN_KERNELS_PATCH_DISTANCE_INL
#else
#define STEIN_KERNELS_PATCH_DISTANCE_INL
#endif

#include <hwy/highway.h>

#include "kernels/cross_nlm.hpp"
#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

// Exact pixels: the reciprocal of their noise must stay finite, and so must the distance of any two radiances.
inline constexpr float kLeastNoise = 1e-24F;
// Of neighbours that count nothing: 2^-d is exactly 0 for any exponent.
inline constexpr float kNoNeighbour = 1e30F;

struct PatchBlock {
  const CrossNlmRows& rows;
  std::ptrdiff_t x = 0;  // first pixel of the block
  int width = 0;         // a multiple of kMaxLanes
  bool is_masked = false;  // whether any pixel that its patches or neighbours reach is no source
  float* HWY_RESTRICT pairs = nullptr;         // per pair of pixels, kNlmPatchWidth apart: distance,
  float* HWY_RESTRICT pair_slopes = nullptr;   // factor to its derivative,
  float* HWY_RESTRICT pair_masks = nullptr;    // 1 where both are sources
  float* HWY_RESTRICT column_sums = nullptr;   // work space
  float* HWY_RESTRICT count_sums = nullptr;
};

// What a tap's distances go to, kNlmBlockWidth apart from row to row.
struct TapDistances {
  float* HWY_RESTRICT distance;
  float* HWY_RESTRICT slope;       // 1 / count times the factor of the pair (i, j); 0 where the distance is clamped
  float* HWY_RESTRICT near_slope;  // the same of the pair (2i - j, i) where it is in the patches; null: it is not
};

// 1 / max(v_a + v_b, tiny): what the squared difference of two noisy pixels is divided by, without absolute units.
HWY_INLINE FloatVec noise_factor(FloatTag d, FloatVec va, FloatVec vb) {
  return reciprocal(d, hn::Max(hn::Add(va, vb), hn::Set(d, kLeastNoise)));
}

// |a - b|^2, or (|a - b|^2 - (v_a + min(v_a, v_b))) / (v_a + v_b), of the pixels of the block and a rim of patch_radius.
template <bool kNormalised, bool kMasked>
HWY_INLINE void pair_distances(FloatTag d, const PatchBlock& block, std::ptrdiff_t tap) {
  const CrossNlmRows& rows = block.rows;
  const int radius = rows.patch_radius;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int y = -radius; y < rows.rows + radius; ++y) {
    const std::ptrdiff_t line = static_cast<std::ptrdiff_t>(kNlmPatchWidth) * (y + radius);
    const std::ptrdiff_t first = block.x - radius + y * rows.pitch;
    for (int k = 0; k < block.width + 2 * radius; k += lanes) {
      const std::ptrdiff_t at = first + k;
      const FloatVec e0 = hn::Sub(hn::LoadU(d, rows.colour[0] + at), hn::LoadU(d, rows.colour[0] + at + tap));
      const FloatVec e1 = hn::Sub(hn::LoadU(d, rows.colour[1] + at), hn::LoadU(d, rows.colour[1] + at + tap));
      const FloatVec e2 = hn::Sub(hn::LoadU(d, rows.colour[2] + at), hn::LoadU(d, rows.colour[2] + at + tap));
      FloatVec distance = hn::MulAdd(e2, e2, hn::MulAdd(e1, e1, hn::Mul(e0, e0)));
      if constexpr (kNormalised) {
        const FloatVec va = hn::LoadU(d, rows.noise + at);
        const FloatVec vb = hn::LoadU(d, rows.noise + at + tap);
        const FloatVec factor = noise_factor(d, va, vb);
        distance = hn::Mul(hn::Sub(distance, hn::Add(va, hn::Min(va, vb))), factor);
        hn::Store(factor, d, block.pair_slopes + line + k);
      }
      if constexpr (kMasked) {
        const FloatVec both = hn::Mul(hn::LoadU(d, rows.guides.mask + at), hn::LoadU(d, rows.guides.mask + at + tap));
        distance = hn::Mul(distance, both);
        hn::Store(both, d, block.pair_masks + line + k);
      }
      hn::Store(distance, d, block.pairs + line + k);
    }
  }
}

// Sums of 2 * radius + 1 pixels along x, then y: always the same additions in the same order, so that neither drift nor
// the block's place can show.
template <int kRadius>
HWY_INLINE void sum_columns(FloatTag d, const PatchBlock& block, const float* HWY_RESTRICT in,
                            float* HWY_RESTRICT out) {
  const int radius = kRadius >= 0 ? kRadius : block.rows.patch_radius;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int y = 0; y < block.rows.rows + 2 * radius; ++y) {
    const std::ptrdiff_t line = static_cast<std::ptrdiff_t>(kNlmPatchWidth) * y;
    for (int k = 0; k < block.width; k += lanes) {
      FloatVec sum = hn::LoadU(d, in + line + k);
      for (int n = 1; n <= 2 * radius; ++n) sum = hn::Add(sum, hn::LoadU(d, in + line + k + n));
      hn::Store(sum, d, out + line + k);
    }
  }
}

template <int kRadius>
HWY_INLINE FloatVec patch_sum(FloatTag d, int radius, const float* HWY_RESTRICT column_sums) {
  FloatVec sum = hn::Load(d, column_sums);
  for (int n = 1; n <= 2 * (kRadius >= 0 ? kRadius : radius); ++n) {
    sum = hn::Add(sum, hn::Load(d, column_sums + n * static_cast<std::ptrdiff_t>(kNlmPatchWidth)));
  }
  return sum;
}

// The factor to the derivative by the pixel as the neighbour's patch sees it: that of the pair (i, 2i - j).
template <bool kNormalised, bool kMasked>
HWY_INLINE FloatVec opposite_factor(FloatTag d, const CrossNlmRows& rows, std::ptrdiff_t at, std::ptrdiff_t tap) {
  FloatVec factor = hn::Set(d, 1.0F);
  if constexpr (kNormalised)
    factor = noise_factor(d, hn::LoadU(d, rows.noise + at - tap), hn::LoadU(d, rows.noise + at));
  if constexpr (kMasked) factor = hn::Mul(factor, hn::LoadU(d, rows.guides.mask + at - tap));
  return factor;
}

template <int kRadius, bool kNormalised, bool kMasked>
HWY_INLINE void mean_distances(FloatTag d, const PatchBlock& block, std::ptrdiff_t tap, const TapDistances& out) {
  const CrossNlmRows& rows = block.rows;
  const int radius = rows.patch_radius;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const FloatVec one = hn::Set(d, 1.0F);
  const FloatVec all = hn::Set(d, 1.0F / static_cast<float>((2 * radius + 1) * (2 * radius + 1)));
  for (int y = 0; y < rows.rows; ++y) {
    const std::ptrdiff_t line = static_cast<std::ptrdiff_t>(kNlmPatchWidth) * y;
    const std::ptrdiff_t centre = line + static_cast<std::ptrdiff_t>(kNlmPatchWidth) * radius + radius;
    for (int k = 0; k < block.width; k += lanes) {
      const std::ptrdiff_t at = block.x + k + y * rows.pitch;
      const std::ptrdiff_t to = static_cast<std::ptrdiff_t>(kNlmBlockWidth) * y + k;
      FloatVec share = all;
      if constexpr (kMasked) {
        share = hn::Div(one, hn::Max(patch_sum<kRadius>(d, radius, block.count_sums + line + k), one));
      }
      const FloatVec mean = hn::Mul(patch_sum<kRadius>(d, radius, block.column_sums + line + k), share);
      FloatVec distance = hn::Max(mean, hn::Zero(d));
      share = hn::IfThenElseZero(hn::Gt(mean, hn::Zero(d)), share);
      if (out.near_slope != nullptr) {
        const FloatVec opposite = opposite_factor<kNormalised, kMasked>(d, rows, at, tap);
        hn::Store(hn::Mul(share, opposite), d, out.near_slope + to);
      }
      if constexpr (kNormalised) share = hn::Mul(share, hn::LoadU(d, block.pair_slopes + centre + k));
      if constexpr (kMasked) {
        const auto is_source = hn::Gt(hn::LoadU(d, rows.guides.mask + at + tap), hn::Zero(d));
        distance = hn::IfThenElse(is_source, distance, hn::Set(d, kNoNeighbour));
      }
      hn::Store(distance, d, out.distance + to);
      hn::Store(share, d, out.slope + to);
    }
  }
}

template <int kRadius, bool kNormalised, bool kMasked>
HWY_NOINLINE void patch_distances_as(const PatchBlock& block, std::ptrdiff_t tap, const TapDistances& out) {
  const FloatTag d;
  pair_distances<kNormalised, kMasked>(d, block, tap);
  sum_columns<kRadius>(d, block, block.pairs, block.column_sums);
  if constexpr (kMasked) sum_columns<kRadius>(d, block, block.pair_masks, block.count_sums);
  mean_distances<kRadius, kNormalised, kMasked>(d, block, tap, out);
}

// One path for patches of 5x5, one for all others.
inline void patch_distances(const PatchBlock& block, std::ptrdiff_t tap, const TapDistances& out) {
  constexpr int kUsualRadius = 2;
  constexpr int kAny = -1;
  using Run = void (*)(const PatchBlock&, std::ptrdiff_t, const TapDistances&);
  static constexpr Run kRuns[2][2][2] = {
      {{patch_distances_as<kAny, false, false>, patch_distances_as<kAny, false, true>},
       {patch_distances_as<kAny, true, false>, patch_distances_as<kAny, true, true>}},
      {{patch_distances_as<kUsualRadius, false, false>, patch_distances_as<kUsualRadius, false, true>},
       {patch_distances_as<kUsualRadius, true, false>, patch_distances_as<kUsualRadius, true, true>}}};
  const bool is_usual_radius = block.rows.patch_radius == kUsualRadius;
  kRuns[is_usual_radius ? 1 : 0][block.rows.is_normalised ? 1 : 0][block.is_masked ? 1 : 0](block, tap, out);
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
