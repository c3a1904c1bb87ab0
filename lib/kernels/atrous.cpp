// SPDX-License-Identifier: Apache-2.0
//
// SURE-À-Trous: Kim, Moon, Yoon, "SURE-based À-Trous Wavelet Filter for Interactive Monte Carlo Rendering", 2016.
#include "kernels/atrous.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/atrous.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

constexpr float kSpline[kAtrousTaps] = {1.0F / 16, 4.0F / 16, 6.0F / 16, 4.0F / 16, 1.0F / 16};
constexpr float kTiny = 1e-30F;  // noise and energies are at least this where they divide

struct AtrousSums {
  FloatVec weight;
  FloatVec colour[3];  // w c
  FloatVec noise;      // w n
  FloatVec noise2;     // w^2 n
  FloatVec energy;     // w |c_p - c_q|^2
};

struct AtrousCentre {
  FloatVec colour[3];
  FloatVec noise;
  FloatVec value_factor;
};

HWY_INLINE FloatVec distance2(const FloatVec (&a)[3], const FloatVec (&b)[3]) {
  const FloatVec e0 = hn::Sub(a[0], b[0]), e1 = hn::Sub(a[1], b[1]), e2 = hn::Sub(a[2], b[2]);
  return hn::MulAdd(e0, e0, hn::MulAdd(e1, e1, hn::Mul(e2, e2)));
}

template <bool kUsual>
HWY_INLINE void add_taps(FloatTag d, const AtrousRow& row, const AtrousCentre& centre, std::ptrdiff_t x, int r,
                         AtrousSums& sums) {
  const std::ptrdiff_t step = row.step;
  const std::ptrdiff_t at[kAtrousTaps] = {x - 2 * step, x - step, x, x + step, x + 2 * step};
  FloatVec distance[kAtrousTaps];
  guide_distances<kUsual>(d, row.centre, row.around[r], x, at, distance);
  for (int t = 0; t < kAtrousTaps; ++t) {
    const FloatVec colour[3] = {hn::LoadU(d, row.colour[r][0] + at[t]), hn::LoadU(d, row.colour[r][1] + at[t]),
                                hn::LoadU(d, row.colour[r][2] + at[t])};
    const FloatVec noise = hn::LoadU(d, row.noise[r] + at[t]);
    const FloatVec energy = hn::Min(distance2(centre.colour, colour), hn::Set(d, 1e30F));
    const FloatVec pair = hn::Max(hn::Add(centre.noise, hn::Min(centre.noise, noise)), hn::Set(d, kTiny));
    const FloatVec value = hn::Mul(energy, hn::Mul(centre.value_factor, reciprocal(d, pair)));
    const FloatVec spline = hn::Mul(hn::LoadU(d, row.around[r].mask + at[t]), hn::Set(d, row.spline[r] * kSpline[t]));
    const FloatVec w = hn::Mul(exp2_negative(d, hn::Add(distance[t], value)), spline);
    const FloatVec w_noise = hn::Mul(w, noise);
    sums.weight = hn::Add(sums.weight, w);
    for (int c = 0; c < 3; ++c) sums.colour[c] = hn::MulAdd(w, colour[c], sums.colour[c]);
    sums.noise = hn::Add(sums.noise, w_noise);
    sums.noise2 = hn::MulAdd(w, w_noise, sums.noise2);
    sums.energy = hn::MulAdd(w, energy, sums.energy);
  }
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

HWY_INLINE void finish_pixels(FloatTag d, const AtrousRow& row, const AtrousCentre& centre, std::ptrdiff_t x,
                              const AtrousSums& sums) {
  const FloatVec one = hn::Set(d, 1.0F);
  const auto has_weight = hn::Gt(sums.weight, hn::Zero(d));
  const FloatVec inverse = hn::IfThenElseZero(has_weight, hn::Div(one, hn::IfThenElse(has_weight, sums.weight, one)));
  FloatVec mean[3];
  for (int c = 0; c < 3; ++c) {
    mean[c] = hn::IfThenElse(has_weight, hn::Mul(sums.colour[c], inverse), centre.colour[c]);
  }
  // Were the taps' noise independent, that of their mean would be `independent`; were it the same, `common`.
  const FloatVec common = hn::Mul(sums.noise, inverse);
  const FloatVec independent = hn::Mul(hn::Mul(sums.noise2, inverse), inverse);
  const FloatVec spread = hn::Max(hn::Sub(common, independent), hn::Zero(d));
  const FloatVec noise_of_detail = hn::Mul(spread, hn::Set(d, 1.0F - row.correlation));
  const FloatVec energy = hn::Sub(hn::Mul(sums.energy, inverse), distance2(centre.colour, mean));
  const FloatVec w = detail_weight(d, row, x, energy, noise_of_detail);
  for (int c = 0; c < 3; ++c) {
    FloatVec sum = row.is_first ? hn::Zero(d) : hn::LoadU(d, row.result[c] + x);
    sum = hn::MulAdd(w, hn::Sub(centre.colour[c], mean[c]), sum);
    hn::StoreU(row.is_last ? hn::Add(sum, mean[c]) : sum, d, row.result[c] + x);
    if (!row.is_last) hn::StoreU(mean[c], d, row.next_colour[c] + x);
  }
  if (row.is_last) return;
  const FloatVec noise = hn::MulAdd(spread, hn::Set(d, row.correlation), independent);
  hn::StoreU(hn::IfThenElse(has_weight, noise, centre.noise), d, row.next_noise + x);
}

template <bool kUsual>
HWY_INLINE void atrous_pixels(const AtrousRow& row) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (std::ptrdiff_t x = 0; x < row.count; x += lanes) {
    AtrousCentre centre;
    for (int c = 0; c < 3; ++c) centre.colour[c] = hn::LoadU(d, row.centre_colour[c] + x);
    centre.noise = hn::LoadU(d, row.centre_noise + x);
    centre.value_factor = hn::Mul(hn::Set(d, row.value_factor), hn::LoadU(d, row.centre.mask + x));
    AtrousSums sums;
    sums.weight = sums.noise = sums.noise2 = sums.energy = hn::Zero(d);
    sums.colour[0] = sums.colour[1] = sums.colour[2] = hn::Zero(d);
    for (int r = 0; r < row.rows; ++r) add_taps<kUsual>(d, row, centre, x, r, sums);
    finish_pixels(d, row, centre, x, sums);
  }
}

void AtrousRowTarget(const AtrousRow& row) {
  if (is_usual(row.centre)) {
    atrous_pixels<true>(row);
  } else {
    atrous_pixels<false>(row);
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
