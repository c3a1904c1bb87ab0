// SPDX-License-Identifier: Apache-2.0
//
// AOS: Yuan, Zheng, Zheng, Liu, "Adaptive Rendering based on Adaptive Order Selection", 2017.
// Joint SURE: Li, "Joint Stein's Unbiased Risk Estimation for Adaptive Sampling and Reconstruction", 2017.
//
// X, W, Y and beta are AOS's; X is centred at the pixel, so that its own row is e = (1, 0, ..., 0) and colours are
// differences to its own. g = (X^T W X + ridge)^-1 e gives the equivalent kernel l_i = w_i g^T x_i (Eq. 4).
#include "kernels/local_polynomial.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/local_polynomial.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/feature_basis-inl.hpp"
#include "kernels/fit_pixels-inl.hpp"
#include "kernels/normal_equations-inl.hpp"
#include "kernels/patch_block-inl.hpp"
#include "kernels/patch_distance-inl.hpp"
#include "kernels/weights-inl.hpp"
#include "kernels/window_moments-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

HWY_NOINLINE void add_group_to_equations(const LocalPolynomialRows& rows, const FitPixels& pixels,
                                         const TapGroup& group) {
  const FloatTag d;
  const int order = fitted_order(rows);
  TapBatch batch;
  const float* distance = group.distances.distance;
  for (int t = group.first; t < group.first + group.count; t += kTapBatch, distance += kTapBatch * kNlmBlockPixels) {
    FloatVec w[kTapBatch];
    int sigma = rows.weights.candidates - 1;
    if (!weights_of(d, rows, sigma, t, distance, w)) continue;
    fill_columns(d, rows, pixels, t, order, batch);
    do {
      add_normal_equations(d, batch, w, pixels.columns(order), pixels.sums + sigma * sums_step(d, rows));
    } while (--sigma >= 0 && weights_of(d, rows, sigma, t, distance, w));
  }
}

HWY_NOINLINE void solve_all(const LocalPolynomialRows& rows, const FitPixels& pixels, float* HWY_RESTRICT scratch) {
  const FloatTag d;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  Factor factor;
  factor.columns = pixels.columns(fitted_order(rows));
  factor.linear_columns = pixels.columns(1);
  factor.ridge = rows.ridge;
  factor.curvature_ridge = rows.curvature_ridge;
  factor.rows = scratch;
  factor.inverse = scratch + normal_equation_sums(kMaxColumns) * lanes;
  HWY_ALIGN float higher[kSolutionParts * kMaxColumns * kMaxLanes];
  for (int sigma = 0; sigma < rows.weights.candidates; ++sigma) {
    const float* sums = pixels.sums + sigma * sums_step(d, rows);
    factorise(d, sums, factor);
    for (int o = 0; o < rows.orders; ++o) {
      const int columns = pixels.columns(rows.order[o]);
      float* fit = fit_of(d, rows, pixels, sigma, o);
      float* moments = moments_of(d, rows, pixels, sigma, o);
      solve(d, factor, columns, fit);
      std::fill_n(moments, 6 * lanes, 0.0F);
      if (!rows.is_taylor) continue;
      const int higher_columns = pixels.columns(rows.order[o] + 2);
      solve(d, factor, higher_columns, higher);
      for (int c = 0; c < 3; ++c) {  // AOS Eq. 13, its first entry, is the difference of the two fits
        const FloatVec low = hn::Load(d, fit + (1 + c) * columns * lanes);
        hn::Store(hn::Sub(low, hn::Load(d, higher + (1 + c) * higher_columns * lanes)), d, moments + c * lanes);
      }
    }
  }
}

// The equivalent kernel l_i, AOS Eq. 4.
HWY_INLINE void kernel_of(FloatTag d, const TapBatch& batch, const FloatVec (&w)[kTapBatch], int columns,
                          const float* HWY_RESTRICT fit, FloatVec (&l)[kTapBatch]) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  for (int t = 0; t < kTapBatch; ++t) l[t] = hn::Load(d, fit);
  for (int a = 1; a < columns; ++a) {
    const FloatVec g = hn::Load(d, fit + a * lanes);
    for (int t = 0; t < kTapBatch; ++t) l[t] = hn::MulAdd(g, batch.column[a][t], l[t]);
  }
  for (int t = 0; t < kTapBatch; ++t) l[t] = hn::Mul(l[t], w[t]);
}

