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
HWY_INLINE void smooth_window_row(FloatTag d, const GuidedSmoothRow& row, std::ptrdiff_t x, int r, SmoothSums& sums) {
  const std::ptrdiff_t step = row.step;
  const std::ptrdiff_t offsets[kWindow] = {-2 * step, -step, 0, step, 2 * step};
  FloatVec w[kWindow];
  guide_weights<kUsual>(d, row.centre, row.around[r], x, offsets, w);
  FloatVec total = hn::Load(d, sums.weight);
  for (int t = 0; t < kWindow; ++t) {
    w[t] = hn::Mul(w[t], hn::Set(d, row.spatial[r][t]));
    total = hn::Add(total, w[t]);
  }
  hn::Store(total, d, sums.weight);
  for (int m = 0; m < row.maps; ++m) {
    const float* HWY_RESTRICT map = row.map[r][m] + x;
    FloatVec sum = hn::Load(d, sums.map[m]);
    for (int t = 0; t < kWindow; ++t) sum = hn::MulAdd(w[t], hn::LoadU(d, map + offsets[t]), sum);
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
    hn::StoreU(hn::IfThenElse(has_weight, mean, hn::LoadU(d, row.centre_map[m] + x)), d, row.result[m] + x);
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
    for (int r = 0; r < row.rows; ++r) smooth_window_row<kUsual>(d, row, x, r, sums);
    finish_smooth(d, row, x, sums);
  }
}

void GuidedSmoothRowTarget(const GuidedSmoothRow& row) {
  if (is_usual(row.centre)) {
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
