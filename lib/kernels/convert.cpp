// SPDX-License-Identifier: Apache-2.0
#include "kernels/convert.hpp"

#include <cstdint>
#include <cstring>

#include "kernels/guides.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/convert.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, kMaxLanes>;

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2 && !defined(HWY_DISABLE_F16C)  // the better the set, the less its number

HWY_INLINE hn::Vec<FloatTag> from_half(FloatTag d, const std::uint16_t* half) {
  const auto bits = hn::Load(hn::Rebind<std::uint16_t, FloatTag>(), half);
  return hn::PromoteTo(d, hn::BitCast(hn::Rebind<hwy::float16_t, FloatTag>(), bits));
}

#else

// Where Highway emulates the conversion it turns infinities and NaNs into numbers (1.0.3). No operand here is a
// denormal float, which many processors are slow at: half has denormals from 6e-5 down, where variances often are. One
// more unit of the exponent and a subtraction make numbers of these.
HWY_INLINE hn::Vec<FloatTag> from_half(FloatTag d, const std::uint16_t* half) {
  const hn::RebindToUnsigned<FloatTag> du;
  const hn::Rebind<std::uint16_t, FloatTag> dh;
  const auto bits = hn::PromoteTo(du, hn::Load(dh, half));
  const auto magnitude = hn::ShiftLeft<13>(hn::And(bits, hn::Set(du, 0x7FFFU)));
  const auto sign = hn::ShiftLeft<16>(hn::And(bits, hn::Set(du, 0x8000U)));
  const auto half_exponent = hn::Set(du, 0x7C00U);
  const auto exponent = hn::And(bits, half_exponent);
  const auto special = hn::IfThenElseZero(hn::Eq(exponent, half_exponent), hn::Set(du, 0x7F800000U));
  constexpr std::uint32_t kBias = 127 - 15;
  const auto normal = hn::Add(magnitude, hn::Set(du, kBias << 23U));
  const auto raised = hn::BitCast(d, hn::Add(magnitude, hn::Set(du, (kBias + 1) << 23U)));
  const auto denormal = hn::BitCast(du, hn::Sub(raised, hn::Set(d, 0x1p-14F)));
  const auto number = hn::IfThenElse(hn::Eq(exponent, hn::Zero(du)), denormal, normal);
  return hn::BitCast(d, hn::Or(number, hn::Or(special, sign)));
}

#endif

void HalfToFloatRowTarget(const std::byte* half, int count, float* out) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  HWY_ALIGN std::uint16_t in[kMaxLanes] = {};
  HWY_ALIGN float converted[kMaxLanes];
  for (int i = 0; i < count; i += lanes) {
    const int n = HWY_MIN(lanes, count - i);
    std::memcpy(in, half + 2 * static_cast<std::ptrdiff_t>(i), 2 * static_cast<std::size_t>(n));
    if (n == lanes) {
      hn::StoreU(from_half(d, in), d, out + i);
    } else {
      hn::Store(from_half(d, in), d, converted);
      std::memcpy(out + i, converted, sizeof(float) * static_cast<std::size_t>(n));
    }
  }
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::kernels {

HWY_EXPORT(HalfToFloatRowTarget);

void half_to_float_row(const std::byte* half, int count, float* out) {
  HWY_DYNAMIC_DISPATCH(HalfToFloatRowTarget)(half, count, out);
}

}  // namespace stein::kernels
#endif  // HWY_ONCE
