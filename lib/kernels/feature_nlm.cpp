// SPDX-License-Identifier: Apache-2.0
#include "kernels/feature_nlm.hpp"

#include <algorithm>
#include <cstdlib>
#include <numbers>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/feature_nlm.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/patch_distance-inl.hpp"
#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

constexpr auto kNaturalLog2 = static_cast<float>(std::numbers::ln2);

// Fields over the rows, `line` floats from one to the next. The first pixel of the patches' sums lies a patch's radius
// to the left of the target's.
struct FeatureFields {
  std::ptrdiff_t line;
  float* HWY_RESTRICT pair_sums;  // sums along y over the patches: distances of pairs
  float* HWY_RESTRICT mask_sums;  // pairs of which both may be averaged
  float* HWY_RESTRICT weights;    // sums over the window
  float* values[kMostFeatureChannels];
  float* slopes[kMostFeatureChannels];        // sums of weights times half the derivative of their distance
  float* slope_values[kMostFeatureChannels];  // the same times the neighbours' values
};

struct FeatureTap {
  std::ptrdiff_t offset = 0;
  bool is_near = false;  // the neighbour's patch has the pixel in it
};

// Two more vectors: for the patches' rim, and so that fields do not share cache sets.
constexpr std::ptrdiff_t line_of(int count) { return whole_vectors(count) + 2 * kMaxLanes; }

HWY_INLINE FeatureFields take_fields(const FeatureNlmRows& rows) {
  float* next = rows.scratch;
  const std::ptrdiff_t line = line_of(rows.count);
  const auto take = [&] { return std::exchange(next, next + kFeatureNlmRows * line); };
  FeatureFields fields{line, take(), take(), take(), {}, {}, {}};
  for (auto* list : {&fields.values, &fields.slopes, &fields.slope_values}) {
    for (float*& field : *list) field = take();
  }
  return fields;
}

HWY_INLINE FloatVec pair_factor(FloatTag d, const FeatureNlmRows& rows, std::ptrdiff_t a, std::ptrdiff_t b) {
  const FloatVec noise = hn::Add(hn::LoadU(d, rows.noise + a), hn::LoadU(d, rows.noise + b));
  return reciprocal(d, hn::Max(noise, hn::Set(d, kLeastNoise)));
}

// The distance of the pixels at a and b.
HWY_INLINE FloatVec pair_distance(FloatTag d, const FeatureNlmRows& rows, std::ptrdiff_t a, std::ptrdiff_t b) {
  FloatVec squares = hn::Zero(d);
  for (int k = 0; k < rows.channels; ++k) {
    const FloatVec e = hn::Sub(hn::LoadU(d, rows.channel[k] + a), hn::LoadU(d, rows.channel[k] + b));
    squares = hn::MulAdd(e, e, squares);
  }
  const FloatVec va = hn::LoadU(d, rows.noise + a);
  const FloatVec vb = hn::LoadU(d, rows.noise + b);
  return hn::Mul(hn::Sub(squares, hn::Add(va, hn::Min(va, vb))), pair_factor(d, rows, a, b));
}

// Stores sums of 2 kRadius + 1 rows each: always the same additions in the same order, wherever the rows begin.
template <int kRadius>
HWY_INLINE void store_sums(FloatTag d, const FloatVec (&in)[kFeatureNlmRows + 2 * kRadius], int rows,
                           std::ptrdiff_t line, float* HWY_RESTRICT out) {
  for (int y = 0; y < rows; ++y) {
    FloatVec sum = in[y];
    for (int n = 1; n <= 2 * kRadius; ++n) sum = hn::Add(sum, in[y + n]);
    hn::Store(sum, d, out + line * y);
  }
}

// The patches' sums along y for the neighbour at `tap`, a vector of columns at a time.
template <int kRadius, bool kMasked>
HWY_INLINE void sum_pairs(FloatTag d, const FeatureNlmRows& rows, std::ptrdiff_t tap, const FeatureFields& fields) {
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int high = rows.rows + 2 * kRadius;
  for (std::ptrdiff_t k = 0; k < whole_vectors(rows.count) + 2 * kRadius; k += lanes) {
    FloatVec pairs[kFeatureNlmRows + 2 * kRadius];
    FloatVec masks[kFeatureNlmRows + 2 * kRadius];
    for (int y = 0; y < high; ++y) {
      const std::ptrdiff_t at = (y - kRadius) * rows.pitch + k - kRadius;
      pairs[y] = pair_distance(d, rows, at, at + tap);
      if constexpr (kMasked) {
        masks[y] = hn::Mul(hn::LoadU(d, rows.mask + at), hn::LoadU(d, rows.mask + at + tap));
        pairs[y] = hn::Mul(pairs[y], masks[y]);
      }
    }
    store_sums<kRadius>(d, pairs, rows.rows, fields.line, fields.pair_sums + k);
    if constexpr (kMasked) store_sums<kRadius>(d, masks, rows.rows, fields.line, fields.mask_sums + k);
  }
}

