// SPDX-License-Identifier: Apache-2.0
//
// Directions of feature space in which a window varies by more than noise: truncated singular value decomposition of
// its centred features, of units in which their noise is 1 in every direction. Compiled once per instruction set.
#if defined(STEIN_KERNELS_FEATURE_BASIS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef STEIN_KERNELS_FEATURE_BASIS_INL
#undef STEIN_KERNELS_FEATURE_BASIS_INL
#else
#define STEIN_KERNELS_FEATURE_BASIS_INL
#endif

#include <hwy/highway.h>

#include "kernels/local_polynomial.hpp"
#include "kernels/weights-inl.hpp"
#include "kernels/window_moments-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

// A symmetric matrix per lane, and its eigenvectors as columns.
struct EigenSystem {
  HWY_INLINE EigenSystem() {}  // NOLINT(modernize-use-equals-default): see Distances
  FloatVec matrix[kMaxRegressionFeatures][kMaxRegressionFeatures];
  FloatVec vectors[kMaxRegressionFeatures][kMaxRegressionFeatures];
};

// One rotation of the cyclic Jacobi method: makes entry (p, q) zero.
HWY_INLINE void rotate(FloatTag d, EigenSystem& system, int n, int p, int q) {
  const FloatVec one = hn::Set(d, 1.0F);
  const FloatVec off = system.matrix[p][q];
  // tan of the smaller angle: sign(t) / (|t| + sqrt(t^2 + 1)), t = (a_qq - a_pp) / (2 a_pq), multiplied out so that
  // a_pq = 0 gives 0.
  const FloatVec gap = hn::Sub(system.matrix[q][q], system.matrix[p][p]);
  const FloatVec twice = hn::Add(off, off);
  const FloatVec root = hn::Sqrt(hn::MulAdd(gap, gap, hn::Mul(twice, twice)));
  const FloatVec denominator = hn::Add(hn::Abs(gap), root);
  const auto is_off = hn::Gt(denominator, hn::Zero(d));
  const FloatVec size = hn::Div(twice, hn::IfThenElse(is_off, denominator, one));
  const FloatVec tangent = hn::IfThenElseZero(is_off, hn::IfThenElse(hn::Lt(gap, hn::Zero(d)), hn::Neg(size), size));
  const FloatVec cosine = hn::Div(one, hn::Sqrt(hn::MulAdd(tangent, tangent, one)));
  const FloatVec sine = hn::Mul(tangent, cosine);
  for (int k = 0; k < n; ++k) {
    const FloatVec a = system.matrix[k][p];
    const FloatVec b = system.matrix[k][q];
    system.matrix[k][p] = hn::NegMulAdd(sine, b, hn::Mul(cosine, a));
    system.matrix[k][q] = hn::MulAdd(sine, a, hn::Mul(cosine, b));
    const FloatVec u = system.vectors[k][p];
    const FloatVec v = system.vectors[k][q];
    system.vectors[k][p] = hn::NegMulAdd(sine, v, hn::Mul(cosine, u));
    system.vectors[k][q] = hn::MulAdd(sine, u, hn::Mul(cosine, v));
  }
  for (int k = 0; k < n; ++k) {
    const FloatVec a = system.matrix[p][k];
    const FloatVec b = system.matrix[q][k];
    system.matrix[p][k] = hn::NegMulAdd(sine, b, hn::Mul(cosine, a));
    system.matrix[q][k] = hn::MulAdd(sine, a, hn::Mul(cosine, b));
  }
}

HWY_INLINE void decompose(FloatTag d, EigenSystem& system, int n) {
  constexpr int kSweeps = 6;  // converges quadratically; the result is as good as float covariances are
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) system.vectors[i][j] = hn::Set(d, i == j ? 1.0F : 0.0F);
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int p = 0; p + 1 < n; ++p) {
      for (int q = p + 1; q < n; ++q) rotate(d, system, n, p, q);
    }
  }
}

// Covariance of the window's features over the square roots of their noise, `scale` being one over those roots; for the
// block's pixels from `pixel` on.
HWY_INLINE void whitened_covariance(FloatTag d, int features, const WindowMoments& moments, std::ptrdiff_t pixel,
                                    EigenSystem& system, FloatVec (&scale)[kMaxRegressionFeatures]) {
  constexpr auto kPixels = static_cast<std::ptrdiff_t>(kNlmBlockPixels);
  for (int j = 0; j < features; ++j) {
    const FloatVec noise = hn::Load(d, moments.noise + j * kPixels + pixel);
    scale[j] = hn::Div(hn::Set(d, 1.0F), hn::Sqrt(hn::Add(noise, hn::Set(d, kLeastFeatureVariance))));
    for (int i = 0; i <= j; ++i) {
      const FloatVec covariance = hn::Load(d, moments.covariance + pair_of_features(i, j) * kPixels + pixel);
      system.matrix[i][j] = system.matrix[j][i] = hn::Mul(covariance, hn::Mul(scale[i], scale[j]));
    }
  }
}

// basis[r * features + k]: what feature k adds to direction r, whose variance over the window is 1; directions by
// falling variance in units of the noise, 0 where that is below the threshold. Returns the number of directions that
// any lane has.
HWY_INLINE int feature_basis(FloatTag d, const LocalPolynomialRows& rows, const WindowMoments& moments,
                             std::ptrdiff_t pixel, float* HWY_RESTRICT basis) {
  const int n = rows.features;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  EigenSystem system;
  FloatVec scale[kMaxRegressionFeatures];
  whitened_covariance(d, n, moments, pixel, system, scale);
  decompose(d, system, n);
  const FloatVec threshold = hn::Set(d, rows.noise_threshold);
  FloatVec value[kMaxRegressionFeatures];
  for (int k = 0; k < n; ++k) value[k] = system.matrix[k][k];
  int dimensions = 0;
  for (int r = 0; r < kMaxFeatureDimensions; ++r, basis += n * lanes) {
    FloatVec best = hn::Zero(d);
    FloatVec direction[kMaxRegressionFeatures];
    for (int k = 0; k < n; ++k) direction[k] = hn::Zero(d);
    for (int candidate = 0; candidate < n; ++candidate) {
      const auto is_better = hn::Gt(value[candidate], best);
      best = hn::IfThenElse(is_better, value[candidate], best);
      for (int k = 0; k < n; ++k) {
        direction[k] = hn::IfThenElse(is_better, system.vectors[k][candidate], direction[k]);
      }
    }
    auto is_open = hn::Gt(best, hn::Zero(d));
    for (int candidate = 0; candidate < n; ++candidate) {  // the first of equal ones, as above
      const auto is_taken = hn::And(is_open, hn::Eq(value[candidate], best));
      value[candidate] = hn::IfThenZeroElse(is_taken, value[candidate]);
      is_open = hn::AndNot(is_taken, is_open);
    }
    const auto is_kept = hn::Gt(best, threshold);
    if (!hn::AllFalse(d, is_kept)) dimensions = r + 1;
    const FloatVec unit = hn::IfThenElseZero(is_kept, hn::Div(hn::Set(d, 1.0F), hn::Sqrt(hn::Max(best, threshold))));
    for (int k = 0; k < n; ++k) {
      hn::Store(hn::Mul(hn::Mul(direction[k], scale[k]), unit), d, basis + k * lanes);
    }
  }
  return dimensions;
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
