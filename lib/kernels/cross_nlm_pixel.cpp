// SPDX-License-Identifier: Apache-2.0
//
// The cross non-local means of one pixel, a vector of neighbours at a time.
#include <algorithm>

#include "kernels/cross_nlm.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/cross_nlm_pixel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/patch_distance-inl.hpp"
#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

// The pixel's own guides, in all lanes.
struct OwnGuides {
  OwnGuides(const OwnGuides&) = delete;
  OwnGuides& operator=(const OwnGuides&) = delete;
  OwnGuides(const Guides& around, std::ptrdiff_t at) : guides(around) {
    const int channels = around.groups > 0 ? around.group_end[around.groups - 1] : 0;
    for (int k = 0; k < channels; ++k) guides.channel[k] = repeat(around.channel[k][at], channel[k]);
    for (int g = 0; g < around.groups; ++g) guides.variance[g] = repeat(around.variance[g][at], variance[g]);
  }
  static const float* repeat(float value, float (&lanes)[kMaxLanes]) {
    std::fill_n(lanes, kMaxLanes, value);
    return lanes;
  }
  Guides guides;
  alignas(64) float channel[kMaxGuideChannels][kMaxLanes];
  alignas(64) float variance[kMaxGuideGroups][kMaxLanes];
};

// Distances of the patch around the pixel `own` to those around the pixels from `other` on.
template <bool kNormalised>
HWY_INLINE FloatVec patch_distances_to(FloatTag d, const CrossNlmRows& rows, std::ptrdiff_t own, std::ptrdiff_t other) {
  const auto load = [d](const float* from) HWY_ATTR { return hn::LoadU(d, from); };
  const auto repeat = [d](const float* from) HWY_ATTR { return hn::Set(d, *from); };
  const PairPlanes planes(rows);
  FloatVec sum = hn::Zero(d);
  FloatVec count = hn::Zero(d);
  for (int y = -rows.patch_radius; y <= rows.patch_radius; ++y) {
    for (int x = -rows.patch_radius; x <= rows.patch_radius; ++x) {
      const std::ptrdiff_t offset = x + y * rows.pitch;
      const PairSide a = pair_side<kNormalised, true>(planes, own + offset, repeat);
      const PairSide b = pair_side<kNormalised, true>(planes, other + offset, load);
      sum = hn::Add(sum, pair_of<kNormalised, true>(d, a, b).distance);
      count = hn::MulAdd(a.mask, b.mask, count);
    }
  }
  return hn::Max(hn::Div(sum, hn::Max(count, hn::Set(d, 1.0F))), hn::Zero(d));
}

// Sums of a candidate: weights w, and w x_c for each colour channel.
struct PixelSums {
  alignas(64) float sum[kMaxRangeSigmas][4][kMaxLanes] = {};
};

template <bool kNormalised, bool kUsual>
HWY_INLINE void add_neighbours(FloatTag d, const CrossNlmRows& rows, const OwnGuides& own, std::ptrdiff_t pixel,
                               std::ptrdiff_t other, int count, PixelSums& to) {
  const FloatVec mask = hn::LoadU(d, rows.guides.mask + other);
  const auto is_neighbour = hn::And(hn::FirstN(d, static_cast<std::size_t>(count)), hn::Gt(mask, hn::Zero(d)));
  if (hn::AllFalse(d, is_neighbour)) return;
  const FloatVec patches = patch_distances_to<kNormalised>(d, rows, pixel, other);
  const std::ptrdiff_t at[1] = {other};
  FloatVec guides[1];
  guide_distances<kUsual>(d, own.guides, rows.guides, 0, at, guides);
  FloatVec colour[3];
  for (int c = 0; c < 3; ++c) colour[c] = hn::IfThenElseZero(is_neighbour, hn::LoadU(d, rows.colour[c] + other));
  for (int s = 0; s < rows.candidates; ++s) {
    const FloatVec distance = hn::MulAdd(hn::Set(d, rows.exponent[s]), patches, guides[0]);
    const FloatVec w = hn::IfThenElseZero(is_neighbour, exp2_negative(d, distance));
    hn::Store(hn::Add(hn::Load(d, to.sum[s][0]), w), d, to.sum[s][0]);
    for (int c = 0; c < 3; ++c) {
      float* HWY_RESTRICT sum = to.sum[s][1 + c];
      hn::Store(hn::MulAdd(w, colour[c], hn::Load(d, sum)), d, sum);
    }
  }
}

template <bool kNormalised, bool kUsual>
HWY_NOINLINE void run_pixel(const CrossNlmRows& rows, std::ptrdiff_t pixel, float (&result)[kMaxRangeSigmas][3]) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const OwnGuides own(rows.guides, pixel);
  PixelSums sums;
  const int side = 2 * rows.window_radius + 1;
  for (int y = -rows.window_radius; y <= rows.window_radius; ++y) {
    const std::ptrdiff_t first = pixel - rows.window_radius + y * rows.pitch;
    for (int x = 0; x < side; x += lanes)
      add_neighbours<kNormalised, kUsual>(d, rows, own, pixel, first + x, std::min(lanes, side - x), sums);
  }
  for (int s = 0; s < rows.candidates; ++s) {
    const float weight = hn::GetLane(hn::SumOfLanes(d, hn::Load(d, sums.sum[s][0])));
    for (int c = 0; c < 3; ++c) {
      const float sum = hn::GetLane(hn::SumOfLanes(d, hn::Load(d, sums.sum[s][1 + c])));
      result[s][c] = weight > 0.0F ? sum / weight : rows.colour[c][pixel];
    }
  }
}

void CrossNlmPixelTarget(const CrossNlmRows& rows, std::ptrdiff_t pixel, float (&result)[kMaxRangeSigmas][3]) {
  using Run = void (*)(const CrossNlmRows&, std::ptrdiff_t, float(&)[kMaxRangeSigmas][3]);
  static constexpr Run kRuns[2][2] = {{run_pixel<false, false>, run_pixel<false, true>},
                                      {run_pixel<true, false>, run_pixel<true, true>}};
  kRuns[rows.is_normalised ? 1 : 0][is_usual(rows.guides) ? 1 : 0](rows, pixel, result);
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::kernels {

HWY_EXPORT(CrossNlmPixelTarget);

void cross_nlm_pixel(const CrossNlmRows& rows, std::ptrdiff_t pixel, float (&result)[kMaxRangeSigmas][3]) {
  HWY_DYNAMIC_DISPATCH(CrossNlmPixelTarget)(rows, pixel, result);
}

}  // namespace stein::kernels
#endif  // HWY_ONCE