// Adds w times what a step of the pixel adds to half the distance of the patches, channel by channel: by the pair at
// their middles, and where the neighbour's patch has the pixel in it by that pair, too. `share`: of a pair in the
// distance.
template <bool kMasked>
HWY_INLINE void add_slopes(FloatTag d, const FeatureNlmRows& rows, std::ptrdiff_t at, const FeatureTap& tap, FloatVec w,
                           FloatVec share, std::ptrdiff_t field, const FeatureFields& fields) {
  const FloatVec scale = hn::Mul(w, share);
  FloatVec after = hn::Mul(scale, pair_factor(d, rows, at, at + tap.offset));
  FloatVec before = hn::Zero(d);
  if (tap.is_near) before = hn::Mul(scale, pair_factor(d, rows, at, at - tap.offset));
  if constexpr (kMasked) {
    const FloatVec own = hn::LoadU(d, rows.mask + at);
    after = hn::Mul(after, hn::Mul(own, hn::LoadU(d, rows.mask + at + tap.offset)));
    before = hn::Mul(before, hn::Mul(own, hn::LoadU(d, rows.mask + at - tap.offset)));
  }
  for (int c = 0; c < rows.channels; ++c) {
    const FloatVec own = hn::LoadU(d, rows.channel[c] + at);
    const FloatVec neighbour = hn::LoadU(d, rows.channel[c] + at + tap.offset);
    FloatVec slope = hn::Mul(after, hn::Sub(own, neighbour));
    if (tap.is_near) slope = hn::MulAdd(before, hn::Sub(own, hn::LoadU(d, rows.channel[c] + at - tap.offset)), slope);
    float* HWY_RESTRICT slopes = fields.slopes[c] + field;
    float* HWY_RESTRICT values = fields.slope_values[c] + field;
    hn::Store(hn::Add(hn::Load(d, slopes), slope), d, slopes);
    hn::Store(hn::MulAdd(slope, neighbour, hn::Load(d, values)), d, values);
  }
}

template <int kRadius, bool kMasked>
HWY_INLINE void add_neighbour(FloatTag d, const FeatureNlmRows& rows, const FeatureTap& tap,
                              const FeatureFields& fields) {
  const bool has_slopes = rows.kept[0][0] != nullptr;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const FloatVec one = hn::Set(d, 1.0F);
  const FloatVec exponent = hn::Set(d, rows.exponent);
  for (int y = 0; y < rows.rows; ++y) {
    for (std::ptrdiff_t k = 0; k < whole_vectors(rows.count); k += lanes) {
      const std::ptrdiff_t field = fields.line * y + k;
      const std::ptrdiff_t at = y * rows.pitch + k;
      const std::ptrdiff_t neighbour = at + tap.offset;
      FloatVec share = hn::Set(d, 1.0F / static_cast<float>((2 * kRadius + 1) * (2 * kRadius + 1)));
      if constexpr (kMasked)
        share = hn::Div(one, hn::Max(patch_sum<kRadius>(d, kRadius, fields.mask_sums + field), one));
      const FloatVec mean = hn::Mul(patch_sum<kRadius>(d, kRadius, fields.pair_sums + field), share);
      FloatVec w = exp2_negative(d, hn::Mul(hn::Max(mean, hn::Zero(d)), exponent));
      if constexpr (kMasked) w = hn::Mul(w, hn::LoadU(d, rows.mask + neighbour));
      hn::Store(hn::Add(hn::Load(d, fields.weights + field), w), d, fields.weights + field);
      for (int c = 0; c < rows.channels; ++c) {
        float* HWY_RESTRICT sum = fields.values[c] + field;
        hn::Store(hn::MulAdd(w, hn::LoadU(d, rows.channel[c] + neighbour), hn::Load(d, sum)), d, sum);
      }
      if (!has_slopes) continue;
      const FloatVec moving = hn::IfThenElseZero(hn::Gt(mean, hn::Zero(d)), w);  // a clamped distance does not move
      add_slopes<kMasked>(d, rows, at, tap, moving, share, field, fields);
    }
  }
}

