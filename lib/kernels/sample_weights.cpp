// SPDX-License-Identifier: Apache-2.0
//
// RPF: Sen, Darabi, "On Filtering the Noise from the Random Parameters in Monte Carlo Rendering", 2012.
#include "kernels/sample_weights.hpp"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/sample_weights.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

constexpr int kOwnBlock = 4;  // samples of the pixel whose sums are in registers at a time

HWY_INLINE int padded(int count) { return (count + kSampleBlock - 1) / kSampleBlock * kSampleBlock; }

int KeepTarget(const float* const* records, int count, const float* low, const float* high, int columns,
               std::int32_t* kept) {
  const FloatTag d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int found = 0;
  for (int i = 0; i < count; ++i) {
    auto outside = hn::Lt(hn::Zero(d), hn::Zero(d));
    for (int k = 0; k < columns; k += lanes) {
      const FloatVec x = hn::LoadU(d, records[i] + k);
      outside = hn::Or(outside, hn::Lt(x, hn::LoadU(d, low + k)));
      outside = hn::Or(outside, hn::Gt(x, hn::LoadU(d, high + k)));
    }
    kept[found] = i;
    found += hn::AllFalse(d, outside) ? 1 : 0;
  }
  return found;
}

void GatherTarget(const float* const* records, const std::int32_t* kept, int count, int columns, float* planes,
                  std::ptrdiff_t pitch) {
  const FloatTag d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  alignas(64) float block[kRecordGroup * kMaxLanes];
  for (int first = 0; first < padded(count); first += lanes) {
    const float* record[kMaxLanes];
    for (int i = 0; i < lanes; ++i) record[i] = records[kept[first + i < count ? first + i : 0]];
    for (int k = 0; k < columns; k += kRecordGroup) {
      for (int i = 0; i < lanes; ++i)
        __builtin_memcpy(block + i * kRecordGroup, record[i] + k, sizeof(float) * kRecordGroup);
      FloatVec a, b, c, e;
      hn::LoadInterleaved4(d, block, a, b, c, e);
      float* out = planes + k * pitch + first;
      hn::Store(a, d, out);
      hn::Store(b, d, out + pitch);
      hn::Store(c, d, out + 2 * pitch);
      hn::Store(e, d, out + 3 * pitch);
    }
  }
}

// What pads a plane up to whole vectors is one of its values: it does not matter to the least and the largest.
PlaneMoments MomentsTarget(const float* plane, int count) {
  const FloatTag d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  FloatVec sum = hn::Zero(d);
  FloatVec least = hn::Load(d, plane);
  FloatVec largest = least;
  for (int i = 0; i < count; i += lanes) {
    const FloatVec x = hn::Load(d, plane + i);
    sum = hn::Add(sum, hn::IfThenElseZero(hn::FirstN(d, static_cast<std::size_t>(count - i)), x));
    least = hn::Min(least, x);
    largest = hn::Max(largest, x);
  }
  PlaneMoments moments;
  moments.least = hn::GetLane(hn::MinOfLanes(d, least));
  moments.largest = hn::GetLane(hn::MaxOfLanes(d, largest));
  moments.mean = hn::GetLane(hn::SumOfLanes(d, sum)) / static_cast<float>(count);
  if (!(moments.largest > moments.least)) return moments;
  const FloatVec mean = hn::Set(d, moments.mean);
  FloatVec squares = hn::Zero(d);
  for (int i = 0; i < count; i += lanes) {
    const auto valid = hn::FirstN(d, static_cast<std::size_t>(count - i));
    const FloatVec e = hn::IfThenElseZero(valid, hn::Sub(hn::Load(d, plane + i), mean));
    squares = hn::MulAdd(e, e, squares);
  }
  const float variance = hn::GetLane(hn::SumOfLanes(d, squares)) / static_cast<float>(count);
  constexpr float kLeastVariance = 1e-36F;  // the inverse stays finite
  if (variance > kLeastVariance) moments.inverse_deviation = 1.0F / std::sqrt(variance);
  return moments;
}

int CodesTarget(const float* plane, const PlaneMoments& moments, int count, std::uint8_t* codes) {
  const FloatTag d;
  const hn::Rebind<std::int32_t, FloatTag> di;
  const hn::Rebind<std::uint8_t, FloatTag> du8;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const FloatVec least = hn::Set(d, moments.least);
  const FloatVec scale = hn::Set(d, moments.inverse_deviation);
  const FloatVec half = hn::Set(d, 0.5F);
  const FloatVec most = hn::Set(d, static_cast<float>(kMostSampleCode));
  for (int i = 0; i < padded(count); i += lanes) {
    const FloatVec x = hn::Mul(hn::Sub(hn::Load(d, plane + i), least), scale);
    const auto code = hn::ConvertTo(di, hn::Add(hn::Min(x, most), half));
    hn::StoreU(hn::DemoteTo(du8, code), du8, codes + i);
  }
  for (int i = count; i < padded(count); ++i) codes[i] = 255;
  const float range = (moments.largest - moments.least) * moments.inverse_deviation;
  return static_cast<int>((range < static_cast<float>(kMostSampleCode) ? range : kMostSampleCode) + 0.5F) + 1;
}

