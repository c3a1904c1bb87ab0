// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
// Joint SURE: Li, "Joint Stein's Unbiased Risk Estimation for Adaptive Sampling and Reconstruction", 2017.
#include "kernels/cross_nlm.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/cross_nlm.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/layer_sums-inl.hpp"
#include "kernels/patch_block-inl.hpp"
#include "kernels/patch_distance-inl.hpp"
#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

// What moves a weight with the pixel's own noise. Blocks without noise, such as skies, take the short way.
enum class Slopes { kNone, kColour, kColourAndGuides };

template <Slopes kSlopes>
inline constexpr int kSumsOf = kSlopes == Slopes::kNone ? 4 : kNlmSums;

// One vector of pixels and a batch of its neighbours.
struct BatchSite {
  std::ptrdiff_t x = 0;  // of the pixels
  const std::ptrdiff_t* taps = nullptr;
  TapDistances distances;              // of the batch's first tap; kNlmBlockPixels apart from tap to tap
  float* HWY_RESTRICT sums = nullptr;  // [candidate][kNlmSums][lanes]
  LayerSums layers;
};

template <int kTaps>
struct Batch {
  HWY_INLINE Batch() {}  // NOLINT(modernize-use-equals-default): see Distances
  FloatVec guide_distance[kTaps];
  FloatVec guide_slope[3][kTaps];
  FloatVec patch_distance[kTaps];
  FloatVec colour[3][kTaps];       // x_j: one copy, for reads at any address cross cache lines
  FloatVec difference[3][kTaps];   // x_i - x_j
  FloatVec patch_slope[3][kTaps];  // contracted, over 1 / sigma_r^2
};

HWY_INLINE void add_to(FloatTag d, float* HWY_RESTRICT sum, FloatVec value) {
  hn::Store(hn::Add(hn::Load(d, sum), value), d, sum);
}

template <int kTaps>
HWY_INLINE void add_products(FloatTag d, float* HWY_RESTRICT sum, const FloatVec (&a)[kTaps],
                             const FloatVec (&b)[kTaps]) {
  FloatVec total = hn::Mul(a[0], b[0]);  // of the batch first: sums of hundreds of taps round less
  for (int t = 1; t < kTaps; ++t) total = hn::MulAdd(a[t], b[t], total);
  add_to(d, sum, total);
}

// Weights of a batch, candidate by candidate from the widest one on.
template <int kTaps>
struct Weights {
  HWY_INLINE explicit Weights(FloatTag d) {
    for (int t = 0; t < kTaps; ++t) w[t] = patch[t] = hn::Zero(d);
  }
  FloatVec w[kTaps];
  FloatVec patch[kTaps];  // the patches' part; where the next candidate's is its square

  HWY_INLINE void take(FloatTag d, const CrossNlmRows& rows, int candidate, const Batch<kTaps>& batch) {
    const FloatVec exponent = hn::Set(d, rows.exponent[candidate]);
    for (int t = 0; t < kTaps; ++t)
      w[t] = exp2_negative(d, hn::MulAdd(exponent, batch.patch_distance[t], batch.guide_distance[t]));
    if (candidate == 0 || !rows.is_square[candidate - 1]) return;
    for (int t = 0; t < kTaps; ++t) patch[t] = exp2_negative(d, hn::Mul(exponent, batch.patch_distance[t]));
  }
  // Below the least weight both are 0, so that no denormal arises.
  HWY_INLINE void square(FloatTag d) {
    const FloatVec least = hn::Set(d, kLeastWeight);
    for (int t = 0; t < kTaps; ++t) {
      const FloatVec product = hn::Mul(w[t], patch[t]);
      const auto is_seen = hn::Ge(product, least);
      w[t] = hn::IfThenElseZero(is_seen, product);
      patch[t] = hn::IfThenElseZero(is_seen, hn::Mul(patch[t], patch[t]));
    }
  }
};