// The derivative of a channel's mean by the pixel's own value. Its distance to itself is never above 0: its own weight
// is its mask.
HWY_INLINE FloatVec kept_of(FloatTag d, const FeatureNlmRows& rows, std::ptrdiff_t at, std::ptrdiff_t field, int c,
                            FloatVec mean, FloatVec inverse, const FeatureFields& fields) {
  const FloatVec own = hn::LoadU(d, rows.mask + at);
  const FloatVec through_weights =
      hn::NegMulAdd(mean, hn::Load(d, fields.slopes[c] + field), hn::Load(d, fields.slope_values[c] + field));
  const FloatVec slope = hn::Set(d, 2.0F * rows.exponent * kNaturalLog2);
  const FloatVec kept = hn::Mul(hn::NegMulAdd(slope, through_weights, own), inverse);
  return hn::Mul(own, hn::Min(hn::Max(kept, hn::Zero(d)), hn::Set(d, 1.0F)));
}

HWY_INLINE void finish_feature(FloatTag d, const FeatureNlmRows& rows, const FeatureFields& fields) {
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int y = 0; y < rows.rows; ++y) {
    for (std::ptrdiff_t k = 0; k < whole_vectors(rows.count); k += lanes) {
      const std::ptrdiff_t field = fields.line * y + k;
      const std::ptrdiff_t at = y * rows.pitch + k;
      const FloatVec weight = hn::Load(d, fields.weights + field);
      const auto has_weight = hn::Gt(weight, hn::Zero(d));
      const FloatVec inverse = hn::Div(hn::Set(d, 1.0F), hn::IfThenElse(has_weight, weight, hn::Set(d, 1.0F)));
      for (int c = 0; c < rows.channels; ++c) {
        const FloatVec mean = hn::Mul(hn::Load(d, fields.values[c] + field), inverse);
        hn::StoreU(hn::IfThenElse(has_weight, mean, hn::LoadU(d, rows.channel[c] + at)), d, rows.result[y][c] + k);
        if (rows.kept[y][c] != nullptr)
          hn::StoreU(kept_of(d, rows, at, field, c, mean, inverse, fields), d, rows.kept[y][c] + k);
      }
    }
  }
}

// Whether all that patches and neighbours reach may be averaged: then the patches' sizes are known.
HWY_INLINE bool has_hole(const FeatureNlmRows& rows) {
  const int rim = rows.window_radius + rows.patch_radius;
  const std::ptrdiff_t end = whole_vectors(rows.count) + rim;
  for (int y = -rim; y < rows.rows + rim; ++y) {
    const float* mask = rows.mask + y * rows.pitch;
    if (!std::all_of(mask - rim, mask + end, [](float m) { return m == 1.0F; })) return true;
  }
  return false;
}

template <int kRadius, bool kMasked>
HWY_NOINLINE void run_window(const FeatureNlmRows& rows, const FeatureFields& fields) {
  const FloatTag d;
  for (int dy = -rows.window_radius; dy <= rows.window_radius; ++dy) {
    for (int dx = -rows.window_radius; dx <= rows.window_radius; ++dx) {
      const FeatureTap tap{dy * rows.pitch + dx, std::max(std::abs(dx), std::abs(dy)) <= kRadius};
      sum_pairs<kRadius, kMasked>(d, rows, tap.offset, fields);
      add_neighbour<kRadius, kMasked>(d, rows, tap, fields);
    }
  }
}

void FeatureNlmRowsTarget(const FeatureNlmRows& rows) {
  const FeatureFields fields = take_fields(rows);
  std::fill_n(fields.weights, kFeatureNlmRows * fields.line, 0.0F);
  for (int c = 0; c < rows.channels; ++c) {
    for (float* field : {fields.values[c], fields.slopes[c], fields.slope_values[c]})
      std::fill_n(field, kFeatureNlmRows * fields.line, 0.0F);
  }
  using Run = void (*)(const FeatureNlmRows&, const FeatureFields&);
  static constexpr Run kRuns[kMostFeaturePatch][2] = {{run_window<1, false>, run_window<1, true>},
                                                      {run_window<2, false>, run_window<2, true>}};
  kRuns[rows.patch_radius - 1][has_hole(rows) ? 1 : 0](rows, fields);
  finish_feature(FloatTag(), rows, fields);
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::kernels {

HWY_EXPORT(FeatureNlmRowsTarget);

std::size_t feature_nlm_scratch(int count) noexcept {
  constexpr std::size_t kFields = 3 + 3 * kMostFeatureChannels;
  const int line = whole_vectors(count) + 2 * kMaxLanes;
  return kFields * kFeatureNlmRows * static_cast<std::size_t>(line);
}

void feature_nlm_rows(const FeatureNlmRows& rows) { HWY_DYNAMIC_DISPATCH(FeatureNlmRowsTarget)(rows); }

}  // namespace stein::kernels
#endif  // HWY_ONCE
