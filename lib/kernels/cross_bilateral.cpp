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

HWY_INLINE FloatVec sum4(const FloatVec (&v)[kTapBatch]) { return hn::Add(hn::Add(v[0], v[1]), hn::Add(v[2], v[3])); }

HWY_INLINE FloatVec dot4(const FloatVec (&w)[kTapBatch], const FloatVec (&v)[kTapBatch]) {
  return hn::MulAdd(w[3], v[3], hn::MulAdd(w[2], v[2], hn::MulAdd(w[1], v[1], hn::Mul(w[0], v[0]))));
}

HWY_INLINE void load_taps(FloatTag d, const float* HWY_RESTRICT plane, std::ptrdiff_t x, const std::ptrdiff_t* taps,
                          FloatVec (&v)[kTapBatch]) {
  for (int t = 0; t < kTapBatch; ++t) v[t] = hn::LoadU(d, plane + x + taps[t]);
}

// The layers' sums of a block of pixels: [scale][channel][kMaxLanes].
HWY_INLINE float* layer_sum(const CrossBilateralRow& row, int scale, int channel) {
  return row.layers.scratch + (scale * row.layers.count + channel) * static_cast<std::ptrdiff_t>(kMaxLanes);
}

HWY_INLINE void add_layers(FloatTag d, const CrossBilateralRow& row, std::ptrdiff_t x, int batch,
                           const FloatVec (&w)[kTapBatch]) {
  const int first = row.first_scale[batch];
  const int scales = row.scales - first;
  const int count = row.layers.count;
  const std::ptrdiff_t step = count * static_cast<std::ptrdiff_t>(kMaxLanes);
  const std::ptrdiff_t* HWY_RESTRICT taps = row.taps + batch * kTapBatch;
  const float* HWY_RESTRICT spatial = row.spatial + batch * row.scales + first;
  const float* const* HWY_RESTRICT values = row.layers.value;
  float* HWY_RESTRICT sums = layer_sum(row, first, 0);
  for (int k = 0; k < count; ++k, sums += kMaxLanes) {
    FloatVec v[kTapBatch];
    load_taps(d, values[k], x, taps, v);
    const FloatVec part = dot4(w, v);
    for (int s = 0; s < scales; ++s)
      hn::Store(hn::MulAdd(hn::Set(d, spatial[s]), part, hn::Load(d, sums + s * step)), d, sums + s * step);
  }
}

// Taps of a batch are summed first: a scale has one factor for all of them.
template <bool kJoint, bool kUsual>
HWY_INLINE void add_batch(FloatTag d, const CrossBilateralRow& row, std::ptrdiff_t x, int batch, Sums<kJoint>& sums) {
  const std::ptrdiff_t* taps = row.taps + batch * kTapBatch;
  FloatVec w[kTapBatch];
  FloatVec slope[3][kTapBatch];
  if constexpr (kJoint) {
    guide_weights_and_slopes<kUsual>(d, row.centre, row.guides, row.covariance, x, taps, w, slope);
  } else {
    guide_weights<kUsual>(d, row.centre, row.guides, x, taps, w);
  }
  FloatVec part[kSumCount<kJoint>];
  part[0] = sum4(w);
  for (int c = 0; c < 3; ++c) {
    FloatVec colour[kTapBatch];
    load_taps(d, row.colour[c], x, taps, colour);
    part[1 + c] = dot4(w, colour);
    if constexpr (kJoint) {
      FloatVec weighted[kTapBatch];
      for (int t = 0; t < kTapBatch; ++t) weighted[t] = hn::Mul(w[t], slope[c][t]);
      part[4 + c] = sum4(weighted);
      part[7 + c] = dot4(weighted, colour);
    }
  }
  const float* HWY_RESTRICT spatial = row.spatial + batch * row.scales;
  for (int s = row.first_scale[batch]; s < row.scales; ++s) {
    const FloatVec factor = hn::Set(d, spatial[s]);
    for (int i = 0; i < kSumCount<kJoint>; ++i)
      hn::Store(hn::MulAdd(factor, part[i], hn::Load(d, sums.sum[s][i])), d, sums.sum[s][i]);
  }
  add_layers(d, row, x, batch, w);
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
    for (int k = 0; k < row.layers.count; ++k) {
      const FloatVec mean = hn::Mul(hn::Load(d, layer_sum(row, s, k)), inverse);
      const FloatVec own = hn::LoadU(d, row.layers.value[k] + x);
      hn::StoreU(hn::IfThenElse(has_weight, mean, own), d, row.layers.result[s * row.layers.count + k] + x);
    }
  }
}

template <bool kJoint, bool kUsual>
HWY_INLINE void run_block(FloatTag d, const CrossBilateralRow& row, std::ptrdiff_t x) {
  Sums<kJoint> sums;
  for (int s = 0; s < row.scales; ++s) {
    for (int i = 0; i < kSumCount<kJoint>; ++i) hn::Store(hn::Zero(d), d, sums.sum[s][i]);
    for (int k = 0; k < row.layers.count; ++k) hn::Store(hn::Zero(d), d, layer_sum(row, s, k));
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