// Adds to what moves F with the weights: sum_i l_i (y_i - x_i^T beta) slope_i, or for Taylor to its variance, AOS
// Eq. 11. Leaves the equivalent kernel in l.
HWY_INLINE void add_moments(FloatTag d, const TapBatch& batch, const FloatVec (&w)[kTapBatch],
                            const FloatVec (&factor)[3][kTapBatch], bool is_taylor, int columns,
                            const float* HWY_RESTRICT fit, float* HWY_RESTRICT moments, FloatVec (&l)[kTapBatch]) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  FloatVec rest[3][kTapBatch];
  for (int t = 0; t < kTapBatch; ++t) {
    l[t] = hn::Load(d, fit);
    for (int c = 0; c < 3; ++c) rest[c][t] = hn::Sub(batch.colour[c][t], hn::Load(d, fit + (1 + c) * columns * lanes));
  }
  for (int a = 1; a < columns; ++a) {
    const FloatVec g = hn::Load(d, fit + a * lanes);
    for (int t = 0; t < kTapBatch; ++t) l[t] = hn::MulAdd(g, batch.column[a][t], l[t]);
    if (is_taylor) continue;
    for (int c = 0; c < 3; ++c) {
      const FloatVec beta = hn::Load(d, fit + ((1 + c) * columns + a) * lanes);
      for (int t = 0; t < kTapBatch; ++t) rest[c][t] = hn::NegMulAdd(beta, batch.column[a][t], rest[c][t]);
    }
  }
  for (int t = 0; t < kTapBatch; ++t) l[t] = hn::Mul(l[t], w[t]);
  for (int c = 0; c < 3; ++c) {
    FloatVec sum = hn::Load(d, moments + (is_taylor ? 3 + c : c) * lanes);
    for (int t = 0; t < kTapBatch; ++t) {
      sum = hn::MulAdd(hn::Mul(l[t], is_taylor ? l[t] : rest[c][t]), factor[c][t], sum);
    }
    hn::Store(sum, d, moments + (is_taylor ? 3 + c : c) * lanes);
  }
}

// What moves the fits with the pixel's own noise, or for Taylor the variances of the neighbours.
HWY_INLINE void load_factors(FloatTag d, const LocalPolynomialRows& rows, const FitPixels& pixels, int tap,
                             const TapDistances& from, FloatVec (&factor)[3][kTapBatch]) {
  if (!rows.is_taylor) {
    contracted_slopes(d, rows.weights, pixels.x, {from.slope[0], from.slope[1], from.slope[2]}, factor);
    return;
  }
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < kTapBatch; ++k) {
      factor[c][k] = hn::LoadU(d, rows.variance[c] + pixels.x + rows.weights.taps[tap + k]);
    }
  }
}

HWY_INLINE void load_layers(FloatTag d, const LocalPolynomialRows& rows, const FitPixels& pixels, int tap) {
  std::ptrdiff_t at[kTapBatch];
  for (int t = 0; t < kTapBatch; ++t) at[t] = pixels.x + rows.weights.taps[tap + t];
  pixels.layers.load<true>(d, pixels.x, at);
}