// Adds one candidate's weights; false if all of them are 0, and hence all of smaller sigma_r.
template <Slopes kSlopes, int kTaps>
HWY_INLINE bool add_candidate(FloatTag d, const CrossNlmRows& rows, int candidate, const Batch<kTaps>& batch,
                              const FloatVec (&w)[kTaps], float* HWY_RESTRICT sums, const LayerSums& layers) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  FloatVec total = w[0];
  for (int t = 1; t < kTaps; ++t) total = hn::Add(total, w[t]);
  if (hn::AllTrue(d, hn::Eq(total, hn::Zero(d)))) return false;
  add_to(d, sums, total);
  for (int c = 0; c < 3; ++c) {
    add_products(d, sums + (1 + c) * lanes, w, batch.colour[c]);
    if constexpr (kSlopes != Slopes::kNone) {
      const FloatVec factor = hn::Set(d, rows.slope[candidate]);
      FloatVec slope[kTaps];
      for (int t = 0; t < kTaps; ++t) {
        slope[t] = kSlopes == Slopes::kColour ? hn::Mul(factor, batch.patch_slope[c][t])
                                              : hn::MulAdd(factor, batch.patch_slope[c][t], batch.guide_slope[c][t]);
        slope[t] = hn::Mul(slope[t], w[t]);
      }
      FloatVec slope_sum = slope[0];
      for (int t = 1; t < kTaps; ++t) slope_sum = hn::Add(slope_sum, slope[t]);
      add_to(d, sums + (4 + c) * lanes, slope_sum);
      add_products(d, sums + (7 + c) * lanes, slope, batch.difference[c]);
    }
  }
  if (rows.layers.count > 0) layers.add(d, candidate, w);
  return true;
}

template <Slopes kSlopes, bool kUsual>
HWY_INLINE void add_batch(FloatTag d, const CrossNlmRows& rows, const BatchSite& site) {
  Batch<kTapBatch> batch;
  std::ptrdiff_t at[kTapBatch];
  for (int t = 0; t < kTapBatch; ++t) at[t] = site.x + site.taps[t];
  if constexpr (kSlopes == Slopes::kColourAndGuides) {
    guide_distances_and_slopes<kUsual>(d, rows.guides, rows.guides, rows.guide_covariance, site.x, at,
                                       batch.guide_distance, batch.guide_slope);
  } else {
    guide_distances<kUsual>(d, rows.guides, rows.guides, site.x, at, batch.guide_distance);
  }
  for (int t = 0; t < kTapBatch; ++t) {
    batch.patch_distance[t] = hn::Load(d, site.distances.distance + t * static_cast<std::ptrdiff_t>(kNlmBlockPixels));
    for (int c = 0; c < 3; ++c) {
      batch.colour[c][t] = hn::LoadU(d, rows.colour[c] + at[t]);
      batch.difference[c][t] = hn::Sub(hn::LoadU(d, rows.colour[c] + site.x), batch.colour[c][t]);
    }
  }
  if constexpr (kSlopes != Slopes::kNone) contracted_slopes(d, rows, site.x, site.distances.slope, batch.patch_slope);
  if (rows.layers.count > 0) site.layers.load<false>(d, site.x, at);
  const std::ptrdiff_t sums_step = kNlmSums * static_cast<std::ptrdiff_t>(hn::Lanes(d));
  Weights<kTapBatch> weights(d);
  for (int s = rows.candidates - 1; s >= 0; --s) {
    if (rows.is_square[s]) {
      weights.square(d);
    } else {
      weights.take(d, rows, s, batch);
    }
    if (!add_candidate<kSlopes>(d, rows, s, batch, weights.w, site.sums + s * sums_step, site.layers)) break;
  }
}

