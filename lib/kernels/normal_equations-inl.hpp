// SPDX-License-Identifier: Apache-2.0
//
// Weighted least squares for vectors of pixels: normal equations over batches of neighbours, their factor and
// solutions. Compiled once per instruction set.
#if defined(STEIN_KERNELS_NORMAL_EQUATIONS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef STEIN_KERNELS_NORMAL_EQUATIONS_INL
#undef STEIN_KERNELS_NORMAL_EQUATIONS_INL
#else
#define STEIN_KERNELS_NORMAL_EQUATIONS_INL
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "kernels/local_polynomial.hpp"
#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

// Pivots below this share of their diagonal entry are rounding: the column depends on those before it.
inline constexpr float kSingular = 1e-5F;

// What a batch of neighbours brings.
struct TapBatch {
  HWY_INLINE TapBatch() {}                  // NOLINT(modernize-use-equals-default): see Distances
  FloatVec column[kMaxColumns][kTapBatch];  // x_i, by powers
  FloatVec colour[3][kTapBatch];            // y_i - y_c
};

// Row a of the upper triangle and the right-hand sides behind it.
constexpr std::ptrdiff_t row_of(int columns, int a) {
  return static_cast<std::ptrdiff_t>(a) * (columns + 3) - static_cast<std::ptrdiff_t>(a) * (a - 1) / 2;
}

HWY_INLINE void add_to(FloatTag d, float* HWY_RESTRICT sum, const FloatVec (&a)[kTapBatch],
                       const FloatVec (&b)[kTapBatch]) {
  FloatVec total = hn::Load(d, sum);
  for (int t = 0; t < kTapBatch; ++t) total = hn::MulAdd(a[t], b[t], total);
  hn::Store(total, d, sum);
}

// Rows a and, with kPair, a + 1 of X^T W X and X^T W Y.
template <bool kPair>
HWY_INLINE void add_rows(FloatTag d, const TapBatch& batch, const FloatVec (&w)[kTapBatch], int columns, int a,
                         float* HWY_RESTRICT sums) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  FloatVec u[kTapBatch];
  FloatVec v[kTapBatch];
  for (int t = 0; t < kTapBatch; ++t) {
    u[t] = hn::Mul(w[t], batch.column[a][t]);
    if constexpr (kPair) v[t] = hn::Mul(w[t], batch.column[a + 1][t]);
  }
  float* HWY_RESTRICT first = sums + row_of(columns, a) * lanes;
  float* HWY_RESTRICT second = sums + row_of(columns, a + 1) * lanes;
  add_to(d, first, u, batch.column[a]);
  first += lanes;
  for (int b = a + 1; b < columns; ++b, first += lanes, second += lanes) {
    add_to(d, first, u, batch.column[b]);
    if constexpr (kPair) add_to(d, second, v, batch.column[b]);
  }
  for (int c = 0; c < 3; ++c, first += lanes, second += lanes) {
    add_to(d, first, u, batch.colour[c]);
    if constexpr (kPair) add_to(d, second, v, batch.colour[c]);
  }
}

HWY_INLINE void add_normal_equations(FloatTag d, const TapBatch& batch, const FloatVec (&w)[kTapBatch], int columns,
                                     float* HWY_RESTRICT sums) {
  int a = 0;
  for (; a + 1 < columns; a += 2) add_rows<true>(d, batch, w, columns, a, sums);
  if (a < columns) add_rows<false>(d, batch, w, columns, a, sums);
}

// X^T W X + ridge = L D L^T with the right-hand sides X^T W Y and e taken along; leading blocks are those of lower
// orders.
struct Factor {
  HWY_INLINE Factor() {}  // NOLINT(modernize-use-equals-default): see Distances
  int columns = 0;
  int linear_columns = 0;  // of powers 0 and 1
  float ridge = 0;
  float curvature_ridge = 0;
  float* HWY_RESTRICT rows;     // as the normal equations: D L^T, and what is left of their right-hand sides
  float* HWY_RESTRICT inverse;  // of D; 0: the column depends on those before it
  FloatVec unit[kMaxColumns];   // of e
};

HWY_INLINE void factorise(FloatTag d, const float* HWY_RESTRICT sums, Factor& factor) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const int n = factor.columns;
  const FloatVec zero = hn::Zero(d);
  std::copy_n(sums, normal_equation_sums(n) * lanes, factor.rows);
  for (int a = 0; a < n; ++a) factor.unit[a] = hn::Set(d, a == 0 ? 1.0F : 0.0F);
  for (int k = 0; k < n; ++k) {
    float* HWY_RESTRICT row = factor.rows + row_of(n, k) * lanes;
    const float ridge = k < factor.linear_columns ? factor.ridge : factor.curvature_ridge;
    const FloatVec own_ridge = hn::Set(d, k == 0 ? 0.0F : ridge);
    const FloatVec diagonal = hn::Add(hn::Load(d, sums + row_of(n, k) * lanes), own_ridge);
    const FloatVec pivot = hn::Add(hn::Load(d, row), own_ridge);
    const auto is_regular = hn::Gt(pivot, hn::Max(hn::Mul(diagonal, hn::Set(d, kSingular)), hn::Set(d, 1e-30F)));
    const FloatVec inverse =
        hn::IfThenElseZero(is_regular, hn::Div(hn::Set(d, 1.0F), hn::IfThenElse(is_regular, pivot, hn::Set(d, 1.0F))));
    hn::Store(inverse, d, factor.inverse + k * lanes);
    for (int i = k + 1; i < n; ++i) {
      const FloatVec m = hn::Mul(hn::Load(d, row + (i - k) * lanes), inverse);
      float* HWY_RESTRICT target = factor.rows + row_of(n, i) * lanes;
      for (int j = i; j < n + 3; ++j) {
        const FloatVec old = hn::Load(d, target + (j - i) * lanes);
        hn::Store(hn::NegMulAdd(m, hn::Load(d, row + (j - k) * lanes), old), d, target + (j - i) * lanes);
      }
      factor.unit[i] = hn::NegMulAdd(m, factor.unit[k], factor.unit[i]);
    }
    factor.unit[k] = hn::IfThenElse(is_regular, factor.unit[k], zero);
  }
}

// Solution of the leading `columns`: part 0 is g, 1 to 3 are beta of the channels; solution[part * columns + k].
HWY_INLINE void solve(FloatTag d, const Factor& factor, int columns, float* HWY_RESTRICT solution) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const int n = factor.columns;
  for (int part = 0; part < kSolutionParts; ++part, solution += columns * lanes) {
    for (int k = columns - 1; k >= 0; --k) {
      const float* HWY_RESTRICT row = factor.rows + row_of(n, k) * lanes;
      FloatVec rest = part == 0 ? factor.unit[k] : hn::Load(d, row + (n - k + part - 1) * lanes);
      for (int j = k + 1; j < columns; ++j) {
        rest = hn::NegMulAdd(hn::Load(d, row + (j - k) * lanes), hn::Load(d, solution + j * lanes), rest);
      }
      hn::Store(hn::Mul(rest, hn::Load(d, factor.inverse + k * lanes)), d, solution + k * lanes);
    }
  }
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