// The second look at the window, with the fits known: moments, if they are wanted, and layers.
HWY_NOINLINE void look_again(const LocalPolynomialRows& rows, const FitPixels& pixels, const TapGroup& group,
                             bool has_moments) {
  const FloatTag d;
  const int order = highest_order(rows);
  TapBatch batch;
  FloatVec factor[3][kTapBatch];
  for (int t = 0; t < group.count; t += kTapBatch) {
    const std::ptrdiff_t at = t * static_cast<std::ptrdiff_t>(kNlmBlockPixels);
    const int tap = group.first + t;
    const TapDistances& all = group.distances;
    FloatVec w[kTapBatch];
    int sigma = rows.weights.candidates - 1;
    if (!weights_of(d, rows, sigma, tap, all.distance + at, w)) continue;
    fill_columns(d, rows, pixels, tap, order, batch);
    if (has_moments) {
      load_factors(d, rows, pixels, tap, {all.distance, {all.slope[0] + at, all.slope[1] + at, all.slope[2] + at}},
                   factor);
    }
    if (rows.layers.count > 0) load_layers(d, rows, pixels, tap);
    do {
      for (int o = 0; o < rows.orders; ++o) {
        const int columns = pixels.columns(rows.order[o]);
        const float* fit = fit_of(d, rows, pixels, sigma, o);
        FloatVec l[kTapBatch];
        if (has_moments) {
          add_moments(d, batch, w, factor, rows.is_taylor, columns, fit, moments_of(d, rows, pixels, sigma, o), l);
        } else {
          kernel_of(d, batch, w, columns, fit, l);
        }
        if (rows.layers.count > 0) pixels.layers.add(d, sigma * rows.orders + o, l);
      }
    } while (--sigma >= 0 && weights_of(d, rows, sigma, tap, all.distance + at, w));
  }
}

// D of one channel (Joint SURE Eq. 2), or its error AOS Eq. 16.
HWY_INLINE FloatVec divergence_of(FloatTag d, const LocalPolynomialRows& rows, const FitPixels& pixels, int sigma,
                                  int o, int c) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const float* fit = fit_of(d, rows, pixels, sigma, o);
  const float* moments = moments_of(d, rows, pixels, sigma, o);
  if (rows.is_taylor) {
    const FloatVec bias = hn::Load(d, moments + c * lanes);
    return hn::MulAdd(bias, bias, hn::Load(d, moments + (3 + c) * lanes));
  }
  const FloatVec own = hn::LoadU(d, rows.weights.guides.mask + pixels.x);  // the pixel's own weight
  const FloatVec kernel =
      hn::Mul(hn::Mul(own, hn::Load(d, fit)), hn::LoadU(d, rows.weights.colour_covariance[c] + pixels.x));
  const FloatVec divergence =
      hn::NegMulAdd(hn::Set(d, rows.weights.slope[sigma]), hn::Load(d, moments + c * lanes), kernel);
  if (!rows.has_feature_covariance || rows.order[o] == 0) return divergence;
  return hn::Add(divergence, feature_term(d, rows, pixels, c, own, pixels.columns(rows.order[o]), fit));
}

// fitted / summed where these differ by rounding alone; 1 where they are so near to 0 that the ratio says nothing.
HWY_INLINE FloatVec rounding_factor(FloatTag d, FloatVec fitted, FloatVec summed) {
  const FloatVec one = hn::Set(d, 1.0F);
  const FloatVec ratio = hn::Div(fitted, hn::IfThenElse(hn::Eq(summed, hn::Zero(d)), one, summed));
  const auto is_near = hn::Le(hn::Abs(hn::Sub(ratio, one)), hn::Set(d, 1e-2F));
  return hn::IfThenElse(is_near, ratio, one);
}

