// SPDX-License-Identifier: Apache-2.0
//
// SURE-À-Trous: Kim, Moon, Yoon, "SURE-based À-Trous Wavelet Filter for Interactive Monte Carlo Rendering", 2016.
#include "kernels/atrous.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/atrous.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

constexpr float kSpline[kAtrousTaps] = {1.0F / 16, 4.0F / 16, 6.0F / 16, 4.0F / 16, 1.0F / 16};
constexpr float kTiny = 1e-30F;  // noise and energies are at least this where they divide

// Sums over the taps of a few pixels. They live in L1 while one row of taps after the other is added: with all rows at
// once there would be more streams than the first level of the TLB has entries.
struct AtrousSums {
  enum Index { kWeight, kColour, kNoise = kColour + 3, kNoise2, kEnergy, kCount };
  alignas(64) float sum[kCount][kAtrousPixels];  // w, w c, w n, w^2 n, w |c_p - c_q|^2
};

struct AtrousCentre {
  FloatVec colour[3];
  FloatVec noise;
};

HWY_INLINE AtrousCentre load_centre(FloatTag d, const AtrousRow& row, std::ptrdiff_t x) {
  return {{hn::LoadU(d, row.centre_colour[0] + x), hn::LoadU(d, row.centre_colour[1] + x),
           hn::LoadU(d, row.centre_colour[2] + x)},
          hn::LoadU(d, row.centre_noise + x)};
}

HWY_INLINE FloatVec distance2(const FloatVec (&a)[3], const FloatVec (&b)[3]) {
  const FloatVec e0 = hn::Sub(a[0], b[0]), e1 = hn::Sub(a[1], b[1]), e2 = hn::Sub(a[2], b[2]);
  return hn::MulAdd(e0, e0, hn::MulAdd(e1, e1, hn::Mul(e2, e2)));
}

// The layers' sums of w c: [channel][kAtrousPixels].
HWY_INLINE float* layer_sum(const AtrousRow& row, int channel, std::ptrdiff_t i) {
  return row.layers.scratch + channel * std::ptrdiff_t{kAtrousPixels} + i;
}

HWY_INLINE void add_layers(FloatTag d, const AtrousRow& row, int r, const std::ptrdiff_t (&at)[kAtrousTaps],
                           const FloatVec (&w)[kAtrousTaps], std::ptrdiff_t i) {
  const int count = row.layers.count;
  const float* const* HWY_RESTRICT values = row.layers.value + r * count;
  float* HWY_RESTRICT to = layer_sum(row, 0, i);
  for (int k = 0; k < count; ++k, to += kAtrousPixels) {
    const float* HWY_RESTRICT value = values[k];
    FloatVec sum = hn::Load(d, to);
    for (int t = 0; t < kAtrousTaps; ++t) sum = hn::MulAdd(w[t], hn::LoadU(d, value + at[t]), sum);
    hn::Store(sum, d, to);
  }
}

