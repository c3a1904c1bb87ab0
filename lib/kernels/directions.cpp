// SPDX-License-Identifier: Apache-2.0
#include "kernels/directions.hpp"

#include <cstddef>
#include <cstring>

#include "core/hash.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/directions.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

constexpr std::uint64_t kPixelOffset = 0xD1B54A32D192ED03ULL;
constexpr float kSingular = 1e-4F;  // a pivot below this fraction of its variance is rounding

using WordTag = hn::CappedTag<std::uint64_t, kMaxLanes / 2>;
using WordVec = hn::Vec<WordTag>;

// The low 64 bits of the product.
HWY_INLINE WordVec product(WordTag d, WordVec a, std::uint64_t b) {
#if HWY_TARGET == HWY_SCALAR
  return hn::Set(d, hn::GetLane(a) * b);
#else
  const hn::Repartition<std::uint32_t, WordTag> dh;
  const auto low = hn::Set(dh, static_cast<std::uint32_t>(b));
  const auto high = hn::Set(dh, static_cast<std::uint32_t>(b >> 32U));
  const auto a_low = hn::BitCast(dh, a);
  const auto a_high = hn::BitCast(dh, hn::ShiftRight<32>(a));
  const WordVec across = hn::Add(hn::BitCast(d, hn::MulEven(a_high, low)), hn::BitCast(d, hn::MulEven(a_low, high)));
  return hn::Add(hn::BitCast(d, hn::MulEven(a_low, low)), hn::ShiftLeft<32>(across));
#endif
}

// mixed() of core/hash.hpp.
HWY_INLINE WordVec mixed_words(WordTag d, WordVec z) {
  z = product(d, hn::Xor(z, hn::ShiftRight<30>(z)), kMixFactors[0]);
  z = product(d, hn::Xor(z, hn::ShiftRight<27>(z)), kMixFactors[1]);
  return hn::Xor(z, hn::ShiftRight<31>(z));
}

// 1 where the bit at 31 is set, else -1.
HWY_INLINE void store_signs(WordTag d, WordVec bits, float* out) {
  const hn::Rebind<std::uint32_t, WordTag> dh;
  const WordVec sign = hn::AndNot(bits, hn::Set(d, 0x80000000U));
  const auto words = hn::TruncateTo(dh, hn::Or(sign, hn::Set(d, 0x3F800000U)));
  hn::StoreU(hn::BitCast(hn::Rebind<float, WordTag>(), words), hn::Rebind<float, WordTag>(), out);
}

void RandomSignRowsTarget(std::uint64_t stream, int x, int y, int count, float* const* out) {
  const WordTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < count; i += lanes) {
    const WordVec key = hn::Iota(d, pixel_key(x + i, y) + kPixelOffset);
    const WordVec bits = mixed_words(d, hn::Xor(hn::Set(d, stream), mixed_words(d, key)));
    store_signs(d, hn::ShiftLeft<14>(bits), out[0] + i);
    store_signs(d, bits, out[1] + i);
    store_signs(d, hn::ShiftRight<16>(bits), out[2] + i);
  }
}

HWY_INLINE FloatVec bounded(FloatTag d, FloatVec covariance, FloatVec limit) {
  const auto is_known = hn::And(hn::Gt(limit, hn::Zero(d)), hn::IsFinite(covariance));
  return hn::IfThenElseZero(is_known, hn::Max(hn::Min(covariance, limit), hn::Neg(limit)));
}

HWY_INLINE FloatVec bounded_covariance(FloatTag d, const float* covariance, const float* va, const float* vb,
                                       float factor) {
  const FloatVec limit = hn::Mul(hn::Sqrt(hn::LoadU(d, va)), hn::Sqrt(hn::LoadU(d, vb)));
  return hn::Mul(bounded(d, hn::LoadU(d, covariance), limit), hn::Set(d, factor));
}

void BoundedCovarianceRowTarget(const float* covariance, const float* va, const float* vb, float factor, int count,
                                float* out) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int i = 0;
  for (; i + lanes <= count; i += lanes)
    hn::StoreU(bounded_covariance(d, covariance + i, va + i, vb + i, factor), d, out + i);
  if (i >= count) return;
  float rest[4][kMaxLanes] = {};
  const std::size_t bytes = sizeof(float) * static_cast<std::size_t>(count - i);
  std::memcpy(rest[0], covariance + i, bytes);
  std::memcpy(rest[1], va + i, bytes);
  std::memcpy(rest[2], vb + i, bytes);
  hn::StoreU(bounded_covariance(d, rest[0], rest[1], rest[2], factor), d, rest[3]);
  std::memcpy(out + i, rest[3], bytes);
}