HWY_INLINE void finish_candidate(FloatTag d, const LocalPolynomialRows& rows, const FitPixels& pixels, int sigma, int o,
                                 int y, std::ptrdiff_t x) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const float* fit = fit_of(d, rows, pixels, sigma, o);
  const int columns = pixels.columns(rows.order[o]);
  const int candidate = sigma * rows.orders + o;
  FloatVec colour[3];
  FloatVec result[3];
  FloatVec divergence[3];
  auto is_finite = hn::Eq(hn::Zero(d), hn::Zero(d));
  for (int c = 0; c < 3; ++c) {
    colour[c] = hn::LoadU(d, rows.weights.colour[c] + pixels.x);
    result[c] = hn::Add(colour[c], hn::Load(d, fit + (1 + c) * columns * lanes));
    divergence[c] = divergence_of(d, rows, pixels, sigma, o, c);
    is_finite = hn::And(is_finite, hn::And(hn::IsFinite(result[c]), hn::IsFinite(divergence[c])));
  }
  // Colours near the largest float can overflow: such pixels stay as they are.
  for (int c = 0; c < 3; ++c) {
    const FloatVec variance = hn::LoadU(d, rows.weights.colour_covariance[c] + pixels.x);
    hn::StoreU(hn::IfThenElse(is_finite, result[c], colour[c]), d, rows.weights.result[y][candidate][c] + x);
    hn::StoreU(hn::IfThenElse(is_finite, divergence[c], variance), d, rows.weights.divergence[y][candidate][c] + x);
  }
  if (rows.layers.count == 0) return;
  const int layers = rows.layers.count - kLayerColours;
  FloatVec factor[3];
  for (int c = 0; c < 3; ++c) {
    const FloatVec summed = hn::Add(colour[c], hn::Load(d, pixels.layers.sum(candidate, layers + c)));
    factor[c] = rounding_factor(d, result[c], summed);
  }
  for (int k = 0; k < layers; ++k) {
    const int c = rows.layer_colour[k];
    const FloatVec own = hn::LoadU(d, rows.layers.value[k] + pixels.x);
    const FloatVec sum = hn::Add(own, hn::Load(d, pixels.layers.sum(candidate, k)));
    const FloatVec scaled = c < 0 ? sum : hn::Mul(sum, factor[c]);
    const int target = (y * rows.weights.candidates * rows.orders + candidate) * layers + k;
    hn::StoreU(hn::IfThenElse(is_finite, scaled, own), d, rows.layers.result[target] + x);
  }
}

HWY_INLINE void finish(FloatTag d, const LocalPolynomialRows& rows, const FitPixels& pixels, int y, std::ptrdiff_t x) {
  for (int sigma = 0; sigma < rows.weights.candidates; ++sigma) {
    for (int o = 0; o < rows.orders; ++o) finish_candidate(d, rows, pixels, sigma, o, y, x);
  }
}

// Without colour weights neighbours are sources or not.
HWY_INLINE void fill_mask_distances(FloatTag d, const PatchBlock& block, int first, int count, const TapDistances& to) {
  const CrossNlmRows& rows = block.rows;
  for (int t = 0; t < count; ++t) {
    for (int y = 0; y < rows.rows; ++y) {
      for (int k = 0; k < block.width; k += static_cast<int>(hn::Lanes(d))) {
        const std::ptrdiff_t at = t * static_cast<std::ptrdiff_t>(kNlmBlockPixels) + kNlmBlockWidth * y + k;
        FloatVec distance = hn::Set(d, kNoNeighbour);
        if (first + t < rows.tap_count) {
          const FloatVec mask = hn::LoadU(d, rows.guides.mask + block.x + k + y * rows.pitch + rows.taps[first + t]);
          distance = hn::IfThenElseZero(hn::Eq(mask, hn::Zero(d)), distance);
        }
        hn::Store(distance, d, to.distance + at);
        for (float* slope : to.slope) hn::Store(hn::Zero(d), d, slope + at);
      }
    }
  }
}

// Calls visit(pixels, group) for every vector of pixels of the block and every group of taps.
template <class Visit>
HWY_INLINE void for_each_group(FloatTag d, const LocalPolynomialRows& rows, const PatchBlock& block,
                               const TapDistances& distances, FitPixels* pixels, Visit visit) {
  const int padded = (rows.weights.tap_count + kTapBatch - 1) / kTapBatch * kTapBatch;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int first = 0; first < padded; first += kNlmTapGroup) {
    TapGroup group{first, std::min(kNlmTapGroup, padded - first), {}};
    if (rows.has_colour_weights) {
      fill_distances(block, first, group.count, distances);
    } else {
      fill_mask_distances(d, block, first, group.count, distances);
    }
    const FitPixels* next = pixels;
    for (int y = 0; y < rows.weights.rows; ++y) {
      for (int k = 0; k < block.width; k += lanes) {
        const int at = kNlmBlockWidth * y + k;
        group.distances = {distances.distance + at,
                           {distances.slope[0] + at, distances.slope[1] + at, distances.slope[2] + at}};
        visit(*next++, group);
      }
    }
  }
}

HWY_INLINE WindowMoments take_moments(int features, Scratch& scratch) {
  const auto take = [&](int planes) { return scratch.take(kNlmBlockPixels * static_cast<std::size_t>(planes)); };
  return {take(features), take(features * (features + 1) / 2)};
}

