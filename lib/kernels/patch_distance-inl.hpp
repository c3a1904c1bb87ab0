// SPDX-License-Identifier: Apache-2.0
//
// Distances of the patches around the pixels of a block to the patches around their neighbours at one offset, and how
// they change with the pixel. Compiled once per instruction set.
#if defined(STEIN_KERNELS_PATCH_DISTANCE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef STEIN_KERNELS_PATCH_DISTANCE_INL
#undef STEIN_KERNELS_PATCH_DISTANCE_INL
#else
#define STEIN_KERNELS_PATCH_DISTANCE_INL
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "kernels/cross_nlm.hpp"
#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

// Exact pixels: the reciprocal of their noise must stay finite, and so must the distance of any two radiances.
inline constexpr float kLeastNoise = 1e-24F;
// Of neighbours that count nothing: 2^-d is exactly 0 for any exponent.
inline constexpr float kNoNeighbour = 1e30F;

inline constexpr auto kPatchLine = static_cast<std::ptrdiff_t>(kNlmPatchWidth);

// Fields over a block and a rim around it, kPatchLine from row to row. The pixel at their start lies a rim to the left
// of the block; that of the first two a rim above it as well.
struct PatchFields {
  float* HWY_RESTRICT pairs;      // distance of the two pixels
  float* HWY_RESTRICT masks;      // 1 where both are sources
  float* HWY_RESTRICT pair_sums;  // sums along y of these
  float* HWY_RESTRICT mask_sums;
  float* slope_sums[3];  // spread along y: half the derivative of `pairs` by the pixel's own colour
};

// What pairs are made of. Copied to where loops are: what these store cannot change it then.
struct PairPlanes {
  explicit PairPlanes(const CrossNlmRows& rows)
      : colour{rows.blurred[0], rows.blurred[1], rows.blurred[2]}, noise(rows.noise), mask(rows.guides.mask) {}
  const float* colour[3];
  const float* noise;
  const float* mask;
};

struct PatchBlock {
  const CrossNlmRows& rows;
  std::ptrdiff_t x = 0;    // first pixel of the block
  int width = 0;           // a multiple of kMaxLanes
  bool is_masked = false;  // whether any pixel that its patches or neighbours reach is no source
  bool has_slopes = true;  // whether slopes are wanted; without, none are written
  PatchFields fields;
  [[nodiscard]] int rim() const { return std::max(rows.patch_radius, 1); }
};

struct Tap {
  std::ptrdiff_t offset = 0;
  bool is_near = false;
  int dx = 0;  // of near taps
  int dy = 0;
};

// What a tap's distances go to, kNlmBlockWidth apart from row to row.
struct TapDistances {
  float* HWY_RESTRICT distance;
  float* slope[3];  // half the derivative by the pixel's own colour
};

// The colours of the two pixels of a pair apart, and what their squared difference is multiplied by.
struct Pair {
  HWY_INLINE Pair() {}  // NOLINT(modernize-use-equals-default): see Distances
  FloatVec difference[3];
  FloatVec distance;
  FloatVec factor;
};

// What a pair compares of one of its pixels; noise and mask where they matter.
struct PairSide {
  HWY_INLINE PairSide() {}  // NOLINT(modernize-use-equals-default): see Distances
  FloatVec colour[3];
  FloatVec noise;
  FloatVec mask;
};

// Reads the pixels of a vector, or one for all lanes: `read` makes a vector of a pointer.
template <bool kNormalised, bool kMasked, class Read>
HWY_INLINE PairSide pair_side(const PairPlanes& planes, std::ptrdiff_t at, Read read) {
  PairSide side;
  for (int c = 0; c < 3; ++c) side.colour[c] = read(planes.colour[c] + at);
  if constexpr (kNormalised) side.noise = read(planes.noise + at);
  if constexpr (kMasked) side.mask = read(planes.mask + at);
  return side;
}

// |a - b|^2, or (|a - b|^2 - (v_a + min(v_a, v_b))) / (v_a + v_b); 0 unless both are sources.
template <bool kNormalised, bool kMasked>
HWY_INLINE Pair pair_of(FloatTag d, const PairSide& a, const PairSide& b) {
  Pair pair;
  for (int c = 0; c < 3; ++c) pair.difference[c] = hn::Sub(a.colour[c], b.colour[c]);
  const FloatVec e0 = pair.difference[0];
  const FloatVec e1 = pair.difference[1];
  const FloatVec e2 = pair.difference[2];
  pair.distance = hn::MulAdd(e2, e2, hn::MulAdd(e1, e1, hn::Mul(e0, e0)));
  pair.factor = hn::Set(d, 1.0F);
  if constexpr (kNormalised) {
    pair.factor = reciprocal(d, hn::Max(hn::Add(a.noise, b.noise), hn::Set(d, kLeastNoise)));
    pair.distance = hn::Mul(hn::Sub(pair.distance, hn::Add(a.noise, hn::Min(a.noise, b.noise))), pair.factor);
  }
  if constexpr (kMasked) {
    const FloatVec both = hn::Mul(a.mask, b.mask);
    pair.distance = hn::Mul(pair.distance, both);
    pair.factor = hn::Mul(pair.factor, both);
  }
  return pair;
}

