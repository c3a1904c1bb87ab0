// SPDX-License-Identifier: Apache-2.0
//
// Weights of a batch of neighbours from their guides; shared by the kernels. Compiled once per instruction set.
#if defined(STEIN_KERNELS_WEIGHTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef STEIN_KERNELS_WEIGHTS_INL
#undef STEIN_KERNELS_WEIGHTS_INL
#else
#define STEIN_KERNELS_WEIGHTS_INL
#endif

#include <hwy/highway.h>

#include "kernels/guides.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, kMaxLanes>;
using FloatVec = hn::Vec<FloatTag>;

// Lane type: float32. Valid range: [1e-30, 1e37]. Max error: 2 ulp.
HWY_INLINE FloatVec reciprocal(FloatTag d, FloatVec v) {
  constexpr int kSteps = HWY_ARCH_ARM ? 2 : 1;  // of Newton: the estimates have 8 bits or 11 to 14
  FloatVec r = hn::ApproximateReciprocal(v);
  for (int step = 0; step < kSteps; ++step) r = hn::Mul(r, hn::NegMulAdd(v, r, hn::Set(d, 2.0F)));
  return r;
}

// What exp2_negative() gives is at least this, or 0.
inline constexpr float kLeastWeight = 0x1.6a09e6p-60F;  // 2^-59.5

// 2^-x. Lane type: float32. Valid range: [0, inf). Max relative error: 3e-7 up to 59; exactly 1 at 0 and exactly 0
// from 59.5 on.
HWY_INLINE FloatVec exp2_negative(FloatTag d, FloatVec x) {
  const hn::RebindToUnsigned<FloatTag> du;
  constexpr float kCutOff = 60.0F;
  // Adding kMagic leaves the nearest integer, plus kCutOff, in the low bits of the mantissa. Shifted into the exponent
  // that is 2^(i - 67), and 0 for i = -60; the polynomial carries the missing 2^67. So no denormal arises on the way.
  const FloatVec kMagic = hn::Set(d, 0x1.8p23F + kCutOff);
  const FloatVec t = hn::Max(hn::Neg(x), hn::Set(d, -kCutOff));
  const FloatVec shifted = hn::Add(t, kMagic);
  const FloatVec scale = hn::BitCast(d, hn::ShiftLeft<23>(hn::BitCast(du, shifted)));
  const FloatVec f = hn::Sub(t, hn::Sub(shifted, kMagic));  // in [-0.5, 0.5]
  // Minimax fit of 2^f on [-0.5, 0.5], relative error 9.2e-8, with the value at 0 held at 1.
  FloatVec p = hn::Set(d, 0x1p67F * 1.32647273e-3F);
  p = hn::MulAdd(p, f, hn::Set(d, 0x1p67F * 9.67151271e-3F));
  p = hn::MulAdd(p, f, hn::Set(d, 0x1p67F * 5.55073374e-2F));
  p = hn::MulAdd(p, f, hn::Set(d, 0x1p67F * 2.40222421e-1F));
  p = hn::MulAdd(p, f, hn::Set(d, 0x1p67F * 6.93146978e-1F));
  p = hn::MulAdd(p, f, hn::Set(d, 0x1p67F));
  return hn::Mul(p, scale);
}

// Distances to a batch of neighbours: num / den, so that groups share one division.
template <int kTaps>
struct Distances {
  // Written out: the one that GCC makes is not of the instruction set, and cannot call those of NEON's vectors.
  HWY_INLINE Distances() {}  // NOLINT(modernize-use-equals-default)
  FloatVec num[kTaps];
  FloatVec den[kTaps];
};