HWY_INLINE FloatVec root_of_pivot(FloatTag d, FloatVec pivot, FloatVec variance) {
  const auto counts = hn::Gt(pivot, hn::Mul(hn::Set(d, kSingular), variance));
  return hn::Sqrt(hn::IfThenElseZero(counts, pivot));
}

// 1 / v, or 0 of 0: what a column of zeros takes part with.
HWY_INLINE FloatVec inverse_or_zero(FloatTag d, FloatVec v) {
  const auto counts = hn::Gt(v, hn::Zero(d));
  const FloatVec one = hn::Set(d, 1.0F);
  return hn::IfThenElseZero(counts, hn::Div(one, hn::IfThenElse(counts, v, one)));
}

void DirectionRowsTarget(const DirectionRows& rows) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < rows.count; i += lanes) {
    FloatVec v[3], c[3], z[3];
    for (int k = 0; k < 3; ++k) {
      v[k] = hn::LoadU(d, rows.variance[k] + i);
      c[k] = hn::LoadU(d, rows.covariance[k] + i);
      z[k] = hn::LoadU(d, rows.sign[k] + i);
      hn::StoreU(hn::Sqrt(v[k]), d, rows.deviation[k] + i);
    }
    const FloatVec l00 = root_of_pivot(d, v[0], v[0]);
    const FloatVec i0 = inverse_or_zero(d, l00);
    const FloatVec l10 = hn::Mul(c[0], i0);
    const FloatVec l20 = hn::Mul(c[1], i0);
    const FloatVec l11 = root_of_pivot(d, hn::NegMulAdd(l10, l10, v[1]), v[1]);
    const FloatVec i1 = inverse_or_zero(d, l11);
    const FloatVec l21 = hn::Mul(hn::NegMulAdd(l20, l10, c[2]), i1);
    const FloatVec l22 = root_of_pivot(d, hn::NegMulAdd(l21, l21, hn::NegMulAdd(l20, l20, v[2])), v[2]);
    const FloatVec i2 = inverse_or_zero(d, l22);
    hn::StoreU(hn::Mul(l00, z[0]), d, rows.colour[0] + i);
    hn::StoreU(hn::MulAdd(l11, z[1], hn::Mul(l10, z[0])), d, rows.colour[1] + i);
    hn::StoreU(hn::MulAdd(l22, z[2], hn::MulAdd(l21, z[1], hn::Mul(l20, z[0]))), d, rows.colour[2] + i);
    // S^+ b = L^-T z, from the last row up.
    const FloatVec s2 = hn::Mul(z[2], i2);
    const FloatVec s1 = hn::Mul(hn::NegMulAdd(l21, s2, z[1]), i1);
    const FloatVec s0 = hn::Mul(hn::NegMulAdd(l20, s2, hn::NegMulAdd(l10, s1, z[0])), i0);
    hn::StoreU(s0, d, rows.solved[0] + i);
    hn::StoreU(s1, d, rows.solved[1] + i);
    hn::StoreU(s2, d, rows.solved[2] + i);
  }
}

void AlongRowTarget(const AlongRow& row) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < row.count; i += lanes) {
    const FloatVec own = hn::Sqrt(hn::LoadU(d, row.variance + i));
    FloatVec sum = hn::Zero(d);
    for (int k = 0; k < 3; ++k) {
      const FloatVec limit = hn::Mul(hn::LoadU(d, row.deviation[k] + i), own);
      sum = hn::MulAdd(bounded(d, hn::LoadU(d, row.covariance[k] + i), limit), hn::LoadU(d, row.solved[k] + i), sum);
    }
    hn::StoreU(hn::Mul(sum, hn::Set(d, row.scale)), d, row.result + i);
  }
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::kernels {

HWY_EXPORT(RandomSignRowsTarget);
HWY_EXPORT(BoundedCovarianceRowTarget);
HWY_EXPORT(DirectionRowsTarget);
HWY_EXPORT(AlongRowTarget);

void bounded_covariance_row(const float* covariance, const float* va, const float* vb, float factor, int count,
                            float* out) {
  HWY_DYNAMIC_DISPATCH(BoundedCovarianceRowTarget)(covariance, va, vb, factor, count, out);
}

void random_sign_rows(std::uint64_t stream, int x, int y, int count, float* const* out) {
  HWY_DYNAMIC_DISPATCH(RandomSignRowsTarget)(stream, x, y, count, out);
}

void direction_rows(const DirectionRows& rows) { HWY_DYNAMIC_DISPATCH(DirectionRowsTarget)(rows); }

void along_row(const AlongRow& row) { HWY_DYNAMIC_DISPATCH(AlongRowTarget)(row); }

}  // namespace stein::kernels
#endif  // HWY_ONCE