template <bool kNormalised, bool kMasked>
HWY_INLINE Pair pair_at(FloatTag d, const PairPlanes& planes, std::ptrdiff_t a, std::ptrdiff_t b) {
  const auto load = [d](const float* from) HWY_ATTR { return hn::LoadU(d, from); };
  return pair_of<kNormalised, kMasked>(d, pair_side<kNormalised, kMasked>(planes, a, load),
                                       pair_side<kNormalised, kMasked>(planes, b, load));
}

// Weights 1 and blur at either side: the pixel's part in the blurred colours of the patch around it.
HWY_INLINE FloatVec spread(FloatVec blur, FloatVec before, FloatVec centre, FloatVec after) {
  return hn::MulAdd(blur, hn::Add(before, after), centre);
}

HWY_INLINE float patch_blur(const CrossNlmRows& rows) { return rows.patch_radius > 0 ? rows.blur : 0.0F; }

// Fills `pairs`, `masks` and `slope_sums` of a vector of columns, k from the rim on.
template <bool kNormalised, bool kMasked, bool kSlopes>
HWY_INLINE void fill_pairs(FloatTag d, const PatchBlock& block, std::ptrdiff_t tap, int k) {
  const CrossNlmRows& rows = block.rows;
  const PairPlanes planes(rows);
  const PatchFields fields = block.fields;
  const float* HWY_RESTRICT gain = rows.gain;
  const std::ptrdiff_t pitch = rows.pitch;
  const FloatVec blur = hn::Set(d, patch_blur(rows));
  const int rim = block.rim();
  const int count = rows.rows;
  FloatVec before[3];
  FloatVec last[3];
  for (int c = 0; c < 3; ++c) before[c] = last[c] = hn::Zero(d);
  for (int y = -rim; y < count + rim; ++y) {
    const std::ptrdiff_t to = kPatchLine * (y + rim) + k;
    const std::ptrdiff_t at = block.x - rim + k + y * pitch;
    const Pair pair = pair_at<kNormalised, kMasked>(d, planes, at, at + tap);
    hn::Store(pair.distance, d, fields.pairs + to);
    if constexpr (kSlopes) {
      const FloatVec slope = hn::Mul(pair.factor, hn::LoadU(d, gain + at));
      const bool is_inside = y >= 1 && y <= count;
      for (int c = 0; c < 3; ++c) {
        const FloatVec next = hn::Mul(slope, pair.difference[c]);
        if (is_inside)
          hn::Store(spread(blur, before[c], last[c], next), d, fields.slope_sums[c] + kPatchLine * (y - 1) + k);
        before[c] = last[c];
        last[c] = next;
      }
    }
    if constexpr (kMasked) {
      const FloatVec both = hn::Mul(hn::LoadU(d, planes.mask + at), hn::LoadU(d, planes.mask + at + tap));
      hn::Store(both, d, fields.masks + to);
    }
  }
}

// Sums of the patches' pixels along y, of a vector of columns. Always the same additions in the same order, so that
// neither drift nor the block's place can show.
template <int kRadius>
HWY_INLINE void sum_columns(FloatTag d, const PatchBlock& block, int k, const float* HWY_RESTRICT in,
                            float* HWY_RESTRICT out) {
  const int radius = kRadius >= 0 ? kRadius : block.rows.patch_radius;
  const int rows = block.rows.rows;
  in += kPatchLine * (block.rim() - radius) + k;
  for (int y = 0; y < rows; ++y) {
    FloatVec sum = hn::Load(d, in + kPatchLine * y);
    for (int n = 1; n <= 2 * radius; ++n) sum = hn::Add(sum, hn::Load(d, in + kPatchLine * (y + n)));
    hn::Store(sum, d, out + kPatchLine * y + k);
  }
}

template <int kRadius>
HWY_INLINE FloatVec patch_sum(FloatTag d, int radius, const float* HWY_RESTRICT sums) {
  FloatVec sum = hn::LoadU(d, sums);
  for (int n = 1; n <= 2 * (kRadius >= 0 ? kRadius : radius); ++n) sum = hn::Add(sum, hn::LoadU(d, sums + n));
  return sum;
}

// Adds the pixel's part in the blurred colours of the patch around its neighbour, for the pairs (i - m - tap, i - m).
template <bool kNormalised, bool kMasked>
HWY_INLINE void add_near_slopes(FloatTag d, const CrossNlmRows& rows, std::ptrdiff_t at, const Tap& tap,
                                FloatVec (&slope)[3]) {
  const PairPlanes planes(rows);
  for (int my = -1; my <= 1; ++my) {
    for (int mx = -1; mx <= 1; ++mx) {
      if (std::max(std::abs(tap.dx + mx), std::abs(tap.dy + my)) > rows.patch_radius) continue;
      const std::ptrdiff_t seen = at - (my * rows.pitch + mx);
      const Pair pair = pair_at<kNormalised, kMasked>(d, planes, seen, seen - tap.offset);
      const float weight = (mx == 0 ? 1.0F : rows.blur) * (my == 0 ? 1.0F : rows.blur);
      const FloatVec factor = hn::Mul(hn::Mul(hn::Set(d, weight), hn::LoadU(d, rows.gain + seen)), pair.factor);
      for (int c = 0; c < 3; ++c) slope[c] = hn::MulAdd(factor, pair.difference[c], slope[c]);
    }
  }
}