// Sums over a group of taps for one vector of pixels.
template <Slopes kSlopes, bool kUsual>
HWY_NOINLINE void add_group_of_taps(const CrossNlmRows& rows, BatchSite site, int tap_count) {
  const FloatTag d;
  for (int t = 0; t < tap_count; t += kTapBatch) {
    add_batch<kSlopes, kUsual>(d, rows, site);
    site.taps += kTapBatch;
    constexpr std::ptrdiff_t kStep = kTapBatch * static_cast<std::ptrdiff_t>(kNlmBlockPixels);
    site.distances.distance += kStep;
    for (auto& slope : site.distances.slope) slope += kStep;
  }
}

HWY_INLINE Slopes slopes_at(FloatTag d, const CrossNlmRows& rows, std::ptrdiff_t x) {
  const int channels = rows.guides.groups > 0 ? rows.guides.group_end[rows.guides.groups - 1] : 0;
  for (int c = 0; c < 3 && rows.has_guide_covariance; ++c) {
    if (any_covariance(d, rows.guide_covariance[c], channels, x)) return Slopes::kColourAndGuides;
  }
  return any_covariance(d, rows.colour_covariance, 6, x) ? Slopes::kColour : Slopes::kNone;
}

template <bool kUsual>
void add_sums(const CrossNlmRows& rows, Slopes slopes, const BatchSite& site, int tap_count) {
  if (slopes == Slopes::kNone) {
    add_group_of_taps<Slopes::kNone, kUsual>(rows, site, tap_count);
  } else if (slopes == Slopes::kColour) {
    add_group_of_taps<Slopes::kColour, kUsual>(rows, site, tap_count);
  } else {
    add_group_of_taps<Slopes::kColourAndGuides, kUsual>(rows, site, tap_count);
  }
}

HWY_INLINE void finish_layers(FloatTag d, const CrossNlmRows& rows, int y, std::ptrdiff_t x,
                              const float* HWY_RESTRICT sums, const LayerSums& layers) {
  const FloatVec one = hn::Set(d, 1.0F);
  for (int s = 0; s < rows.candidates; ++s, sums += kNlmSums * static_cast<std::ptrdiff_t>(hn::Lanes(d))) {
    const FloatVec weight = hn::Load(d, sums);
    const auto has_weight = hn::Gt(weight, hn::Zero(d));
    const FloatVec inverse = hn::IfThenElseZero(has_weight, hn::Div(one, hn::IfThenElse(has_weight, weight, one)));
    for (int k = 0; k < rows.layers.count; ++k) {
      const FloatVec own = hn::LoadU(d, rows.layers.value[k] + x + y * rows.pitch);
      const FloatVec mean = hn::Mul(hn::Load(d, layers.sum(s, k)), inverse);
      float* result = rows.layers.result[(y * rows.candidates + s) * rows.layers.count + k];
      hn::StoreU(hn::IfThenElse(has_weight, mean, own), d, result + x);
    }
  }
}

// F and D of all candidates from their sums (SBF Eq. 5; D of Joint SURE Eq. 2).
HWY_INLINE void finish(FloatTag d, const CrossNlmRows& rows, int y, std::ptrdiff_t x, const float* HWY_RESTRICT sums) {
  const FloatVec one = hn::Set(d, 1.0F);
  const std::ptrdiff_t at = x + y * rows.pitch;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  for (int s = 0; s < rows.candidates; ++s, sums += kNlmSums * lanes) {
    const FloatVec weight = hn::Load(d, sums);
    const auto has_weight = hn::Gt(weight, hn::Zero(d));
    const FloatVec inverse = hn::IfThenElseZero(has_weight, hn::Div(one, hn::IfThenElse(has_weight, weight, one)));
    for (int c = 0; c < 3; ++c) {
      const FloatVec own = hn::LoadU(d, rows.colour[c] + at);
      const FloatVec mean = hn::Mul(hn::Load(d, sums + (1 + c) * lanes), inverse);
      // dw_j = -w_j s_j and x_j - F = (x_i - F) - e_j: sum_j dw_j (x_j - F), and the pixel's own term, w_ii = 1.
      const FloatVec moved =
          hn::NegMulAdd(hn::Sub(own, mean), hn::Load(d, sums + (4 + c) * lanes), hn::Load(d, sums + (7 + c) * lanes));
      const FloatVec divergence = hn::Mul(hn::Add(hn::LoadU(d, rows.colour_covariance[c] + at), moved), inverse);
      hn::StoreU(hn::IfThenElse(has_weight, mean, own), d, rows.result[y][s][c] + x);
      hn::StoreU(divergence, d, rows.divergence[y][s][c] + x);
    }
  }
}