// Adds the group's |a - b|^2 / max(va + vb, min_variance) to the distances; kFirst: there is nothing to add to yet.
template <bool kFirst, int kTaps>
HWY_INLINE void add_group(FloatTag d, const Guides& centre, const Guides& around, int group, int first_channel,
                          int end_channel, std::ptrdiff_t x, const std::ptrdiff_t (&at)[kTaps],
                          Distances<kTaps>& distances) {
  FloatVec s[kTaps];
  for (FloatVec& sum : s) sum = hn::Zero(d);
  for (int k = first_channel; k < end_channel; ++k) {
    const float* HWY_RESTRICT f = around.channel[k];
    const FloatVec a = hn::LoadU(d, centre.channel[k] + x);
    for (int t = 0; t < kTaps; ++t) {
      const FloatVec e = hn::Sub(a, hn::LoadU(d, f + at[t]));
      s[t] = hn::MulAdd(e, e, s[t]);
    }
  }
  const float* HWY_RESTRICT variance = around.variance[group];
  const FloatVec va = hn::LoadU(d, centre.variance[group] + x);
  const FloatVec min_variance = hn::Set(d, centre.min_variance);
  for (int t = 0; t < kTaps; ++t) {
    const FloatVec v = hn::Max(hn::Add(va, hn::LoadU(d, variance + at[t])), min_variance);
    distances.num[t] = kFirst ? s[t] : hn::MulAdd(s[t], distances.den[t], hn::Mul(distances.num[t], v));
    distances.den[t] = kFirst ? v : hn::Mul(distances.den[t], v);
  }
}

// Distances d between the pixel x of `centre` and the pixels at[t] of `around`, without masks. kUsual: see is_usual().
template <bool kUsual, int kTaps>
HWY_INLINE void guide_distances(FloatTag d, const Guides& centre, const Guides& around, std::ptrdiff_t x,
                                const std::ptrdiff_t (&at)[kTaps], FloatVec (&distance)[kTaps]) {
  for (FloatVec& v : distance) v = hn::Zero(d);
  Distances<kTaps> part;
  if constexpr (kUsual) {
    add_group<true>(d, centre, around, 0, 0, 3, x, at, part);
    add_group<false>(d, centre, around, 1, 3, 6, x, at, part);
    add_group<false>(d, centre, around, 2, 6, 7, x, at, part);
    for (int t = 0; t < kTaps; ++t) distance[t] = hn::Mul(part.num[t], reciprocal(d, part.den[t]));
  } else {
    int channel = 0;
    for (int g = 0; g < centre.groups; ++g) {  // one division per group: products of many denominators could overflow
      add_group<true>(d, centre, around, g, channel, centre.group_end[g], x, at, part);
      channel = centre.group_end[g];
      for (int t = 0; t < kTaps; ++t) {
        distance[t] = hn::MulAdd(part.num[t], reciprocal(d, part.den[t]), distance[t]);
      }
    }
  }
  const FloatVec scale = hn::Set(d, centre.distance_scale);
  for (FloatVec& v : distance) v = hn::Mul(v, scale);
}

// w[t] = mask * 2^-d between the pixel x of `centre` and the pixels x + offsets[t] of `around`.
template <bool kUsual, int kTaps>
HWY_INLINE void guide_weights(FloatTag d, const Guides& centre, const Guides& around, std::ptrdiff_t x,
                              const std::ptrdiff_t* offsets, FloatVec (&w)[kTaps]) {
  std::ptrdiff_t at[kTaps];
  for (int t = 0; t < kTaps; ++t) at[t] = x + offsets[t];
  FloatVec distance[kTaps];
  guide_distances<kUsual>(d, centre, around, x, at, distance);
  for (int t = 0; t < kTaps; ++t) {
    w[t] = hn::Mul(exp2_negative(d, distance[t]), hn::LoadU(d, around.mask + at[t]));
  }
}

