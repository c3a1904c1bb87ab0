// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
#include "kernels/cross_bilateral.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/cross_bilateral.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

// Sums of one scale and one block of pixels: weights, weighted colours and, with a range term, weighted squares.
// They live in L1 between batches of taps: a batch costs many times what loading and storing them does.
template <int kSums>
struct Sums {
  alignas(64) float sum[kMaxScales][kSums][kMaxLanes];
};

template <bool kRange>
inline constexpr int kSumCount = kRange ? 7 : 4;

HWY_INLINE FloatVec dot4(FloatVec sum, FloatVec c0, FloatVec c1, FloatVec c2, FloatVec c3, FloatVec v0, FloatVec v1,
                         FloatVec v2, FloatVec v3) {
  return hn::MulAdd(c0, v0, hn::MulAdd(c1, v1, hn::MulAdd(c2, v2, hn::MulAdd(c3, v3, sum))));
}

template <int kSums>
HWY_INLINE void accumulate(FloatTag d, float (*HWY_RESTRICT sum)[kMaxLanes], const float* HWY_RESTRICT spatial,
                           const FloatVec (&v)[kSums][kTapBatch]) {
  const FloatVec c0 = hn::Set(d, spatial[0]), c1 = hn::Set(d, spatial[1]);
  const FloatVec c2 = hn::Set(d, spatial[2]), c3 = hn::Set(d, spatial[3]);
  for (int i = 0; i < kSums; ++i) {
    hn::Store(dot4(hn::Load(d, sum[i]), c0, c1, c2, c3, v[i][0], v[i][1], v[i][2], v[i][3]), d, sum[i]);
  }
}

template <bool kRange, bool kUsual>
HWY_INLINE void add_batch(FloatTag d, const CrossBilateralRow& row, std::ptrdiff_t x, int batch,
                          Sums<kSumCount<kRange>>& sums) {
  const std::ptrdiff_t* taps = row.taps + batch * kTapBatch;
  FloatVec v[kSumCount<kRange>][kTapBatch];
  guide_weights<kUsual>(d, row.guides, row.guides, x, taps, v[0]);
  for (int c = 0; c < 3; ++c) {
    for (int t = 0; t < kTapBatch; ++t) {
      const FloatVec colour = hn::LoadU(d, row.colour[c] + x + taps[t]);
      v[1 + c][t] = hn::Mul(v[0][t], colour);
      if constexpr (kRange) v[4 + c][t] = hn::Mul(v[1 + c][t], colour);
    }
  }
  const float* spatial = row.spatial + batch * row.scales * kTapBatch;
  for (int s = row.first_scale[batch]; s < row.scales; ++s) {
    accumulate<kSumCount<kRange>>(d, sums.sum[s], spatial + s * kTapBatch, v);
  }
}

template <bool kRange>
HWY_INLINE void finish_block(FloatTag d, const CrossBilateralRow& row, std::ptrdiff_t x,
                             const Sums<kSumCount<kRange>>& sums) {
  const FloatVec one = hn::Set(d, 1.0F);
  for (int s = 0; s < row.scales; ++s) {
    const FloatVec weight = hn::Load(d, sums.sum[s][0]);
    const auto has_weight = hn::Gt(weight, hn::Zero(d));
    const FloatVec inverse = hn::IfThenElseZero(has_weight, hn::Div(one, hn::IfThenElse(has_weight, weight, one)));
    for (int c = 0; c < 3; ++c) {
      const FloatVec mean = hn::Mul(hn::Load(d, sums.sum[s][1 + c]), inverse);
      FloatVec derivative = inverse;
      if constexpr (kRange) {  // Eq. 7 = 13: 1/W + (F2 - F^2) / sigma_r^2
        const FloatVec mean_of_squares = hn::Mul(hn::Load(d, sums.sum[s][4 + c]), inverse);
        const FloatVec spread = hn::NegMulAdd(mean, mean, mean_of_squares);
        derivative = hn::MulAdd(spread, hn::Set(d, row.inverse_range_variance), derivative);
      }
      hn::StoreU(hn::IfThenElse(has_weight, mean, hn::LoadU(d, row.colour[c] + x)), d, row.result[s][c] + x);
      hn::StoreU(hn::Mul(derivative, hn::LoadU(d, row.variance[c] + x)), d, row.divergence[s][c] + x);
    }
  }
}

template <bool kRange, bool kUsual>
HWY_INLINE void run_row(const CrossBilateralRow& row) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  Sums<kSumCount<kRange>> sums;
  for (std::ptrdiff_t x = 0; x < row.count; x += lanes) {
    for (int s = 0; s < row.scales; ++s) {
      for (int i = 0; i < kSumCount<kRange>; ++i) hn::Store(hn::Zero(d), d, sums.sum[s][i]);
    }
    for (int batch = 0; batch < row.tap_count / kTapBatch; ++batch) add_batch<kRange, kUsual>(d, row, x, batch, sums);
    finish_block<kRange>(d, row, x, sums);
  }
}

void CrossBilateralRowTarget(const CrossBilateralRow& row) {
  if (row.inverse_range_variance > 0) {
    run_row<true, false>(row);
  } else if (is_usual(row.guides)) {
    run_row<false, true>(row);
  } else {
    run_row<false, false>(row);
  }
}

const char* InstructionSetTarget() { return hwy::TargetName(HWY_TARGET); }

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::kernels {

HWY_EXPORT(CrossBilateralRowTarget);
HWY_EXPORT(InstructionSetTarget);

void cross_bilateral_row(const CrossBilateralRow& row) { HWY_DYNAMIC_DISPATCH(CrossBilateralRowTarget)(row); }

const char* instruction_set() noexcept { return HWY_DYNAMIC_DISPATCH(InstructionSetTarget)(); }

}  // namespace stein::kernels
#endif  // HWY_ONCE
