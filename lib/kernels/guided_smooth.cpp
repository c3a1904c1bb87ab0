// SPDX-License-Identifier: Apache-2.0
#include "kernels/guided_smooth.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/guided_smooth.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

struct SmoothSums {
  alignas(64) float weight[kMaxLanes];
  alignas(64) float map[kMaxMaps][kMaxLanes];
};

template <bool kUsual>
HWY_INLINE void smooth_batch(FloatTag d, const GuidedSmoothRow& row, std::ptrdiff_t x, int first_tap,
                             SmoothSums& sums) {
  const std::ptrdiff_t* taps = row.taps + first_tap;
  FloatVec w[kTapBatch];
  guide_weights<kUsual>(d, row.guides, x, taps, w);
  FloatVec total = hn::Load(d, sums.weight);
  for (int t = 0; t < kTapBatch; ++t) {
    w[t] = hn::Mul(w[t], hn::Set(d, row.spatial[first_tap + t]));
    total = hn::Add(total, w[t]);
  }
  hn::Store(total, d, sums.weight);
  for (int m = 0; m < row.maps; ++m) {
    const float* HWY_RESTRICT map = row.map[m] + x;
    FloatVec sum = hn::Load(d, sums.map[m]);
    for (int t = 0; t < kTapBatch; ++t) sum = hn::MulAdd(w[t], hn::LoadU(d, map + taps[t]), sum);
    hn::Store(sum, d, sums.map[m]);
  }
}

HWY_INLINE void finish_smooth(FloatTag d, const GuidedSmoothRow& row, std::ptrdiff_t x, const SmoothSums& sums) {
  const FloatVec one = hn::Set(d, 1.0F);
  const FloatVec weight = hn::Load(d, sums.weight);
  const auto has_weight = hn::Gt(weight, hn::Zero(d));
  const FloatVec inverse = hn::Div(one, hn::IfThenElse(has_weight, weight, one));
  for (int m = 0; m < row.maps; ++m) {
    const FloatVec mean = hn::Mul(hn::Load(d, sums.map[m]), inverse);
    hn::StoreU(hn::IfThenElse(has_weight, mean, hn::LoadU(d, row.map[m] + x)), d, row.result[m] + x);
  }
}

template <bool kUsual>
HWY_INLINE void smooth_row(const GuidedSmoothRow& row) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  SmoothSums sums;
  for (std::ptrdiff_t x = 0; x < row.count; x += lanes) {
    hn::Store(hn::Zero(d), d, sums.weight);
    for (int m = 0; m < row.maps; ++m) hn::Store(hn::Zero(d), d, sums.map[m]);
    for (int tap = 0; tap < row.tap_count; tap += kTapBatch) smooth_batch<kUsual>(d, row, x, tap, sums);
    finish_smooth(d, row, x, sums);
  }
}

void GuidedSmoothRowTarget(const GuidedSmoothRow& row) {
  if (is_usual(row.guides)) {
    smooth_row<true>(row);
  } else {
    smooth_row<false>(row);
  }
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::kernels {

HWY_EXPORT(GuidedSmoothRowTarget);

void guided_smooth_row(const GuidedSmoothRow& row) { HWY_DYNAMIC_DISPATCH(GuidedSmoothRowTarget)(row); }

}  // namespace stein::kernels
#endif  // HWY_ONCE
