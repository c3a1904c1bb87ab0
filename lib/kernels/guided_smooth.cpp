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
  alignas(64) float squared_weight[kMaxLanes];
  alignas(64) float inverse_count[kMaxLanes];
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
  if (row.inverse_count_result != nullptr) {
    const float* HWY_RESTRICT count = row.inverse_count[r] + x;
    FloatVec squared = hn::Load(d, sums.squared_weight);
    FloatVec counts = hn::Load(d, sums.inverse_count);
    for (int t = 0; t < kWindow; ++t) {
      const FloatVec w2 = hn::Mul(w[t], w[t]);
      squared = hn::Add(squared, w2);
      counts = hn::MulAdd(w2, hn::LoadU(d, count + offsets[t]), counts);
    }
    hn::Store(squared, d, sums.squared_weight);
    hn::Store(counts, d, sums.inverse_count);
  }
  for (int m = 0; m < row.maps; ++m) {
    const float* HWY_RESTRICT map = row.map[r][m] + x;
    FloatVec sum = hn::Load(d, sums.map[m]);
    for (int t = 0; t < kWindow; ++t) sum = hn::MulAdd(w[t], hn::LoadU(d, map + offsets[t]), sum);
    hn::Store(sum, d, sums.map[m]);
  }
}

template <class Mask>
HWY_INLINE void finish_count(FloatTag d, const GuidedSmoothRow& row, std::ptrdiff_t x, const SmoothSums& sums,
                             Mask has_weight, FloatVec inverse) {
  const FloatVec one = hn::Set(d, 1.0F);
  const FloatVec weight = hn::Load(d, sums.weight);
  const FloatVec squared = hn::IfThenElse(has_weight, hn::Load(d, sums.squared_weight), one);
  const FloatVec taps = hn::Div(hn::Mul(weight, weight), squared);  // effective number, 1 to 25
  const FloatVec per_tap = hn::Set(d, (row.overlap - 1.0F) / (kWindow * kWindow - 1));
  const FloatVec overlap = hn::MulAdd(per_tap, hn::Sub(taps, one), one);
  const FloatVec variance = hn::Mul(hn::Mul(inverse, inverse), hn::Load(d, sums.inverse_count));
  const FloatVec result =
      hn::IfThenElse(has_weight, hn::Mul(overlap, variance), hn::LoadU(d, row.centre_inverse_count + x));
  hn::StoreU(result, d, row.inverse_count_result + x);
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
  if (row.inverse_count_result != nullptr) finish_count(d, row, x, sums, has_weight, inverse);
}

template <bool kUsual>
HWY_INLINE void smooth_row(const GuidedSmoothRow& row) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  SmoothSums sums;
  for (std::ptrdiff_t x = 0; x < row.count; x += lanes) {
    hn::Store(hn::Zero(d), d, sums.weight);
    hn::Store(hn::Zero(d), d, sums.squared_weight);
    hn::Store(hn::Zero(d), d, sums.inverse_count);
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