template <bool kUsual, bool kLayers>
HWY_INLINE void add_taps(FloatTag d, const AtrousRow& row, std::ptrdiff_t x, int r, AtrousSums& sums,
                         std::ptrdiff_t i) {
  const AtrousCentre centre = load_centre(d, row, x);
  const FloatVec value_factor = hn::Mul(hn::Set(d, row.value_factor), hn::LoadU(d, row.centre.mask + x));
  const std::ptrdiff_t step = row.step;
  const std::ptrdiff_t at[kAtrousTaps] = {x - 2 * step, x - step, x, x + step, x + 2 * step};
  FloatVec distance[kAtrousTaps];
  guide_distances<kUsual>(d, row.centre, row.around[r], x, at, distance);
  FloatVec v[AtrousSums::kCount];
  for (int k = 0; k < AtrousSums::kCount; ++k) v[k] = hn::Load(d, sums.sum[k] + i);
  [[maybe_unused]] FloatVec weights[kAtrousTaps];
  for (int t = 0; t < kAtrousTaps; ++t) {
    const FloatVec colour[3] = {hn::LoadU(d, row.colour[r][0] + at[t]), hn::LoadU(d, row.colour[r][1] + at[t]),
                                hn::LoadU(d, row.colour[r][2] + at[t])};
    const FloatVec noise = hn::LoadU(d, row.noise[r] + at[t]);
    const FloatVec energy = hn::Min(distance2(centre.colour, colour), hn::Set(d, 1e30F));
    const FloatVec pair = hn::Max(hn::Add(centre.noise, hn::Min(centre.noise, noise)), hn::Set(d, kTiny));
    const FloatVec value = hn::Mul(energy, hn::Mul(value_factor, reciprocal(d, pair)));
    const FloatVec spline = hn::Mul(hn::LoadU(d, row.around[r].mask + at[t]), hn::Set(d, row.spline[r] * kSpline[t]));
    const FloatVec w = hn::Mul(exp2_negative(d, hn::Add(distance[t], value)), spline);
    if constexpr (kLayers) weights[t] = w;
    const FloatVec w_noise = hn::Mul(w, noise);
    v[AtrousSums::kWeight] = hn::Add(v[AtrousSums::kWeight], w);
    for (int c = 0; c < 3; ++c) v[AtrousSums::kColour + c] = hn::MulAdd(w, colour[c], v[AtrousSums::kColour + c]);
    v[AtrousSums::kNoise] = hn::Add(v[AtrousSums::kNoise], w_noise);
    v[AtrousSums::kNoise2] = hn::MulAdd(w, w_noise, v[AtrousSums::kNoise2]);
    v[AtrousSums::kEnergy] = hn::MulAdd(w, energy, v[AtrousSums::kEnergy]);
  }
  for (int k = 0; k < AtrousSums::kCount; ++k) hn::Store(v[k], d, sums.sum[k] + i);
  if constexpr (kLayers) add_layers(d, row, r, at, weights, i);
}

// The weight of the detail whose energy and noise, means over the taps, are given. SURE of w times the detail is, up to
// a constant, (1 - w)^2 energy + 2 w noise.
HWY_INLINE FloatVec detail_weight(FloatTag d, const AtrousRow& row, std::ptrdiff_t x, FloatVec energy, FloatVec noise) {
  const FloatVec mask = hn::LoadU(d, row.centre.mask + x);
  if (row.fixed_weight >= 0.0F) return hn::Mul(mask, hn::Set(d, row.fixed_weight));
  const FloatVec one = hn::Set(d, 1.0F);
  const FloatVec ratio = hn::Div(hn::Mul(noise, hn::Set(d, row.margin)), hn::Max(energy, hn::Set(d, kTiny)));
  FloatVec w = hn::Max(hn::Sub(one, ratio), hn::Zero(d));
  if (row.weight_steps > 0) {
    const auto steps = static_cast<float>(row.weight_steps);
    w = hn::Mul(hn::Round(hn::Mul(w, hn::Set(d, steps))), hn::Set(d, 1.0F / steps));
  }
  return hn::Mul(mask, w);
}

// As finish_pixels does for the colour.
HWY_INLINE void finish_layers(FloatTag d, const AtrousRow& row, std::ptrdiff_t x, FloatVec total_weight,
                              FloatVec detail_weight, std::ptrdiff_t i) {
  const int count = row.layers.count;
  const FloatVec one = hn::Set(d, 1.0F);
  const auto has_weight = hn::Gt(total_weight, hn::Zero(d));
  const FloatVec inverse = hn::IfThenElseZero(has_weight, hn::Div(one, hn::IfThenElse(has_weight, total_weight, one)));
  for (int k = 0; k < count; ++k) {
    const FloatVec centre = hn::LoadU(d, row.layers.value[kAtrousTaps * count + k] + x);
    const FloatVec mean = hn::IfThenElse(has_weight, hn::Mul(hn::Load(d, layer_sum(row, k, i)), inverse), centre);
    float* result = row.layers.result[k] + x;
    FloatVec total = row.is_first ? hn::Zero(d) : hn::LoadU(d, result);
    total = hn::MulAdd(detail_weight, hn::Sub(centre, mean), total);
    hn::StoreU(row.is_last ? hn::Add(total, mean) : total, d, result);
    if (row.next_colour[0] != nullptr) hn::StoreU(mean, d, row.layers.result[count + k] + x);
  }
}

