// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
// Joint SURE: Li, "Joint Stein's Unbiased Risk Estimation for Adaptive Sampling and Reconstruction", 2017.
#include "kernels/cross_bilateral.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/cross_bilateral.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

// Sums of one scale and one block of pixels: weights w, w x_c for each colour channel, and where guides move with the
// colour's noise also w s_c and w s_c x_c with the slopes s_c. They live in L1 between batches of taps: a batch costs
// many times what loading and storing them does.
template <bool kJoint>
inline constexpr int kSumCount = kJoint ? 10 : 4;

template <bool kJoint>
struct Sums {
  alignas(64) float sum[kMaxScales][kSumCount<kJoint>][kMaxLanes];
};

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

template <bool kJoint, bool kUsual>
HWY_INLINE void add_batch(FloatTag d, const CrossBilateralRow& row, std::ptrdiff_t x, int batch, Sums<kJoint>& sums) {
  const std::ptrdiff_t* taps = row.taps + batch * kTapBatch;
  FloatVec v[kSumCount<kJoint>][kTapBatch];
  FloatVec slope[3][kTapBatch];
  if constexpr (kJoint) {
    guide_weights_and_slopes<kUsual>(d, row.guides, row.guides, row.covariance, x, taps, v[0], slope);
  } else {
    guide_weights<kUsual>(d, row.guides, row.guides, x, taps, v[0]);
  }
  for (int c = 0; c < 3; ++c) {
    for (int t = 0; t < kTapBatch; ++t) {
      v[1 + c][t] = hn::Mul(v[0][t], hn::LoadU(d, row.colour[c] + x + taps[t]));
      if constexpr (kJoint) {
        v[4 + c][t] = hn::Mul(v[0][t], slope[c][t]);
        v[7 + c][t] = hn::Mul(v[1 + c][t], slope[c][t]);
      }
    }
  }
  const float* spatial = row.spatial + batch * row.scales * kTapBatch;
  for (int s = row.first_scale[batch]; s < row.scales; ++s) {
    accumulate<kSumCount<kJoint>>(d, sums.sum[s], spatial + s * kTapBatch, v);
  }
}

template <bool kJoint>
HWY_INLINE void finish_block(FloatTag d, const CrossBilateralRow& row, std::ptrdiff_t x, const Sums<kJoint>& sums) {
  const FloatVec one = hn::Set(d, 1.0F);
  for (int s = 0; s < row.scales; ++s) {
    const FloatVec weight = hn::Load(d, sums.sum[s][0]);
    const auto has_weight = hn::Gt(weight, hn::Zero(d));
    const FloatVec inverse = hn::IfThenElseZero(has_weight, hn::Div(one, hn::IfThenElse(has_weight, weight, one)));
    for (int c = 0; c < 3; ++c) {
      const FloatVec mean = hn::Mul(hn::Load(d, sums.sum[s][1 + c]), inverse);
      FloatVec divergence = hn::LoadU(d, row.variance[c] + x);  // of the pixel's own term in Eq. 5: w_ii = 1
      if constexpr (kJoint) {                                   // dw_j = -w_j s_j, so this adds sum_j dw_j (x_j - F)
        const FloatVec slopes = hn::Load(d, sums.sum[s][4 + c]);
        const FloatVec colour_slopes = hn::Load(d, sums.sum[s][7 + c]);
        divergence = hn::Add(divergence, hn::MulSub(mean, slopes, colour_slopes));
      }
      hn::StoreU(hn::IfThenElse(has_weight, mean, hn::LoadU(d, row.colour[c] + x)), d, row.result[s][c] + x);
      hn::StoreU(hn::Mul(divergence, inverse), d, row.divergence[s][c] + x);
    }
  }
}

template <bool kJoint, bool kUsual>
HWY_INLINE void run_block(FloatTag d, const CrossBilateralRow& row, std::ptrdiff_t x) {
  Sums<kJoint> sums;
  for (int s = 0; s < row.scales; ++s) {
    for (int i = 0; i < kSumCount<kJoint>; ++i) hn::Store(hn::Zero(d), d, sums.sum[s][i]);
  }
  for (int batch = 0; batch < row.tap_count / kTapBatch; ++batch) add_batch<kJoint, kUsual>(d, row, x, batch, sums);
  finish_block<kJoint>(d, row, x, sums);
}

HWY_INLINE bool covariance_is_zero(FloatTag d, const CrossBilateralRow& row, std::ptrdiff_t x) {
  const int channels = row.guides.groups > 0 ? row.guides.group_end[row.guides.groups - 1] : 0;
  FloatVec any = hn::Zero(d);
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < channels; ++k) any = hn::Or(any, hn::LoadU(d, row.covariance[c][k] + x));
  }
  return hn::AllTrue(d, hn::Eq(any, hn::Zero(d)));
}

template <bool kUsual>
HWY_INLINE void run_row(const CrossBilateralRow& row) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (std::ptrdiff_t x = 0; x < row.count; x += lanes) {
    if (row.has_covariance && !covariance_is_zero(d, row, x)) {
      run_block<true, kUsual>(d, row, x);
    } else {
      run_block<false, kUsual>(d, row, x);
    }
  }
}

void CrossBilateralRowTarget(const CrossBilateralRow& row) {
  if (is_usual(row.guides)) {
    run_row<true>(row);
  } else {
    run_row<false>(row);
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