// Adds the group's distance, and for each colour channel c the slope sum_k covariance[c][k] (a_k - b_k) / V.
template <int kTaps>
HWY_INLINE void add_group_with_slopes(FloatTag d, const Guides& centre, const Guides& around,
                                      const float* const (&covariance)[3][kMaxGuideChannels], int group,
                                      int first_channel, int end_channel, std::ptrdiff_t x,
                                      const std::ptrdiff_t (&at)[kTaps], FloatVec (&distance)[kTaps],
                                      FloatVec (&slope)[3][kTaps]) {
  FloatVec s[kTaps];
  FloatVec q[3][kTaps];
  for (int t = 0; t < kTaps; ++t) s[t] = q[0][t] = q[1][t] = q[2][t] = hn::Zero(d);
  for (int k = first_channel; k < end_channel; ++k) {
    const float* HWY_RESTRICT f = around.channel[k];
    const FloatVec a = hn::LoadU(d, centre.channel[k] + x);
    const FloatVec c0 = hn::LoadU(d, covariance[0][k] + x);
    const FloatVec c1 = hn::LoadU(d, covariance[1][k] + x);
    const FloatVec c2 = hn::LoadU(d, covariance[2][k] + x);
    for (int t = 0; t < kTaps; ++t) {
      const FloatVec e = hn::Sub(a, hn::LoadU(d, f + at[t]));
      s[t] = hn::MulAdd(e, e, s[t]);
      q[0][t] = hn::MulAdd(c0, e, q[0][t]);
      q[1][t] = hn::MulAdd(c1, e, q[1][t]);
      q[2][t] = hn::MulAdd(c2, e, q[2][t]);
    }
  }
  const float* HWY_RESTRICT variance = around.variance[group];
  const FloatVec va = hn::LoadU(d, centre.variance[group] + x);
  const FloatVec min_variance = hn::Set(d, centre.min_variance);
  for (int t = 0; t < kTaps; ++t) {
    const FloatVec r = reciprocal(d, hn::Max(hn::Add(va, hn::LoadU(d, variance + at[t])), min_variance));
    distance[t] = hn::MulAdd(s[t], r, distance[t]);
    for (int c = 0; c < 3; ++c) slope[c][t] = hn::MulAdd(q[c][t], r, slope[c][t]);
  }
}

// Distances d to the pixels x + offsets[t], without masks, and for each colour channel minus the relative change of
// 2^-d with it: slope[c][t].
template <bool kUsual, int kTaps>
HWY_INLINE void guide_distances_and_slopes(FloatTag d, const Guides& centre, const Guides& around,
                                           const float* const (&covariance)[3][kMaxGuideChannels], std::ptrdiff_t x,
                                           const std::ptrdiff_t (&at)[kTaps], FloatVec (&distance)[kTaps],
                                           FloatVec (&slope)[3][kTaps]) {
  for (int t = 0; t < kTaps; ++t) distance[t] = slope[0][t] = slope[1][t] = slope[2][t] = hn::Zero(d);
  if constexpr (kUsual) {
    add_group_with_slopes(d, centre, around, covariance, 0, 0, 3, x, at, distance, slope);
    add_group_with_slopes(d, centre, around, covariance, 1, 3, 6, x, at, distance, slope);
    add_group_with_slopes(d, centre, around, covariance, 2, 6, 7, x, at, distance, slope);
  } else {
    for (int g = 0; g < centre.groups; ++g) {
      const int first_channel = g == 0 ? 0 : centre.group_end[g - 1];
      add_group_with_slopes(d, centre, around, covariance, g, first_channel, centre.group_end[g], x, at, distance,
                            slope);
    }
  }
  const FloatVec scale = hn::Set(d, centre.distance_scale);
  for (FloatVec& v : distance) v = hn::Mul(v, scale);
}

// guide_weights() and the slopes of guide_distances_and_slopes().
template <bool kUsual, int kTaps>
HWY_INLINE void guide_weights_and_slopes(FloatTag d, const Guides& centre, const Guides& around,
                                         const float* const (&covariance)[3][kMaxGuideChannels], std::ptrdiff_t x,
                                         const std::ptrdiff_t* offsets, FloatVec (&w)[kTaps],
                                         FloatVec (&slope)[3][kTaps]) {
  std::ptrdiff_t at[kTaps];
  for (int t = 0; t < kTaps; ++t) at[t] = x + offsets[t];
  FloatVec distance[kTaps];
  guide_distances_and_slopes<kUsual>(d, centre, around, covariance, x, at, distance, slope);
  for (int t = 0; t < kTaps; ++t) {
    w[t] = hn::Mul(exp2_negative(d, distance[t]), hn::LoadU(d, around.mask + at[t]));
  }
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