void ScaleTarget(const float* in, float mean, float scale, int count, float* out) {
  const FloatTag d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < padded(count); i += lanes) {
    hn::Store(hn::Mul(hn::Sub(hn::Load(d, in + i), hn::Set(d, mean)), hn::Set(d, scale)), d, out + i);
  }
}

HWY_INLINE void distances(FloatTag d, const SampleWeights& s, const int (&own)[kOwnBlock], int j,
                          FloatVec (&distance)[kOwnBlock]) {
  for (FloatVec& v : distance) v = hn::Zero(d);
  for (int k = 0; k < s.planes; ++k) {
    const float* HWY_RESTRICT plane = s.scaled[k];
    const FloatVec x = hn::Load(d, plane + j);
    for (int i = 0; i < kOwnBlock; ++i) {
      const FloatVec e = hn::Sub(x, hn::Set(d, plane[own[i]]));
      distance[i] = hn::MulAdd(e, e, distance[i]);
    }
  }
}

// Up to kOwnBlock of the pixel's samples; where there are fewer the last one is worked on again.
HWY_INLINE void weighted_block(FloatTag d, const SampleWeights& s, int first, float* result) {
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int own[kOwnBlock];
  FloatVec sum[4][kOwnBlock];
  for (int i = 0; i < kOwnBlock; ++i) {
    own[i] = first + i < s.own ? first + i : s.own - 1;
    sum[0][i] = sum[1][i] = sum[2][i] = sum[3][i] = hn::Zero(d);
  }
  for (int j = 0; j < s.count; j += lanes) {
    FloatVec distance[kOwnBlock];
    distances(d, s, own, j, distance);
    const auto valid = hn::FirstN(d, static_cast<std::size_t>(s.count - j));
    for (int i = 0; i < kOwnBlock; ++i) {
      const FloatVec w = hn::IfThenElseZero(valid, exp2_negative(d, distance[i]));
      sum[3][i] = hn::Add(sum[3][i], w);
      for (int c = 0; c < 3; ++c) sum[c][i] = hn::MulAdd(w, hn::Load(d, s.colour[c] + j), sum[c][i]);
    }
  }
  for (int i = 0; i < kOwnBlock && first + i < s.own; ++i) {
    const float weight = hn::GetLane(hn::SumOfLanes(d, sum[3][i]));  // at least 1: that of the sample itself
    for (int c = 0; c < 3; ++c) result[3 * (first + i) + c] = hn::GetLane(hn::SumOfLanes(d, sum[c][i])) / weight;
  }
}

void WeightedTarget(const SampleWeights& samples, float* result) {
  for (int first = 0; first < samples.own; first += kOwnBlock) weighted_block(FloatTag(), samples, first, result);
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::kernels {

HWY_EXPORT(KeepTarget);
HWY_EXPORT(GatherTarget);
HWY_EXPORT(MomentsTarget);
HWY_EXPORT(CodesTarget);
HWY_EXPORT(ScaleTarget);
HWY_EXPORT(WeightedTarget);

int keep_similar_samples(const float* const* records, int count, const float* low, const float* high, int columns,
                         std::int32_t* kept) {
  return HWY_DYNAMIC_DISPATCH(KeepTarget)(records, count, low, high, columns, kept);
}

void gather_samples(const float* const* records, const std::int32_t* kept, int count, int columns, float* planes,
                    std::ptrdiff_t pitch) {
  HWY_DYNAMIC_DISPATCH(GatherTarget)(records, kept, count, columns, planes, pitch);
}

PlaneMoments sample_moments(const float* plane, int count) { return HWY_DYNAMIC_DISPATCH(MomentsTarget)(plane, count); }

int sample_codes(const float* plane, const PlaneMoments& moments, int count, std::uint8_t* codes) {
  return HWY_DYNAMIC_DISPATCH(CodesTarget)(plane, moments, count, codes);
}

void scale_samples(const float* in, float mean, float scale, int count, float* out) {
  HWY_DYNAMIC_DISPATCH(ScaleTarget)(in, mean, scale, count, out);
}

void weighted_samples(const SampleWeights& samples, float* result) {
  HWY_DYNAMIC_DISPATCH(WeightedTarget)(samples, result);
}

}  // namespace stein::kernels
#endif  // HWY_ONCE
