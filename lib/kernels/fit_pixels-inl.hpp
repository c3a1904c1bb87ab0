// SPDX-License-Identifier: Apache-2.0
//
// What a local polynomial fit sees of a vector of pixels and a batch of their neighbours, and where it keeps its sums.
// Compiled once per instruction set.
#if defined(STEIN_KERNELS_FIT_PIXELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef STEIN_KERNELS_FIT_PIXELS_INL
#undef STEIN_KERNELS_FIT_PIXELS_INL
#else
#define STEIN_KERNELS_FIT_PIXELS_INL
#endif

#include <hwy/highway.h>

#include <cmath>

#include "kernels/layer_sums-inl.hpp"
#include "kernels/local_polynomial.hpp"
#include "kernels/normal_equations-inl.hpp"
#include "kernels/patch_distance-inl.hpp"
#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

// One vector of pixels.
struct FitPixels {
  std::ptrdiff_t x = 0;                       // the first one, its row included
  const float* HWY_RESTRICT basis = nullptr;  // see feature_basis
  int dimensions = 0;                         // of position and features
  float* HWY_RESTRICT sums = nullptr;         // [range sigma] normal equations
  float* HWY_RESTRICT fits = nullptr;         // [range sigma] see fit_floats
  LayerSums layers;                           // of the equivalent kernel and the differences to the pixel's own
  [[nodiscard]] int columns(int order) const { return 1 + order * dimensions; }
};

// A group of neighbours.
struct TapGroup {
  int first = 0;
  int count = 0;           // a multiple of kTapBatch
  TapDistances distances;  // of the first tap and pixel
};

HWY_INLINE int highest_order(const LocalPolynomialRows& rows) { return rows.order[rows.orders - 1]; }
HWY_INLINE int fitted_order(const LocalPolynomialRows& rows) { return highest_order(rows) + (rows.is_taylor ? 2 : 0); }

// Partial polynomials, AOS Eq. 7; powers are scaled by the root of their second moment for normal variates.
HWY_INLINE void fill_columns(FloatTag d, const LocalPolynomialRows& rows, const FitPixels& pixels, int tap, int order,
                             TapBatch& batch) {
  std::ptrdiff_t at[kTapBatch];
  for (int t = 0; t < kTapBatch; ++t) {
    at[t] = pixels.x + rows.weights.taps[tap + t];
    batch.column[0][t] = hn::Set(d, 1.0F);
    for (int c = 0; c < 3; ++c) {
      batch.colour[c][t] =
          hn::Sub(hn::LoadU(d, rows.weights.colour[c] + at[t]), hn::LoadU(d, rows.weights.colour[c] + pixels.x));
    }
  }
  if (order == 0) return;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const int directions = pixels.dimensions - 2;
  for (int t = 0; t < kTapBatch; ++t) {
    batch.column[1][t] = hn::Set(d, rows.position[0][tap + t]);
    batch.column[2][t] = hn::Set(d, rows.position[1][tap + t]);
    for (int r = 0; r < directions; ++r) batch.column[3 + r][t] = hn::Zero(d);
  }
  for (int k = 0; k < rows.features && directions > 0; ++k) {
    const FloatVec own = hn::LoadU(d, rows.feature[k] + pixels.x);
    FloatVec e[kTapBatch];
    for (int t = 0; t < kTapBatch; ++t) e[t] = hn::Sub(hn::LoadU(d, rows.feature[k] + at[t]), own);
    for (int r = 0; r < directions; ++r) {
      const FloatVec b = hn::Load(d, pixels.basis + (r * rows.features + k) * lanes);
      for (int t = 0; t < kTapBatch; ++t) batch.column[3 + r][t] = hn::MulAdd(b, e[t], batch.column[3 + r][t]);
    }
  }
  for (int power = 2; power <= order; ++power) {
    const FloatVec scale = hn::Set(d, 1.0F / std::sqrt(static_cast<float>(2 * power - 1)));
    const int last = 1 + (power - 2) * pixels.dimensions;
    for (int k = 0; k < pixels.dimensions; ++k) {
      for (int t = 0; t < kTapBatch; ++t) {
        batch.column[last + pixels.dimensions + k][t] =
            hn::Mul(hn::Mul(scale, batch.column[last + k][t]), batch.column[1 + k][t]);
      }
    }
  }
}