template <int kRadius, bool kNormalised, bool kMasked, bool kSlopes>
HWY_INLINE void finish_pixels(FloatTag d, const PatchBlock& block, int y, int k, const Tap& tap,
                              const TapDistances& out) {
  const CrossNlmRows& rows = block.rows;
  const int radius = kRadius >= 0 ? kRadius : rows.patch_radius;
  const FloatVec one = hn::Set(d, 1.0F);
  const std::ptrdiff_t at = block.x + k + y * rows.pitch;
  const std::ptrdiff_t to = static_cast<std::ptrdiff_t>(kNlmBlockWidth) * y + k;
  const std::ptrdiff_t centre = kPatchLine * y + k + block.rim();
  const std::ptrdiff_t patch = centre - radius;
  FloatVec share = hn::Set(d, 1.0F / static_cast<float>((2 * radius + 1) * (2 * radius + 1)));
  if constexpr (kMasked) {
    share = hn::Div(one, hn::Max(patch_sum<kRadius>(d, radius, block.fields.mask_sums + patch), one));
  }
  const FloatVec mean = hn::Mul(patch_sum<kRadius>(d, radius, block.fields.pair_sums + patch), share);
  FloatVec distance = hn::Max(mean, hn::Zero(d));
  if constexpr (kMasked) {
    const auto is_source = hn::Gt(hn::LoadU(d, rows.guides.mask + at + tap.offset), hn::Zero(d));
    distance = hn::IfThenElse(is_source, distance, hn::Set(d, kNoNeighbour));
  }
  hn::Store(distance, d, out.distance + to);
  if constexpr (!kSlopes) return;
  const FloatVec blur = hn::Set(d, patch_blur(rows));
  FloatVec slope[3];
  for (int c = 0; c < 3; ++c) {
    const float* HWY_RESTRICT sums = block.fields.slope_sums[c] + centre;
    slope[c] = spread(blur, hn::LoadU(d, sums - 1), hn::LoadU(d, sums), hn::LoadU(d, sums + 1));
  }
  if (tap.is_near) add_near_slopes<kNormalised, kMasked>(d, rows, at, tap, slope);
  share = hn::IfThenElseZero(hn::Gt(mean, hn::Zero(d)), share);  // a clamped distance does not move
  for (int c = 0; c < 3; ++c) hn::Store(hn::Mul(slope[c], share), d, out.slope[c] + to);
}

template <int kRadius, bool kNormalised, bool kMasked, bool kSlopes>
HWY_NOINLINE void patch_distances_as(const PatchBlock& block, const Tap& tap, const TapDistances& out) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int k = 0; k < block.width + 2 * block.rim(); k += lanes) {
    fill_pairs<kNormalised, kMasked, kSlopes>(d, block, tap.offset, k);
    sum_columns<kRadius>(d, block, k, block.fields.pairs, block.fields.pair_sums);
    if constexpr (kMasked) sum_columns<kRadius>(d, block, k, block.fields.masks, block.fields.mask_sums);
  }
  for (int y = 0; y < block.rows.rows; ++y) {
    for (int k = 0; k < block.width; k += lanes) {
      finish_pixels<kRadius, kNormalised, kMasked, kSlopes>(d, block, y, k, tap, out);
    }
  }
}

template <int kRadius, bool kNormalised, bool kMasked>
HWY_INLINE void patch_distances_or_slopes(const PatchBlock& block, const Tap& tap, const TapDistances& out) {
  if (block.has_slopes) {
    patch_distances_as<kRadius, kNormalised, kMasked, true>(block, tap, out);
  } else {
    patch_distances_as<kRadius, kNormalised, kMasked, false>(block, tap, out);
  }
}

// One path for patches of 5x5, one for all others.
inline void patch_distances(const PatchBlock& block, const Tap& tap, const TapDistances& out) {
  constexpr int kUsualRadius = 2;
  constexpr int kAny = -1;
  using Run = void (*)(const PatchBlock&, const Tap&, const TapDistances&);
  static constexpr Run kRuns[2][2][2] = {
      {{patch_distances_or_slopes<kAny, false, false>, patch_distances_or_slopes<kAny, false, true>},
       {patch_distances_or_slopes<kAny, true, false>, patch_distances_or_slopes<kAny, true, true>}},
      {{patch_distances_or_slopes<kUsualRadius, false, false>, patch_distances_or_slopes<kUsualRadius, false, true>},
       {patch_distances_or_slopes<kUsualRadius, true, false>, patch_distances_or_slopes<kUsualRadius, true, true>}}};
  const bool is_usual_radius = block.rows.patch_radius == kUsualRadius;
  kRuns[is_usual_radius ? 1 : 0][block.rows.is_normalised ? 1 : 0][block.is_masked ? 1 : 0](block, tap, out);
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