template <bool kUsual>
HWY_INLINE void run_block(const CrossNlmRows& rows, std::ptrdiff_t x, int width) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  Scratch scratch{rows.scratch};
  const TapDistances distances = take_distances(scratch);
  PatchBlock block{rows, x, width, false, true, take_fields(scratch)};
  block.is_masked = has_hole(d, block);
  float* sums = scratch.next;
  const std::ptrdiff_t vectors = width / lanes;
  const std::ptrdiff_t sums_step = static_cast<std::ptrdiff_t>(rows.candidates) * kNlmSums * lanes;
  std::fill_n(sums, static_cast<std::size_t>(sums_step * vectors * rows.rows), 0.0F);

  float* layer_batch = rows.layers.scratch;
  float* layer_sums = layer_batch + std::ptrdiff_t{kTapBatch} * lanes * rows.layers.count;
  const std::ptrdiff_t layers_step = std::ptrdiff_t{lanes} * rows.candidates * rows.layers.count;
  std::fill_n(layer_sums, static_cast<std::size_t>(layers_step * vectors * rows.rows), 0.0F);
  const auto layers_at = [&](std::ptrdiff_t vector) {
    return LayerSums{&rows.layers, layer_batch, layer_sums + vector * layers_step};
  };

  const int padded = (rows.tap_count + kTapBatch - 1) / kTapBatch * kTapBatch;
  for (int first = 0; first < padded; first += kNlmTapGroup) {
    const int count = std::min(kNlmTapGroup, padded - first);
    fill_distances(block, first, count, distances);
    for (int y = 0; y < rows.rows; ++y) {
      for (std::ptrdiff_t v = 0; v < vectors; ++v) {
        BatchSite site;
        site.x = x + v * lanes + y * rows.pitch;
        site.taps = rows.taps + first;
        const std::ptrdiff_t pixel = static_cast<std::ptrdiff_t>(kNlmBlockWidth) * y + v * lanes;
        site.distances = {distances.distance + pixel,
                          {distances.slope[0] + pixel, distances.slope[1] + pixel, distances.slope[2] + pixel}};
        site.sums = sums + (y * vectors + v) * sums_step;
        site.layers = layers_at(y * vectors + v);
        add_sums<kUsual>(rows, slopes_at(d, rows, site.x), site, count);
      }
    }
  }
  for (int y = 0; y < rows.rows; ++y) {
    for (std::ptrdiff_t v = 0; v < vectors; ++v) {
      const std::ptrdiff_t index = y * vectors + v;
      finish(d, rows, y, x + v * lanes, sums + index * sums_step);
      if (rows.layers.count > 0) finish_layers(d, rows, y, x + v * lanes, sums + index * sums_step, layers_at(index));
    }
  }
}

void CrossNlmRowsTarget(const CrossNlmRows& rows) {
  const bool is_usual_set = is_usual(rows.guides);
  for (int x = 0; x < rows.count; x += kNlmBlockWidth) {
    const int width = std::min(kNlmBlockWidth, whole_vectors(rows.count - x));
    if (is_usual_set) {
      run_block<true>(rows, x, width);
    } else {
      run_block<false>(rows, x, width);
    }
  }
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::kernels {

HWY_EXPORT(CrossNlmRowsTarget);

void cross_nlm_rows(const CrossNlmRows& rows) { HWY_DYNAMIC_DISPATCH(CrossNlmRowsTarget)(rows); }

}  // namespace stein::kernels
#endif  // HWY_ONCE