template <bool kLayers>
HWY_INLINE void finish_pixels(FloatTag d, const AtrousRow& row, std::ptrdiff_t x, const AtrousSums& sums,
                              std::ptrdiff_t i) {
  const AtrousCentre centre = load_centre(d, row, x);
  const auto sum_of = [&](int k) { return hn::Load(d, sums.sum[k] + i); };
  const FloatVec weight = sum_of(AtrousSums::kWeight);
  const FloatVec one = hn::Set(d, 1.0F);
  const auto has_weight = hn::Gt(weight, hn::Zero(d));
  const FloatVec inverse = hn::IfThenElseZero(has_weight, hn::Div(one, hn::IfThenElse(has_weight, weight, one)));
  FloatVec mean[3];
  for (int c = 0; c < 3; ++c) {
    mean[c] = hn::IfThenElse(has_weight, hn::Mul(sum_of(AtrousSums::kColour + c), inverse), centre.colour[c]);
  }
  // Were the taps' noise independent, that of their mean would be `independent`; were it the same, `common`.
  const FloatVec common = hn::Mul(sum_of(AtrousSums::kNoise), inverse);
  const FloatVec independent = hn::Mul(hn::Mul(sum_of(AtrousSums::kNoise2), inverse), inverse);
  const FloatVec spread = hn::Max(hn::Sub(common, independent), hn::Zero(d));
  const FloatVec noise_of_detail = hn::Mul(spread, hn::Set(d, 1.0F - row.correlation));
  const FloatVec energy = hn::Sub(hn::Mul(sum_of(AtrousSums::kEnergy), inverse), distance2(centre.colour, mean));
  const FloatVec w = detail_weight(d, row, x, energy, noise_of_detail);
  for (int c = 0; c < 3; ++c) {
    FloatVec total = row.is_first ? hn::Zero(d) : hn::LoadU(d, row.result[c] + x);
    total = hn::MulAdd(w, hn::Sub(centre.colour[c], mean[c]), total);
    hn::StoreU(row.is_last ? hn::Add(total, mean[c]) : total, d, row.result[c] + x);
    if (row.next_colour[c] != nullptr) hn::StoreU(mean[c], d, row.next_colour[c] + x);
  }
  if constexpr (kLayers) finish_layers(d, row, x, weight, w, i);
  if (row.is_last) return;
  const FloatVec noise = hn::MulAdd(spread, hn::Set(d, row.correlation), independent);
  hn::StoreU(hn::IfThenElse(has_weight, noise, centre.noise), d, row.next_noise + x);
}

template <bool kUsual, bool kLayers>
HWY_INLINE void atrous_pixels(const AtrousRow& row) {
  const FloatTag d;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  AtrousSums sums;
  for (std::ptrdiff_t start = 0; start < row.count; start += kAtrousPixels) {
    const std::ptrdiff_t count = HWY_MIN(row.count - start, std::ptrdiff_t{kAtrousPixels});
    for (auto& sum : sums.sum) {
      for (float& value : sum) value = 0.0F;
    }
    if constexpr (kLayers) std::fill_n(row.layers.scratch, atrous_layer_scratch(row.layers.count), 0.0F);
    for (int r = 0; r < row.rows; ++r) {
      for (std::ptrdiff_t i = 0; i < count; i += lanes) add_taps<kUsual, kLayers>(d, row, start + i, r, sums, i);
    }
    for (std::ptrdiff_t i = 0; i < count; i += lanes) finish_pixels<kLayers>(d, row, start + i, sums, i);
  }
}

void AtrousRowTarget(const AtrousRow& row) {
  if (row.layers.count > 0) {
    is_usual(row.centre) ? atrous_pixels<true, true>(row) : atrous_pixels<false, true>(row);
  } else {
    is_usual(row.centre) ? atrous_pixels<true, false>(row) : atrous_pixels<false, false>(row);
  }
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::kernels {

HWY_EXPORT(AtrousRowTarget);

void atrous_row(const AtrousRow& row) { HWY_DYNAMIC_DISPATCH(AtrousRowTarget)(row); }

}  // namespace stein::kernels
#endif  // HWY_ONCE
