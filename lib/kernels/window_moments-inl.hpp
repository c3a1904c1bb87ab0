// SPDX-License-Identifier: Apache-2.0
//
// Means and covariances of the features over the windows of a block's pixels, as sums along y and then along x: windows
// share nearly all of their pixels. Compiled once per instruction set.
#if defined(STEIN_KERNELS_WINDOW_MOMENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef STEIN_KERNELS_WINDOW_MOMENTS_INL
#undef STEIN_KERNELS_WINDOW_MOMENTS_INL
#else
#define STEIN_KERNELS_WINDOW_MOMENTS_INL
#endif

#include <hwy/highway.h>

#include <cstddef>

#include "kernels/local_polynomial.hpp"
#include "kernels/patch_distance-inl.hpp"
#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

// Sums are in double: a window's variance counts from kLeastFeatureVariance on, whatever its mean is next to that.
using DoubleTag = hn::CappedTag<double, kMaxLanes>;
using DoubleVec = hn::Vec<DoubleTag>;
using NarrowTag = hn::Rebind<float, DoubleTag>;  // floats of as many lanes

HWY_INLINE DoubleVec load_wide(const float* from) { return hn::PromoteTo(DoubleTag(), hn::LoadU(NarrowTag(), from)); }

HWY_INLINE void store_narrow(DoubleVec value, float* to) {
  hn::Store(hn::DemoteTo(NarrowTag(), value), NarrowTag(), to);
}

// Of features in the window around each pixel of a block; values of one kind are kNlmBlockPixels apart, and those of
// the block's rows kNlmBlockWidth.
struct WindowMoments {
  float* HWY_RESTRICT noise;       // [feature] mean variance
  float* HWY_RESTRICT covariance;  // [pair_of_features()]
};

constexpr std::ptrdiff_t pair_of_features(int i, int j) { return std::ptrdiff_t{j} * (j + 1) / 2 + i; }  // i <= j

// Calls take(pixel of the block, sum over its window of value(offset in the planes)). Always the same additions in the
// same order, so that the block's place cannot show.
template <class Value, class Take>
HWY_INLINE void sum_windows(const PatchBlock& block, const Value& value, const Take& take) {
  constexpr int kLine = kNlmBlockWidth + 2 * kMaxRegressionRadius + kMaxLanes;
  const DoubleTag d;
  const int radius = block.rows.window_radius;
  const int rows = block.rows.rows;
  const int lanes = static_cast<int>(hn::Lanes(d));
  HWY_ALIGN double columns[kNlmBlockRows * kLine];
  for (int k = 0; k < block.width + 2 * radius; k += lanes) {
    DoubleVec values[kNlmBlockRows + 2 * kMaxRegressionRadius];
    const std::ptrdiff_t first = block.x - radius + k - radius * block.rows.pitch;
    for (int y = 0; y < rows + 2 * radius; ++y) values[y] = value(first + y * block.rows.pitch);
    for (int y = 0; y < rows; ++y) {
      DoubleVec sum = values[y];
      for (int n = 1; n <= 2 * radius; ++n) sum = hn::Add(sum, values[y + n]);
      hn::Store(sum, d, columns + y * kLine + k);
    }
  }
  for (int y = 0; y < rows; ++y) {
    for (int k = 0; k < block.width; k += lanes) {
      const double* HWY_RESTRICT column = columns + y * kLine + k;
      DoubleVec sum = hn::LoadU(d, column);
      for (int n = 1; n <= 2 * radius; ++n) sum = hn::Add(sum, hn::LoadU(d, column + n));
      take(kNlmBlockWidth * y + k, sum);
    }
  }
}

HWY_NOINLINE void fill_moments(const LocalPolynomialRows& rows, const PatchBlock& block, const WindowMoments& moments) {
  constexpr auto kPixels = static_cast<std::ptrdiff_t>(kNlmBlockPixels);
  const DoubleTag d;
  const float* mask = rows.weights.guides.mask;
  const auto at = [&](const float* plane, std::ptrdiff_t i) HWY_ATTR {
    return block.is_masked ? hn::Mul(load_wide(plane + i), load_wide(mask + i)) : load_wide(plane + i);
  };
  HWY_ALIGN double shares[kPixels];  // one over the number of the window's sources
  HWY_ALIGN double means[kMaxRegressionFeatures * kPixels];
  const auto mean_of = [&](int pixel, DoubleVec sum) HWY_ATTR { return hn::Mul(sum, hn::Load(d, shares + pixel)); };
  sum_windows(
      block, [&](std::ptrdiff_t i) HWY_ATTR { return load_wide(mask + i); },
      [&](int pixel, DoubleVec sum) HWY_ATTR {
        const DoubleVec one = hn::Set(d, 1.0);
        hn::Store(hn::Div(one, hn::Max(sum, one)), d, shares + pixel);
      });
  for (int j = 0; j < rows.features; ++j) {
    const float* feature = rows.feature[j];
    double* own = means + j * kPixels;
    float* noise = moments.noise + j * kPixels;
    sum_windows(
        block, [&](std::ptrdiff_t i) HWY_ATTR { return at(rows.feature_noise[j], i); },
        [&](int pixel, DoubleVec sum) HWY_ATTR { store_narrow(mean_of(pixel, sum), noise + pixel); });
    sum_windows(
        block, [&](std::ptrdiff_t i) HWY_ATTR { return at(feature, i); },
        [&](int pixel, DoubleVec sum) HWY_ATTR { hn::Store(mean_of(pixel, sum), d, own + pixel); });
    for (int k = 0; k <= j; ++k) {
      const double* other = means + k * kPixels;
      float* covariance = moments.covariance + pair_of_features(k, j) * kPixels;
      sum_windows(
          block, [&](std::ptrdiff_t i) HWY_ATTR { return hn::Mul(at(feature, i), load_wide(rows.feature[k] + i)); },
          [&](int pixel, DoubleVec sum) HWY_ATTR {
            const DoubleVec product = hn::Mul(hn::Load(d, own + pixel), hn::Load(d, other + pixel));
            store_narrow(hn::Sub(mean_of(pixel, sum), product), covariance + pixel);
          });
    }
  }
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