// Lays out the block's pixels, vector by vector, and finds their directions; returns the number of vectors.
HWY_INLINE int set_pixels(FloatTag d, const LocalPolynomialRows& rows, const PatchBlock& block, Scratch& scratch,
                          FitPixels* pixels) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const int sigmas = rows.weights.candidates;
  const WindowMoments moments = take_moments(rows.features, scratch);
  if (rows.features > 0) fill_moments(rows, block, moments);
  float* layer_sums = rows.layers.scratch + kTapBatch * lanes * rows.layers.count;
  const std::ptrdiff_t layers_step = lanes * sigmas * rows.orders * rows.layers.count;
  int count = 0;
  for (int y = 0; y < rows.weights.rows; ++y) {
    for (int k = 0; k < block.width; k += static_cast<int>(lanes), ++count) {
      FitPixels& p = pixels[count];
      p.x = block.x + k + y * rows.weights.pitch;
      float* basis = scratch.take(static_cast<std::size_t>(kMaxFeatureDimensions * rows.features * lanes));
      p.dimensions = 2 + (rows.features > 0 ? feature_basis(d, rows, moments, kNlmBlockWidth * y + k, basis) : 0);
      p.basis = basis;
      p.sums = scratch.take(static_cast<std::size_t>(sigmas * sums_step(d, rows)));
      p.fits = scratch.take(static_cast<std::size_t>(sigmas * fits_step(d, rows)));
      p.layers = {&rows.layers, rows.layers.scratch, layer_sums + count * layers_step};
      std::fill_n(p.sums, sigmas * sums_step(d, rows), 0.0F);
      std::fill_n(p.layers.sums, layers_step, 0.0F);
    }
  }
  return count;
}

HWY_INLINE void run_block(const LocalPolynomialRows& rows, std::ptrdiff_t x, int width) {
  const FloatTag d;
  Scratch scratch{rows.scratch};
  const TapDistances distances = take_distances(scratch);
  PatchBlock block{rows.weights, x, width, false, false, take_fields(scratch)};
  block.is_masked = has_hole(d, block);
  float* solver = scratch.take(static_cast<std::size_t>(normal_equation_sums(kMaxColumns) + kMaxColumns) * kMaxLanes);
  FitPixels pixels[kNlmBlockPixels];
  const int count = set_pixels(d, rows, block, scratch, pixels);
  for_each_group(d, rows, block, distances, pixels,
                 [&](const FitPixels& p, const TapGroup& group) { add_group_to_equations(rows, p, group); });
  block.has_slopes = !rows.is_taylor;
  for (int i = 0; i < count; ++i) solve_all(rows, pixels[i], solver);
  const bool can_have_moments = rows.is_taylor || rows.has_colour_weights;
  if (can_have_moments || rows.layers.count > 0) {
    for_each_group(d, rows, block, distances, pixels, [&](const FitPixels& p, const TapGroup& group) {
      const bool has_noise = rows.is_taylor || any_covariance(d, rows.weights.colour_covariance, 6, p.x);
      const bool has_moments = can_have_moments && has_noise;
      if (has_moments || rows.layers.count > 0) look_again(rows, p, group, has_moments);
    });
  }
  const FitPixels* p = pixels;
  for (int y = 0; y < rows.weights.rows; ++y) {
    for (int k = 0; k < width; k += static_cast<int>(hn::Lanes(d))) finish(d, rows, *p++, y, x + k);
  }
}

void LocalPolynomialRowsTarget(const LocalPolynomialRows& rows) {
  for (int x = 0; x < rows.weights.count; x += kNlmBlockWidth) {
    run_block(rows, x, std::min(kNlmBlockWidth, whole_vectors(rows.weights.count - x)));
  }
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::kernels {

HWY_EXPORT(LocalPolynomialRowsTarget);

void local_polynomial_rows(const LocalPolynomialRows& rows) { HWY_DYNAMIC_DISPATCH(LocalPolynomialRowsTarget)(rows); }

}  // namespace stein::kernels
#endif  // HWY_ONCE
