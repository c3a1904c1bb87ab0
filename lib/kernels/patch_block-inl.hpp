// SPDX-License-Identifier: Apache-2.0
//
// What kernels do with the patch distances of a block of pixels to a group of neighbours. Compiled once per instruction
// set.
#if defined(STEIN_KERNELS_PATCH_BLOCK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef STEIN_KERNELS_PATCH_BLOCK_INL
#undef STEIN_KERNELS_PATCH_BLOCK_INL
#else
#define STEIN_KERNELS_PATCH_BLOCK_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <utility>

#include "kernels/cross_nlm.hpp"
#include "kernels/patch_distance-inl.hpp"
#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

// Memory that is handed out bit by bit.
struct Scratch {
  float* next;
  float* take(std::size_t floats) { return std::exchange(next, next + floats); }
};

inline TapDistances take_distances(Scratch& scratch) {
  constexpr std::size_t kGroup = kNlmTapGroup * kNlmBlockPixels;
  const auto take = [&] { return scratch.take(kGroup); };
  return {take(), {take(), take(), take()}};
}

inline PatchFields take_fields(Scratch& scratch) {
  const auto take = [&] { return scratch.take(kNlmPatchFloats); };
  return {take(), take(), take(), take(), {take(), take(), take()}};
}

// Fills the distances of taps [first, first + count); padding counts nothing.
HWY_INLINE void fill_distances(const PatchBlock& block, int first, int count, const TapDistances& to) {
  const CrossNlmRows& rows = block.rows;
  const int near_side = 2 * rows.near_radius + 1;
  for (int t = 0; t < count; ++t) {
    const int index = first + t;
    const std::size_t at = static_cast<std::size_t>(t) * kNlmBlockPixels;
    if (index < rows.tap_count) {
      const Tap tap{rows.taps[index], index < near_side * near_side, index % near_side - rows.near_radius,
                    index / near_side - rows.near_radius};
      patch_distances(block, tap, {to.distance + at, {to.slope[0] + at, to.slope[1] + at, to.slope[2] + at}});
      continue;
    }
    std::fill_n(to.distance + at, kNlmBlockPixels, kNoNeighbour);
    for (float* slope : to.slope) std::fill_n(slope + at, kNlmBlockPixels, 0.0F);
  }
}

// The slopes of a batch of taps, contracted with the covariances of the pixels from x on: SBF Eq. 14, second and third
// term.
HWY_INLINE void contracted_slopes(FloatTag d, const CrossNlmRows& rows, std::ptrdiff_t x,
                                  const float* const (&slope)[3], FloatVec (&out)[3][kTapBatch]) {
  FloatVec z[3][kTapBatch];
  for (int c = 0; c < 3; ++c) {
    for (int t = 0; t < kTapBatch; ++t) {
      z[c][t] = hn::Load(d, slope[c] + t * static_cast<std::ptrdiff_t>(kNlmBlockPixels));
    }
  }
  constexpr int kEntry[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  for (int c = 0; c < 3; ++c) {
    FloatVec v[3];
    for (int k = 0; k < 3; ++k) v[k] = hn::LoadU(d, rows.colour_covariance[kEntry[c][k]] + x);
    for (int t = 0; t < kTapBatch; ++t) {
      out[c][t] = hn::MulAdd(v[2], z[2][t], hn::MulAdd(v[1], z[1][t], hn::Mul(v[0], z[0][t])));
    }
  }
}

// Whether any of the planes is not 0 in the vector at x.
HWY_INLINE bool any_covariance(FloatTag d, const float* const* planes, int count, std::ptrdiff_t x) {
  FloatVec any = hn::Zero(d);
  for (int k = 0; k < count; ++k) any = hn::Or(any, hn::LoadU(d, planes[k] + x));
  return !hn::AllTrue(d, hn::Eq(any, hn::Zero(d)));
}

// Whether all that the block's patches and neighbours reach are sources: then the patches' sizes are known.
HWY_INLINE bool has_hole(FloatTag d, const PatchBlock& block) {
  const CrossNlmRows& rows = block.rows;
  const int rim = rows.window_radius + block.rim();
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int y = -rim; y < rows.rows + rim; ++y) {
    const float* mask = rows.guides.mask + block.x + y * rows.pitch;
    for (int x = -rim; x < block.width + rim; x += lanes) {
      const int at = std::min(x, block.width + rim - lanes);
      if (!hn::AllTrue(d, hn::Eq(hn::LoadU(d, mask + at), hn::Set(d, 1.0F)))) return true;
    }
  }
  return false;
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