// The weights of a range sigma; false if all of them are 0, and hence all of smaller ones.
HWY_INLINE bool weights_of(FloatTag d, const LocalPolynomialRows& rows, int sigma, int tap,
                           const float* HWY_RESTRICT distance, FloatVec (&w)[kTapBatch]) {
  const FloatVec exponent = hn::Set(d, rows.weights.exponent[sigma]);
  FloatVec total = hn::Zero(d);
  for (int t = 0; t < kTapBatch; ++t) {
    const FloatVec p = hn::Load(d, distance + t * static_cast<std::ptrdiff_t>(kNlmBlockPixels));
    w[t] = exp2_negative(d, hn::MulAdd(exponent, p, hn::Set(d, rows.spatial[tap + t])));
    total = hn::Add(total, w[t]);
  }
  return !hn::AllTrue(d, hn::Eq(total, hn::Zero(d)));
}

HWY_INLINE std::ptrdiff_t sums_step(FloatTag d, const LocalPolynomialRows& rows) {
  return normal_equation_sums(most_columns(highest_order(rows), rows.is_taylor)) *
         static_cast<std::ptrdiff_t>(hn::Lanes(d));
}

HWY_INLINE std::ptrdiff_t fits_step(FloatTag d, const LocalPolynomialRows& rows) {
  return fit_floats(most_columns(highest_order(rows), rows.is_taylor), rows.orders) *
         static_cast<std::ptrdiff_t>(hn::Lanes(d));
}

// Where a range sigma's fit of one order lies: its solution, and behind it the sums of the second look at the window.
HWY_INLINE float* fit_of(FloatTag d, const LocalPolynomialRows& rows, const FitPixels& pixels, int sigma, int order) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const int most = most_columns(highest_order(rows), rows.is_taylor);
  return pixels.fits + sigma * fits_step(d, rows) + order * (kSolutionParts * most + 6) * lanes;
}

HWY_INLINE float* moments_of(FloatTag d, const LocalPolynomialRows& rows, const FitPixels& pixels, int sigma,
                             int order) {
  const int most = most_columns(highest_order(rows), rows.is_taylor);
  return fit_of(d, rows, pixels, sigma, order) + kSolutionParts * most * static_cast<std::ptrdiff_t>(hn::Lanes(d));
}

// The features' part of Joint SURE Eq. 2: where the fit is read moves with the pixel's features, and so does the
// pixel's row of X; the window's basis does not, and neither do the weights.
HWY_INLINE FloatVec feature_term(FloatTag d, const LocalPolynomialRows& rows, const FitPixels& pixels, int c,
                                 FloatVec own, int columns, const float* HWY_RESTRICT fit) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const float* HWY_RESTRICT beta = fit + (1 + c) * columns * lanes;
  const FloatVec away = hn::NegMulAdd(own, hn::Load(d, fit), hn::Set(d, 1.0F));  // 1 - l_c
  const FloatVec rest = hn::Neg(hn::Mul(own, hn::Load(d, beta)));                // w_c (y_c - F)
  FloatVec sum = hn::Zero(d);
  for (int r = 0; r < pixels.dimensions - 2; ++r) {
    FloatVec moved = hn::Zero(d);
    for (int k = 0; k < rows.features; ++k) {
      moved = hn::MulAdd(hn::Load(d, pixels.basis + (r * rows.features + k) * lanes),
                         hn::LoadU(d, rows.feature_covariance[c][k] + pixels.x), moved);
    }
    const FloatVec slope =
        hn::MulAdd(rest, hn::Load(d, fit + (3 + r) * lanes), hn::Mul(away, hn::Load(d, beta + (3 + r) * lanes)));
    sum = hn::MulAdd(slope, moved, sum);
  }
  return sum;
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
